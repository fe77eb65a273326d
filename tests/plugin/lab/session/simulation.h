#pragma once
// Simulates the project's scenes as the program does, and reads quantities from the results.

#include "bridge/box2d/lab_world.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/scene/loader/loader.h"
#include "tests/supercircle/rod/reference.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

namespace supercircle::test {

using Overrides = std::vector<scene::Override>;

inline scene::Scene loadScene(const std::string& name, const Overrides& overrides) {
    std::vector<scene::Problem> problems;
    auto made = scene::load(std::string(SC_SOURCE_DIR) + "/scenes/" + name + ".json", overrides, problems);
    for (const scene::Problem& p : problems)
        UNSCOPED_INFO(p.toString());
    REQUIRE(made);
    return *made;
}

inline lab::RunResult simulate(const scene::Scene& scene, const lab::RunOptions& options = {}) {
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(scene.rigid, error);
    INFO(error);
    REQUIRE(host);
    lab::RunResult out = lab::runScene(scene, host, options);
    INFO(out.message);
    REQUIRE(out.status == lab::RunStatus::Done);
    return out;
}

/// A thinner shell with the natural frequencies of the original: mass and stiffness decrease alike (density as
/// thickness squared), so that the same speeds stay quasi-static.
inline void keepFrequencies(scene::Scene& s, double thickness) {
    for (ShellDef& d : s.shells) {
        d.density *= (thickness / 5e-4) * (thickness / 5e-4);
        d.thickness = thickness;
    }
}

inline double number(const record::Recording& r, const std::string& key) {
    for (const auto& [name, value] : r.summary)
        if (name == key) {
            if (const auto* i = std::get_if<std::int64_t>(&value))
                return static_cast<double>(*i);
            return std::get<double>(value);
        }
    FAIL("the summary has no " + key);
    return 0.0;
}

inline std::string textOf(const record::Recording& r, const std::string& key) {
    for (const auto& [name, value] : r.summary)
        if (name == key)
            return std::get<std::string>(value);
    return {};
}

/// One branch of a force-displacement curve in units of R and B / R^2.
struct ForceCurve {
    std::vector<double> d, f;
    [[nodiscard]] double at(double x) const { // d rises or falls along the branch
        for (std::size_t i = 1; i < d.size(); ++i)
            if ((d[i - 1] - x) * (d[i] - x) <= 0.0 && d[i] != d[i - 1])
                return f[i - 1] + (f[i] - f[i - 1]) * (x - d[i - 1]) / (d[i] - d[i - 1]);
        FAIL("displacement " << x << " is not on the curve");
        return 0.0;
    }
    [[nodiscard]] double top() const { return *std::max_element(f.begin(), f.end()); }
    [[nodiscard]] double bottom() const { return *std::min_element(f.begin(), f.end()); }
};

/// Loading and unloading branches of a recording, split where the displacement is largest.
inline std::pair<ForceCurve, ForceCurve> loadingAndUnloading(const record::Recording& r) {
    const std::vector<double>& d = *r.series.find("displacement_m");
    const std::vector<double>& f = *r.series.find("force_N");
    const double unit = r.B / (r.R * r.R);
    const auto turn = static_cast<std::size_t>(std::max_element(d.begin(), d.end()) - d.begin());
    std::pair<ForceCurve, ForceCurve> out;
    for (std::size_t i = 0; i < d.size(); ++i) {
        ForceCurve& c = i <= turn ? out.first : out.second;
        c.d.push_back(d[i] / r.R);
        c.f.push_back(f[i] / unit);
    }
    return out;
}

inline ForceCurve reference(const std::string& file) {
    ForceCurve c;
    for (const rod::reference::Row& row : rod::reference::read(file)) {
        c.d.push_back(row.count("indent_over_R") ? row.at("indent_over_R") : row.at("d_over_R"));
        c.f.push_back(row.at("fR2_over_B"));
    }
    return c;
}

/// Invariants of every run.
inline void checkInvariants(const record::Recording& r) {
    CHECK(std::abs(number(r, "energy_residual_relative")) < 1e-9); // round-off of 1e4 steps
    CHECK(number(r, "penetration_max_over_h") < 0.04);
    CHECK(number(r, "length_error_max") < 1e-9);
    CHECK(number(r, "crossings") == 0.0);
    CHECK(number(r, "unconverged_steps") == 0.0);
}

/// Largest of | measured - expected | at `points`, over `scale`.
inline double deviation(const ForceCurve& measured, const ForceCurve& expected, const std::vector<double>& points,
                        double scale) {
    double worst = 0.0;
    for (const double x : points)
        worst = std::max(worst, std::abs(measured.at(x) - expected.at(x)) / scale);
    return worst;
}

} // namespace supercircle::test
