// Files of a run: the keys of the summary, the series, the page, and their reproducibility.

#include "plugin/recording/table/csv.h"
#include "tests/plugin/cli/program.h"
#include "tests/support/json.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace supercircle;
using namespace supercircle::test;
using Catch::Contains;
using nlohmann::json;

namespace {

/// Runs a scene into `folder`/`name` and returns the summary.
json summaryOf(const Folder& folder, const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "run");
    for (const std::string& more : {std::string("--out"), folder / name, std::string("--quiet")})
        arguments.push_back(more);
    const CommandResult ending = start(arguments);
    INFO(ending.err);
    REQUIRE(ending.code == 0);
    return test::jsonOf(folder / (name + "/summary.json"));
}

std::vector<std::string> stack(const std::string& shells, const std::string& cycles) {
    return {scene("stack30"), "--no-report", "--param", "shells=" + shells, "--param", "cycles=" + cycles};
}

std::vector<std::string> with(std::vector<std::string> arguments, std::vector<std::string> more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

void checkKeys(const json& summary, const std::vector<const char*>& keys) {
    for (const char* key : keys) {
        INFO(key);
        REQUIRE(summary.contains(key));
        CHECK_FALSE(summary[key].is_null());
    }
}

const std::vector<const char*> kCommon = {"scene",
                                          "seed",
                                          "parameters",
                                          "status",
                                          "simulated_s",
                                          "timing",
                                          "steps",
                                          "threads",
                                          "energy",
                                          "energy_residual_relative",
                                          "penetration_max_over_h",
                                          "crossings",
                                          "length_error_max",
                                          "contact_residual_max",
                                          "unconverged_steps",
                                          "absolute_floor_steps"};

void checkCommon(const json& summary, const std::string& name) {
    checkKeys(summary, kCommon);
    checkKeys(summary["timing"], {"wall_s", "cpu_s", "protocol_cpu_s", "stage_solve_s"});
    checkKeys(summary["energy"], {"work_in_J", "elastic_J", "gravity_J", "kinetic_J", "friction_J", "effects_J",
                                  "numerical_dissipation_J", "position_correction_J", "to_bodies_J", "residual_J"});
    CHECK(summary["scene"] == name);
    CHECK(summary["status"] == "done");
    CHECK(summary["crossings"] == 0);
    CHECK(summary["length_error_max"] < 1e-12); // arcs keep their length by construction: round-off only
}

record::Series seriesOf(const std::string& path) {
    const auto series = record::readCsv(path);
    REQUIRE(series.error().empty());
    REQUIRE(series->names.size() > 3);
    CHECK(series->names[0] == "time_s");
    CHECK(series->names[1] == "displacement_m");
    CHECK(series->names[2] == "force_N");
    return *series;
}

} // namespace

TEST_CASE("a squeezed stack reports its cycles, and its series are theirs") {
    const Folder folder;
    const json summary = summaryOf(folder, "stack", stack("3", "1"));
    checkCommon(summary, "stack30");
    checkKeys(summary, {"H0_over_R", "delta_max_over_R", "dissipation_ratio", "snap_fits", "max_force_drop_R2_over_B",
                        "max_energy_release_R_over_B", "peak_force_N", "peak_force_R2_over_B", "cycles"});
    REQUIRE(summary["cycles"].size() == 1);
    checkKeys(summary["cycles"][0], {"delta_max_over_R", "dissipation_ratio", "snap_fits", "dissipated_J"});
    CHECK(summary["peak_force_N"] >= 5.0); // the crosshead reverses at 5 N
    const record::Series series = seriesOf(folder / "stack/series.csv");
    const auto& force = *series.find("force_N");
    const auto& travel = *series.find("displacement_m");
    const auto top = std::max_element(force.begin(), force.end()) - force.begin();
    CHECK(top >= 500); // enough samples a loading branch to resolve a snap
    CHECK(travel.front() == Approx(0.0).margin(1e-12));
    CHECK(std::is_sorted(travel.begin(), travel.begin() + top));
    const double turn = summary["delta_max_over_R"].get<double>() * 0.0192;
    CHECK(travel[static_cast<std::size_t>(top)] == Approx(turn).margin(4e-5)); // one step of the plate: R / 500
}

