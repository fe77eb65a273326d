#pragma once
// Synthetic exports: one known run, written in many formats.

#include "plugin/recording/import/import.h"
#include "tests/support/folder.h"
#include "tests/support/text.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

namespace importingtest {

using namespace supercircle;
using importing::Quantity;
using test::contentOf;
using test::Folder;
using test::with;

/// The run: 1 s dwell, 0.5 mm/s loading for 8 s and unloading, 1 s dwell; rows at 20 Hz. First contact at 1 mm,
/// stiffness 2 N/mm.
inline constexpr int rows = 361;
inline double timeOf(int i) {
    return 0.05 * i;
}
inline double wayOf(double t) { // mm
    return t < 1.0 ? 0.0 : t < 9.0 ? 0.5 * (t - 1.0) : t < 17.0 ? 0.5 * (17.0 - t) : 0.0;
}
inline double forceOf(double way) { // N
    return way > 1.0 ? 2.0 * (way - 1.0) : 0.0;
}

inline std::string printed(double value, int digits, char decimal = '.') {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    std::string s = text;
    const std::size_t point = s.find('.');
    if (point != std::string::npos)
        s[point] = decimal;
    return s;
}

/// How the run is written.
struct Style {
    std::string head = "time_s,displacement_mm,force_N";
    char separator = ',', decimal = '.';
    std::string lineEnd = "\n";
    double perSecond = 1.0, perMillimetre = 1.0, perNewton = 1.0; ///< the unit's number for one of these
    int digits = 6;
};

inline std::string exported(const Style& s, int from = 0, int to = rows) {
    std::string text = s.head + s.lineEnd;
    for (int i = from; i < to; ++i) {
        const double t = timeOf(i), way = wayOf(t);
        text += printed(t * s.perSecond, s.digits, s.decimal) + s.separator +
                printed(way * s.perMillimetre, s.digits, s.decimal) + s.separator +
                printed(forceOf(way) * s.perNewton, s.digits, s.decimal) + s.lineEnd;
    }
    return text;
}

inline std::string exported() {
    return exported(Style{});
}

inline Result<importing::Imported> read(const std::string& text, const importing::Hints& hints = {}) {
    const Folder folder;
    auto result = importing::readExports({folder.write("x.csv", text)}, hints);
    std::string error = result.error();
    if (const std::size_t at = error.find(folder.path + "/"); at != std::string::npos)
        error.erase(at, folder.path.size() + 1);
    return result ? std::move(result) : Result<importing::Imported>::failure(std::move(error));
}

/// The account of a text that can be imported.
inline std::string accountOf(const std::string& text, const importing::Hints& hints = {}) {
    const auto all = read(text, hints);
    INFO(all.error());
    REQUIRE(all);
    return importing::account(*all);
}

/// Why a text cannot be imported.
inline std::string errorOf(const std::string& text, const importing::Hints& hints = {}) {
    const auto all = read(text, hints);
    INFO((all ? importing::account(*all) : std::string()));
    CHECK_FALSE(all);
    return all.error();
}

/// The values of a run are those that were written, to `digits` of the file (SI).
inline void checkValues(const importing::ImportedRun& run, double slack = 1e-6, int from = 0, int to = rows) {
    const auto *t = run.signals.find(Quantity::Time), *d = run.signals.find(Quantity::Displacement),
               *f = run.signals.find(Quantity::Force);
    REQUIRE((t != nullptr && d != nullptr && f != nullptr));
    REQUIRE(run.signals.rows() == static_cast<std::size_t>(to - from));
    for (int i = from; i < to; ++i) {
        const auto k = static_cast<std::size_t>(i - from);
        const double time = timeOf(i);
        INFO("row " << i);
        REQUIRE(std::abs((*t)[k] - (time - timeOf(from))) <= slack * 10.0);
        REQUIRE(std::abs(1e3 * (*d)[k] - (wayOf(time) - wayOf(timeOf(from)))) <= slack);
        REQUIRE(std::abs((*f)[k] - forceOf(wayOf(time))) <= slack);
    }
}

/// What is read of an export; it must be readable.
inline importing::Imported imported(const std::string& text, const importing::Hints& hints = {}) {
    auto all = read(text, hints);
    INFO(all.error());
    REQUIRE(all);
    return *all;
}

} // namespace importingtest
