// Files that cannot be imported: each error says where and what was expected. Random bytes do no more harm.

#include "tests/plugin/recording/import/change_bytes.h"
#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/import/template.h"

#include <random>

using namespace importingtest;
using Catch::Contains;

TEST_CASE("empty and near empty files", "[importing]") {
    CHECK(errorOf("") == "x.csv: the file is empty; expected a text of lines and columns (export it as CSV)");
    CHECK_THAT(errorOf("\n\n\n"), Contains("x.csv: there is no table of numbers in it"));
    CHECK_THAT(errorOf("\xEF\xBB\xBF"), Contains("x.csv: "));
    CHECK_THAT(errorOf("time_s,displacement_mm,force_N\n"), Contains("there is no table of numbers"));
    CHECK_THAT(errorOf("time_s,displacement_mm,force_N\n0,0,0\n"), Contains("x.csv: "));
    CHECK_THAT(errorOf("Dear colleague,\nthe machine is broken.\n"), Contains("there is no table of numbers"));
    CHECK_THAT(errorOf("PK\x03\x04 and so on"), Contains("x.csv: this is a spreadsheet or an archive"));
    CHECK_THAT(importing::readExports({"/not/there.csv"}, {}).error(),
               Contains("/not/there.csv") && Contains("there is no such file"));
    CHECK_THAT(importing::readExports({"/"}, {}).error(), Contains("cannot read /"));
}

TEST_CASE("a constant channel is refused where it begins", "[importing]") {
    std::string constant = "a test\ntime_s,displacement_mm,force_N\n", missing = constant, still = constant;
    for (int i = 0; i < 50; ++i) {
        constant += std::to_string(i) + "," + std::to_string(i) + ",0.25\n";
        missing += std::to_string(i) + "," + std::to_string(i) + (i % 3 == 0 ? ",1.5\n" : ",nan\n");
        still += std::to_string(i) + ",2," + std::to_string(i % 7) + "\n";
    }
    CHECK(errorOf(constant) ==
          "x.csv:3:1: the force is 0.25 N in every row from here on; expected one that changes (is "
          "the load cell connected, and this its column?)");
    CHECK(errorOf(missing) ==
          "x.csv:3:1: 33 of 50 values of the force are missing from here on; expected at least half "
          "of them");
    CHECK_THAT(accountOf(still),
               Contains("doubtful   the displacement never changes: nothing was commanded in this run"));
}

TEST_CASE("times that cannot be corrected are refused where they begin", "[importing]") {
    std::string stopped = "time_s,displacement_mm,force_N\n", back = stopped, missing = stopped;
    for (int i = 0; i < 50; ++i) {
        const std::string rest = "," + std::to_string(i) + "," + std::to_string(i * i) + "\n";
        stopped += "3" + rest;
        back += std::to_string(100 - i) + rest;
        missing += (i % 3 == 0 ? std::to_string(i) : "") + rest;
    }
    CHECK_THAT(errorOf(stopped), Contains("x.csv:2:1: the time never changes from here on"));
    CHECK_THAT(errorOf(back), Contains("x.csv:3:1: the time runs back in 49 of 50 rows, here first"));
    CHECK_THAT(errorOf(missing), Contains("x.csv:2:1: 33 of 50 times are missing"));
}

TEST_CASE("unknown columns are reported with their position", "[importing]") {
    Style s;
    s.head = "Operator;me\ntime (s),displacement (mm),force (bananas)";
    CHECK(errorOf(exported(s)) ==
          "x.csv:2:28: column 3 \"force (bananas)\": \"bananas\" is no unit of force; expected "
          "one of N, kN, mN, lbf, kgf; state it with --columns time[s],displacement[mm],force[N]");
    s.head = "time (N),displacement (mm),force (N)";
    CHECK_THAT(errorOf(exported(s)), Contains("x.csv:1:1: column 1 \"time (N)\": \"N\" is no unit of time"));
    s.head = "a,b,c";
    CHECK(errorOf(exported(s)) == "x.csv:1:1: no column is recognised among \"a\", \"b\", \"c\"; expected time, "
                                  "displacement and force, or name them with --columns "
                                  "time[s],displacement[mm],force[N]");
    s.head = "time (s),displacement (mm),colour";
    CHECK_THAT(errorOf(exported(s)), Contains("x.csv:1:1: there is neither a force nor an angle"));
    s.head = "Time (s),Displacement (mm),Mass (g)";
    CHECK_THAT(errorOf(exported(s)), Contains("--columns time[s],displacement[mm],force[gf]"));
    s.head = "time (s),colour,force (N)";
    CHECK_THAT(errorOf(exported(s)), Contains("x.csv:1:1: there is a force but no displacement"));
    importing::Hints hints;
    hints.columns = {"time", "force"};
    CHECK_THAT(errorOf(exported(), hints), Contains("2 columns are named, but the table has 3"));
    hints.columns = {"time", "way[mm]", "force"};
    CHECK_THAT(errorOf(exported(), hints), Contains("\"way[mm]\" is no quantity; expected time, displacement, force"));
}