TEST_CASE("a snap reports peak, pull-off force and type") {
    const Folder folder;
    const json summary = summaryOf(folder, "snap", {scene("shell_on_cylinder")});
    checkCommon(summary, "shell_on_cylinder");
    checkKeys(summary, {"peak_force_N", "peak_force_R2_over_B", "pull_off_force_R2_over_B", "snap_type"});
    CHECK(summary["pull_off_force_R2_over_B"] <= 0.0);
    const record::Series series = seriesOf(folder / "snap/series.csv");
    CHECK(series.rows() >= 500);
    const auto& force = *series.find("force_N");
    CHECK(*std::max_element(force.begin(), force.end()) == summary["peak_force_unfiltered_N"].get<double>());
    // The reported peak is a mean over a short travel: a Type I curve is smooth, so hardly less. A mean over less than
    // a step is that step's force but for rounding.
    CHECK(summary["peak_force_N"].get<double>() <= summary["peak_force_unfiltered_N"].get<double>() * (1.0 + 1e-12));
    CHECK(summary["peak_force_N"].get<double>() ==
          Approx(summary["peak_force_unfiltered_N"].get<double>()).epsilon(5e-3));

    const std::string page = contentOf(folder / "snap/report.html");
    CHECK_THAT(page, Contains("<svg") && Contains("</html>"));
    for (const char* outside : {"src=\"http", "href=\"http", "src='http", "url(http", "@import", "<link"})
        CHECK_THAT(page, !Contains(outside));
    for (const char* picture : {"overview.png", "force.png", "energy.png"})
        CHECK_THAT(contentOf(folder / (std::string("snap/") + picture)), Catch::StartsWith("\x89PNG"));
    CHECK(test::jsonOf(folder / "snap/trajectory.json")["frames"].size() > 10);
}

TEST_CASE("a report of an earlier run does not stay beside new data") {
    const Folder folder;
    summaryOf(folder, "out", {scene("shell_on_cylinder")});
    REQUIRE(std::filesystem::exists(folder / "out/report.html"));
    summaryOf(folder, "out", {scene("shell_on_cylinder"), "--no-report"});
    CHECK(Folder().entries().empty());
    CHECK(folder.entries() ==
          std::vector<std::string>{"out", "out/series.csv", "out/summary.json", "out/trajectory.json"});
}

TEST_CASE("a cantilever reports its tip, a ramp its creep, a squeezed shell its peak") {
    const Folder folder;
    const json cantilever = summaryOf(folder, "cantilever", {scene("cantilever"), "--no-report"});
    checkCommon(cantilever, "cantilever");
    checkKeys(cantilever, {"tip_x_over_L", "tip_y_over_L"});
    const json ramp = summaryOf(folder, "ramp", {scene("ramp"), "--no-report", "--param", "time=0.2"});
    checkCommon(ramp, "ramp");
    checkKeys(ramp, {"creep_speed_m_s"});
    CHECK(ramp["simulated_s"].get<double>() == Approx(0.2).margin(1e-9));
    const json squeeze = summaryOf(folder, "squeeze", {scene("squeeze"), "--no-report"});
    checkCommon(squeeze, "squeeze");
    checkKeys(squeeze, {"peak_force_N", "peak_force_R2_over_B"});
    CHECK(squeeze["peak_force_N"] > 0.0);
}

