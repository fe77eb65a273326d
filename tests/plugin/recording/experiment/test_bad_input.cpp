// Experiments with mistakes: the message says where, what, and what was meant.

#include "tests/plugin/recording/experiment/support.h"

#include <algorithm>

using namespace experimenttest;
using Catch::Contains;

namespace {

const std::string& good() {
    static const std::string text = contentOf(baseline(101));
    return text;
}

} // namespace

TEST_CASE("a misspelled key is reported with the correct one", "[experiment]") {
    const std::string all = problemsOf(with(good(), "\"bending_modulus_N_m2\"", "\"bending_modulus_Nm2\""));
    CHECK_THAT(all, Contains("e.json:22:4: /specimens/0/bending_modulus_Nm2: unknown key"));
    CHECK_THAT(all, Contains("did you mean \"bending_modulus_N_m2\"?"));
    CHECK_THAT(all, Contains("/specimens/0: \"bending_modulus_N_m2\" is missing"));
    // optional keys too: a silent zero uncertainty would be worse
    CHECK_THAT(problemsOf(with(good(), "thickness_unc_m", "thickness_uncm")),
               Contains("did you mean \"thickness_unc_m\"?") && !Contains("note:"));
}

TEST_CASE("a key without meaning is noted, not rejected", "[experiment]") {
    const std::string all = problemsOf(with(good(), "\"schema\"", "\"laboratory_xyz\": 3, \"schema\""));
    CHECK_THAT(all, Contains("note: /laboratory_xyz: this key has no meaning here"));
}

TEST_CASE("wrong values are reported with their position", "[experiment]") {
    CHECK_THAT(problemsOf(with(good(), "\"thickness_m\": 0.0005", "\"thickness_m\": -0.0005")),
               Contains("/specimens/0/thickness_m: -0.0005 is out of range; expected a number > 0"));
    CHECK_THAT(problemsOf(with(good(), "\"coefficient\": 0.3", "\"coefficient\": \"0.3\"")),
               Contains("/friction/coefficient: this is a text; expected a number >= 0"));
    CHECK_THAT(problemsOf(with(good(), "shell_on_rigid_cylinder", "shell_on_rigid_cilinder")),
               Contains("/protocol: unknown value") && Contains("did you mean \"shell_on_rigid_cylinder\"?"));
    CHECK_THAT(problemsOf(with(good(), "rod-recordings/1", "rod-recordings/7")),
               Contains("e.json:2:12: /schema: this is \"rod-recordings/7\""));
    CHECK_THAT(problemsOf(with(good(), "\"arc_fraction\": 0.02", "\"arc_fraction\": 1.02")),
               Contains("/markers/0/arc_fraction: 1.02 is out of range"));
    CHECK_THAT(problemsOf(with(good(), "\"specimen\": \"A\"", "\"specimen\": \"a\"")),
               Contains("there is no specimen \"a\"") && Contains("did you mean \"A\"?"));
    CHECK_THAT(problemsOf(with(good(), "\"arc_position_m\": 0.045", "\"arc_position_m\": 0.145")),
               Contains("the clamp lies beyond the end"));
    CHECK_THAT(problemsOf("{"), Contains("e.json:1:2:"));
    CHECK_THAT(problemsOf(""), Contains("the file is empty"));
}

TEST_CASE("an unknown kind is the only problem: the keys that depend on it are not judged", "[experiment]") {
    const auto only = [](const std::string& from, const std::string& to) {
        const std::string all = problemsOf(with(good(), from, to));
        CHECK(std::count(all.begin(), all.end(), '\n') == 1);
        return all;
    };
    CHECK_THAT(only("\"where\": \"middle\"", "\"where\": \"centre\""), Contains("/clamp/where: unknown value"));
    CHECK_THAT(only("\"type\": \"cylinder\"", "\"type\": \"drum\""), Contains("/obstacles/0/type: unknown value"));
    CHECK_THAT(only("\"protocol\": \"shell_on_rigid_cylinder\"", "\"protocol\": \"scenes\""),
               Contains("/protocol: unknown value") && Contains("did you mean \"scene\"?"));
}