TEST_CASE("invalid rows are reported one by one, then counted", "[importing]") {
    std::string text = exported();
    for (const char* at : {"\n2.000000", "\n3.000000", "\n4.000000", "\n5.000000", "\n6.000000"})
        text = with(text, at, std::string("\nx") + at);
    CHECK_THAT(accountOf(text), Contains("line 42: \"x\" has 1 cell instead of 3") &&
                                    Contains("2 more lines that are no rows of numbers"));
    CHECK_THAT(accountOf(with(exported(), "\n2.000000,", "\n2.000000,2.000000,")),
               Contains("has 4 cells instead of 3"));
    CHECK_THAT(accountOf(with(exported(), "\n2.000000,0.500000,", "\n2.000000,ouch,")),
               Contains("column 2 \"displacement_mm\" holds no number"));
}

TEST_CASE("control characters of a file do not reach the terminal", "[importing]") {
    Style s;
    s.head = "time_s,displacement_mm,\x1B[31mforce_q";
    CHECK_THAT(errorOf(exported(s)), Contains("\"\\x1B[31mforce_q\"") && !Contains("\x1B"));
    s.head = "Operator: \x07\x1B[2J\xC2\x9Bq\ntime_s,displacement_mm,force_N";
    CHECK_THAT(accountOf(exported(s)), Contains("Operator: \\x07\\x1B[2J\\x9Bq") && !Contains("\x1B"));
}

TEST_CASE("a file given twice is refused", "[importing]") {
    const Folder folder;
    const std::string file = folder.write("a.csv", exported());
    CHECK_THAT(importing::readExports({file, file}, {}).error(), Contains("a.csv: this file is given twice"));
}

namespace {

/// For any bytes: a report or an error; with a report also a description and files.
void survives(const std::string& bytes) {
    const Folder folder;
    const auto all = importing::readExports({folder.write("x.csv", bytes)}, {});
    if (!all) {
        REQUIRE_FALSE(all.error().empty());
        return;
    }
    REQUIRE_FALSE(importing::account(*all).empty());
    REQUIRE(importing::runFiles(*all));
    const auto description = importing::describe(*all, {});
    REQUIRE(description);
    REQUIRE_FALSE(importing::accountJson(*all, *description).empty());
}

/// A sound export with bytes changed, taken out, doubled, or lines cut.
std::string mutated(std::mt19937& random, const std::vector<std::string>& sound) {
    std::string text = sound[random() % sound.size()];
    const std::string spice = "\n\r\t;,.\"'-+eE0123456789 :#NnaA\x00\xFF\xFE\xEF\xE2\xD8";
    for (auto k = 1 + random() % 40; k > 0 && !text.empty(); --k) {
        const std::size_t at = random() % text.size();
        supercircle::test::changeBytes(text, at, random() % 5, spice, random);
    }
    if (random() % 8 == 0)
        text.resize(random() % (text.size() + 1));
    return text;
}

void fuzz(int files, unsigned seed) {
    Style german;
    german.head = "Pr\xFC"
                  "fer;M\xFCller\nGeschwindigkeit;30;mm/min\nZeit;Weg;Kraft\ns;mm;N";
    german.separator = ';';
    german.decimal = ',';
    std::string wide = "\xFF\xFE";
    for (const char c : exported(Style{}, 0, 60))
        wide += {c, '\0'};
    const std::vector<std::string> sound = {exported(Style{}, 0, 120), exported(german, 0, 90), wide,
                                            "displacement_mm,force_N\n0,1\n1,2\n2,3\n3,5\n"};
    std::mt19937 random(seed); // the same on every machine
    for (int i = 0; i < files; ++i) {
        INFO("file " << i << " of seed " << seed);
        if (i % 10 == 0) {
            std::string noise(random() % 2000, '\0');
            for (char& c : noise)
                c = static_cast<char>(random() % 256);
            survives(noise);
        } else {
            survives(mutated(random, sound));
        }
    }
}

} // namespace

TEST_CASE("random bytes and mutilated exports do no harm", "[importing]") {
    fuzz(300, 1);
}

TEST_CASE("thousands of mutilated exports do no harm", "[importing][slow]") {
    fuzz(5000, 2);
}
