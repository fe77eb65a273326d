// Nothing in import depends on the size of the specimen, of the forces or of the duration.

#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"

using namespace importingtest;

namespace {

namespace fs = std::filesystem;

struct Scales {
    double length = 1.0, force = 1.0, time = 1.0;
};

importing::ImportedRun scaled(const record::Series& csv, const Scales& s) {
    std::string text = "time_s,displacement_mm,force_N\n";
    const auto &t = *csv.find("time_s"), &d = *csv.find("displacement_mm"), &f = *csv.find("force_N");
    const auto cell = [](double v) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.15g", v);
        return std::isfinite(v) ? std::string(digits) : std::string();
    };
    for (std::size_t i = 0; i < t.size(); ++i)
        text += cell(t[i] * s.time) + "," + cell(d[i] * s.length) + "," + cell(f[i] * s.force) + "\n";
    auto all = read(text);
    INFO(all.error());
    REQUIRE(all);
    REQUIRE(all->runs.size() == 1);
    return all->runs[0];
}

} // namespace

TEST_CASE("recordings of every size are understood alike", "[importing]") {
    std::size_t recordings = 0;
    for (const auto& entry : fs::recursive_directory_iterator(std::string(SC_TEST_DATA) + "/recordings/training")) {
        const std::string name = entry.path().filename().string();
        if (name.rfind("run_", 0) != 0 || name.find("markers") != std::string::npos ||
            entry.path().extension() != ".csv")
            continue;
        INFO(entry.path().string());
        record::CsvOptions options;
        options.required = {"time_s", "displacement_mm", "force_N"};
        const auto text = record::readText(entry.path().string());
        REQUIRE(text);
        const auto csv = record::parseCsv(*text, name, options);
        REQUIRE(csv);
        ++recordings;
        const importing::ImportedRun plain = scaled(*csv, {});
        for (const Scales& s : {Scales{0.1, 1.0, 1.0}, Scales{10.0, 1.0, 1.0}, Scales{1.0, 1e3, 1.0},
                                Scales{1.0, 1.0, 0.01}, Scales{1.0, 1.0, 100.0}}) {
            INFO("lengths x " << s.length << ", forces x " << s.force << ", times x " << s.time);
            const importing::ImportedRun run = scaled(*csv, s);
            REQUIRE(run.signals.rows() == plain.signals.rows());
            CHECK(run.drive.time.size() == plain.drive.time.size());
            CHECK(run.signals.forceTurned == plain.signals.forceTurned);
            // rounding of 15 digits, over sums of as many rows
            CHECK(run.forceZero == Approx(s.force * plain.forceZero).epsilon(1e-9).margin(1e-12 * s.force));
            CHECK((run.forceZeroWindow > 0.0) == (plain.forceZeroWindow > 0.0));
            CHECK(run.drive.tolerance == Approx(s.length * plain.drive.tolerance).epsilon(1e-9));
            CHECK(std::isfinite(run.firstContact) == std::isfinite(plain.firstContact));
            if (std::isfinite(plain.firstContact))
                CHECK(run.firstContact == Approx(s.length * plain.firstContact).epsilon(1e-9).margin(1e-15));
        }
    }
    CHECK(recordings >= 12);
}