TEST_CASE("the drive must be valid", "[experiment]") {
    CHECK_THAT(problemsOf(with(good(), "13.0,", "0.5,")),
               Contains("/runs/0/drive_time_s") && Contains("break point 2"));
    CHECK_THAT(problemsOf(with(good(), "    24,\n", "")),
               Contains("/runs/0/drive_displacement_mm: 4 break points; expected 5"));
}

TEST_CASE("what the protocol needs must be there", "[experiment]") {
    CHECK_THAT(problemsOf(with(good(), "shell_on_rigid_cylinder", "two_shells")),
               Contains("does not fit the protocol two_shells; expected two specimens"));
    CHECK_THAT(problemsOf(with(good(), "\"machine_head\"", "\"ground\"")), Contains("the crosshead carries nothing"));
}

TEST_CASE("a force zero in other words is noted", "[experiment]") {
    CHECK_THAT(problemsOf(with(good(), "the mean reading of the first 0.5 s is subtracted", "tared by hand")),
               Contains("/sensors/force_zero: not understood"));
}

TEST_CASE("the files of the runs are checked", "[experiment]") {
    const Folder folder;
    const std::string path = folder.write("experiment.json", good());
    CHECK_THAT(experiment::load(path).error(), Contains("run_1.csv"));
    const std::string csv = contentOf(std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/run_1.csv");
    const std::string markers =
        contentOf(std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/run_1_markers.csv");
    folder.write("run_1_markers.csv", markers);
    folder.write("run_1.csv", csv);
    CHECK(experiment::load(path));

    folder.write("run_1.csv", with(csv, "0.120,0.000,", "0.120,zero,"));
    CHECK_THAT(experiment::load(path).error(), Contains("run_1.csv:5:7:"));
    folder.write("run_1.csv", with(csv, "force_N", "force_kN"));
    CHECK_THAT(experiment::load(path).error(), Contains("force_N"));
    folder.write("run_1.csv", with(csv, "\n0.120,", "\n0.020,"));
    CHECK_THAT(experiment::load(path).error(), Contains("time_s of row 4"));
    folder.write("run_1.csv", csv + "99.0,0.0,0.0\n");
    CHECK_THAT(experiment::load(path).error(), Contains("beyond drive_time_s"));
    folder.write("run_1.csv", csv);
    folder.write("run_1_markers.csv", with(markers, "m3_y_mm", "m3_z_mm"));
    CHECK_THAT(experiment::load(path).error(), Contains("m3_y_mm"));
    CHECK_THAT(experiment::load(path + ".not").error(), Contains("no such file"));
}

TEST_CASE("files outside of the experiment's folder are refused unless allowed", "[experiment]") {
    namespace fs = std::filesystem;
    const test::Folder folder;
    const std::string from = fs::path(baseline(101)).parent_path().string();
    fs::create_directory(folder.path + "/inner");
    for (const char* name : {"run_1.csv", "run_1_markers.csv"})
        fs::copy_file(from + "/" + name, folder.path + "/" + name);
    std::string text = test::contentOf(baseline(101));
    for (const char* name : {"\"run_1.csv\"", "\"run_1_markers.csv\""})
        text = test::with(text, name, "\"../" + std::string(name).substr(1));
    const std::string file = folder.write("inner/experiment.json", text);
    std::vector<scene::Problem> problems;
    CHECK_FALSE(experiment::load(file, problems));
    REQUIRE(problems.size() == 2);
    CHECK(problems[0].toString() == file + ": /runs/0/file: \"../run_1.csv\" lies outside of the experiment's folder; "
                                           "expected a file in it; --allow-outside reads others");
    problems.clear();
    CHECK(experiment::load(file, problems, experiment::Outside::Allowed));
}
