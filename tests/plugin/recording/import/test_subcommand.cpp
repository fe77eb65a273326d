// `supercircle import`, started as a program.

#include "tests/plugin/recording/import/support.h"
#include "tests/support/json.h"

#include <nlohmann/json.hpp>

using namespace importingtest;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;
using test::CommandResult;

CommandResult start(const std::string& arguments) {
    return test::start(std::string(SC_PROGRAM) + " " + arguments);
}

} // namespace

TEST_CASE("import writes experiment, runs and account, and check agrees", "[importing]") {
    const Folder folder;
    const std::string file = folder.write("export.csv", exported()), out = folder.path + "/out";
    CommandResult end = start("import " + file + " --out " + out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    for (const char* name : {"experiment.json", "run_1.csv", "import.txt", "import.json"})
        CHECK(fs::file_size(out + "/" + name) > 100);
    CHECK_THAT(end.text, Contains("/friction/coefficient: friction coefficient"));
    CHECK_THAT(contentOf(out + "/import.txt"), Contains("/friction/coefficient: friction coefficient"));
    CHECK(test::jsonOf(out + "/import.json")["runs"][0]["rows"] == rows);
    end = start("check " + out + "/experiment.json");
    CHECK(end.code == 2);
    CHECK_THAT(end.text, Contains("/friction/coefficient: this is null"));

    const std::string own = folder.write("own.json", R"({"protocol": "shell_on_rigid_cylinder",
        "specimens": [{"arc_length_m": 0.0837758, "natural_curvature_1_m": 50.0, "thickness_m": 0.0005,
        "bending_modulus_N_m2": 2.3e-4, "linear_mass_kg_m": 0.0057}],
        "obstacles": [{"radius_m": 0.02}], "friction": {"coefficient": 0.3}})");
    end = start("import " + file + " --specimen " + own + " --out " + out);
    INFO(end.text);
    CHECK(end.code == 0);
    CHECK_THAT(end.text, Contains("kept as experiment.old.json") && Contains("ready: supercircle replay"));
    CHECK_THAT(contentOf(out + "/experiment.old.json"), Contains("null"));
    end = start("check " + out + "/experiment.json");
    INFO(end.text);
    CHECK(end.code == 0);
    CHECK_THAT(end.text, Contains("valid experiment"));
}