TEST_CASE("the same seed gives the same bytes, whatever the number of threads, and another seed does not") {
    const Folder folder;
    const auto arguments = stack("4", "1");
    summaryOf(folder, "a", with(arguments, {"--seed", "5"}));
    summaryOf(folder, "b", with(arguments, {"--seed", "5"}));
    summaryOf(folder, "threads", with(arguments, {"--seed", "5", "--threads", "2"}));
    summaryOf(folder, "other", with(arguments, {"--seed", "6"}));
    const std::string series = contentOf(folder / "a/series.csv");
    CHECK(series.size() > 10000);
    CHECK(series == contentOf(folder / "b/series.csv"));
    CHECK(series == contentOf(folder / "threads/series.csv"));
    CHECK(series != contentOf(folder / "other/series.csv"));
    CHECK(contentOf(folder / "a/trajectory.json") == contentOf(folder / "threads/trajectory.json"));
    const auto withoutTiming = [&](const std::string& name) {
        json summary = test::jsonOf(folder / (name + "/summary.json"));
        summary.erase("timing");
        return test::jsonText(summary);
    };
    CHECK(withoutTiming("a") == withoutTiming("b"));
}

TEST_CASE("parameters reach the simulation and the summary") {
    const Folder folder;
    const json summary = summaryOf(folder, "pile", with(stack("2", "0"), {"--param", "mu=0.5", "--seed", "9"}));
    CHECK(summary["parameters"]["shells"] == 2);
    CHECK(summary["parameters"]["mu"] == 0.5);
    CHECK(summary["seed"] == 9);
    CHECK(test::jsonOf(folder / "pile/trajectory.json")["shells"].size() == 2);
}

TEST_CASE("a fixed step is taken as it is") {
    const Folder folder;
    const json summary =
        summaryOf(folder, "fixed", {scene("ramp"), "--no-report", "--param", "time=0.1", "--fixed-dt", "0.001"});
    CHECK(summary["steps"] == 100);
    const record::Series series = seriesOf(folder / "fixed/series.csv");
    for (const double dt : *series.find("dt_s"))
        CHECK(dt == Approx(0.001).epsilon(1e-9));
}

TEST_CASE("contact problems are dumped, one file each") {
    const Folder folder;
    const json summary =
        summaryOf(folder, "out", {scene("ramp"), "--no-report", "--param", "time=0.1", "--dump", folder / "fcp"});
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "fcp")) {
        CHECK_THAT(contentOf(entry.path().string()), Catch::StartsWith("FCP2D"));
        ++files;
    }
    CHECK(files == summary["contact_solves"]);
}

TEST_CASE("benchmarks print a table and the same figures as JSON") {
    const Folder folder;
    const CommandResult ending = start({"bench", "--filter", "rod_evaluate", "--json", folder / "bench.json"});
    CHECK(ending.code == 0);
    CHECK_THAT(ending.out, Contains("median ms") && Contains("rod_evaluate") && Contains("peak memory"));
    const json figures = test::jsonOf(folder / "bench.json");
    REQUIRE(figures["benchmarks"].size() == 1);
    CHECK(figures["benchmarks"][0]["name"] == "rod_evaluate");
    CHECK(figures["benchmarks"][0]["median_ms"] > 0.0);
    CHECK(figures["peak_memory_MB"] > 0.0);
    const CommandResult unknown = start({"bench", "--filter", "zork"});
    CHECK(unknown.code == 2);
    CHECK_THAT(unknown.err, Contains("zork") && Contains("shell_on_cylinder") && Contains("stack30"));
    CHECK(start({"bench", "--filter", "rod_evaluate", "--json", "/proc/none/bench.json"}).code == 4);
}

TEST_CASE("contact solvers are measured on problems recorded from a simulation") {
    const Folder folder;
    const CommandResult ending = start({"bench", "--filter", "contact/strategy", "--json", folder / "bench.json"});
    REQUIRE(ending.code == 0);
    const json figures = test::jsonOf(folder / "bench.json");
    REQUIRE(figures["benchmarks"].size() == 2); // 1e-6 and 1e-8
    for (const json& row : figures["benchmarks"]) {
        CHECK(row["samples"] >= 100);
        CHECK(row["reached"] == 1.0); // the default method is there to reach the tolerance
    }
}