TEST_CASE("the worked example of the how-to page", "[importing]") {
    const Folder folder;
    const std::string example = std::string(SC_SOURCE_DIR) + "/examples/import/", out = folder.path + "/out";
    const CommandResult end =
        start("import " + example + "shell_on_cylinder.csv --specimen " + example + "specimen.json --out " + out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    CHECK_THAT(end.text, Contains("ready: supercircle replay"));
    const std::string page = contentOf(std::string(SC_SOURCE_DIR) + "/docs/how-to/import_recordings.md");
    std::istringstream account(contentOf(out + "/import.txt"));
    std::string line;
    std::getline(account, line); // the path
    while (std::getline(account, line))
        CHECK_THAT(page, Contains("    " + line + "\n"));
    // The export has a motion of 2 mm/s with corners at 1, 13 and 25 s and a crosshead height of 46.65 mm; a row is
    // 0.24 mm.
    const auto json = test::jsonOf(out + "/experiment.json");
    const auto times = json["runs"][0]["drive_time_s"].get<std::vector<double>>();
    REQUIRE(times.size() == 5);
    for (const auto& [i, t] : {std::pair{1, 1.0}, {2, 13.0}, {3, 25.0}})
        CHECK(times[static_cast<std::size_t>(i)] == Approx(t).margin(1e-3));
    CHECK(json["specimens"][0]["clamp"]["initial_point_m"][1].get<double>() == Approx(0.0466529).margin(0.3e-3));
}

TEST_CASE("the command of the page holds every option that was given", "[importing]") {
    const Folder folder;
    Style s;
    s.head = "time,displacement,force";
    const std::string file = folder.write("an export.csv", exported(s) + "1;2\n"), out = folder.path + "/out",
                      options =
                          " --units s,mm,N --tolerance 0.5 --accept jumps --cut falls --cut break --keep saturation ";
    CommandResult end = start("import '" + file + "'" + options + "--out " + out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    std::string page = contentOf(out + "/import.html");
    for (const char* option : {"--units s,mm,N", "--tolerance 0.5", "--accept jumps", "--cut falls", "--cut break",
                               "--keep saturation", "an export.csv' "})
        CHECK_THAT(page, Contains(option));
    const std::string other = folder.write("other.csv", exported()); // of several files the options are those given
    end = start("import '" + file + "' " + other + " --units s,mm,N --force positive --force-zero none --out " + out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    page = contentOf(out + "/import.html");
    CHECK_THAT(page, Contains("--force positive") && Contains("--force-zero none"));
}

TEST_CASE("the page shows decisions and a command that repeats the import", "[importing]") {
    const Folder folder;
    const std::string file = std::string(SC_SOURCE_DIR) + "/examples/import/shell_on_cylinder.csv",
                      out = folder.path + "/out";
    REQUIRE(start("import " + file + " --quiet --out " + out).code == 0);
    const std::string page = contentOf(out + "/import.html");
    for (const char* part : {"<svg", "sign of the force", "separator", "zero of the force", "nothing is doubtful"})
        CHECK_THAT(page, Contains(part));
    const std::size_t from = page.find("<code>supercircle ") + 18, to = page.find("</code>");
    REQUIRE(from < to);
    std::string command = page.substr(from, to - from);
    for (std::size_t at = 0; (at = command.find(out, at)) != std::string::npos; at += out.size() + 1)
        command.insert(at + out.size(), "2"); // beside it
    REQUIRE(start(command + " --quiet").code == 0);
    const bool same = contentOf(out + "2/run_1.csv") == contentOf(out + "/run_1.csv");
    CHECK(same);
}

TEST_CASE("import's exit codes", "[importing]") {
    const Folder folder;
    const std::string good = folder.write("good.csv", exported()), bad = folder.write("bad.csv", "nothing\n");
    CHECK(start("import " + bad + " --out " + folder.path + "/a").code == 2);
    CHECK_FALSE(fs::exists(folder.path + "/a")); // nothing is left behind
    CHECK(start("import " + folder.path + "/none.csv --out " + folder.path + "/a").code == 2);
    CHECK(start("import " + good).code == 2);
    CHECK(start("import --out " + folder.path).code == 2);
    CHECK(start("import " + good + " --rate -1 --out " + folder.path + "/a").code == 2);
    CHECK(start("import " + good + " --protocol nothing --out " + folder.path + "/a").code == 2);
    const CommandResult end = start("import " + good + " --out " + good + "/under");
    CHECK(end.code == 4);
    CHECK_THAT(end.text, Contains("good.csv/under"));
    CHECK(start("import " + good + " --quiet --out " + folder.path + "/b").text.empty());
    CHECK(start("import " + good + " --out " + folder.path + "/c > /dev/full").code == 4);
}

TEST_CASE("real exports are imported if present", "[importing]") {
    const fs::path real = fs::path(SC_TEST_DATA) / "../../../shared/recordings/real";
    if (!fs::exists(real)) {
        SUCCEED("no real exports beside the project");
        return;
    }
    const Folder folder;
    const std::string to = " --out " + folder.path + "/out";
    const std::string ring = (real / "ring_crush_aluminium/A1.txt").string();
    CommandResult end = start("import " + ring + to);
    CHECK(end.code == 2);
    CHECK_THAT(end.text, Contains("no headings") && Contains("--columns displacement[mm],force[N]"));
    end = start("import " + ring + " --columns 'displacement[mm],force[N]'" + to);
    INFO(end.text);
    CHECK(end.code == 0);
    CHECK_THAT(end.text, Contains("601 rows") && Contains("signs are reversed"));
    end = start("import " + (real / "steel_strip_bow/draw_curve_digitised.csv").string() + to);
    CHECK(end.code == 0);
    CHECK_THAT(end.text, Contains("22 rows") && Contains("the displacement starts at 49.76 mm"));
    const std::string swing = (real / "pendulum_free_swing/free_swing_01.txt").string();
    CHECK(start("import " + swing + to).code == 2);
    end = start("import " + swing + " --columns 'angle[deg]'" + to);
    CHECK(end.code == 0);
    CHECK_THAT(end.text, Contains("rows come at 1000 Hz") && Contains("/scene: the scene file"));
}
