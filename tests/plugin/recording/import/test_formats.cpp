// One known run in many machine formats: the values must be equal.

#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/import/drive.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// Imports to the known run, with break points of the commanded motion where they were put.
void same(const std::string& text, const importing::Hints& hints = {}, double slack = 1e-6) {
    const auto all = read(text, hints);
    INFO(all.error());
    REQUIRE(all);
    INFO(importing::account(*all));
    REQUIRE(all->runs.size() == 1);
    const importing::ImportedRun& run = all->runs[0];
    checkValues(run, slack);
    CHECK(run.rate == Approx(20.0).epsilon(1e-3));
    const std::vector<double> corner = {0.0, 1.0, 9.0, 17.0, 18.0}, way = {0.0, 0.0, 4e-3, 0.0, 0.0};
    REQUIRE(run.drive.time.size() == corner.size());
    for (std::size_t i = 0; i < corner.size(); ++i) { // a thousandth of the travel, and the time that takes
        CHECK(run.drive.time[i] == Approx(corner[i]).margin(8e-3));
        CHECK(run.drive.displacement[i] == Approx(way[i]).margin(4e-6));
    }
}

std::string utf16(const std::string& ascii, bool big) {
    std::string out = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : ascii) {
        out += big ? '\0' : c;
        out += big ? c : '\0';
    }
    return out;
}

} // namespace

TEST_CASE("the plain form", "[importing]") {
    same(exported());
    const std::string account = accountOf(exported());
    CHECK_THAT(account, Contains("separated by comma, decimal mark point") &&
                            Contains("line 1: column 3 \"force_N\" is force [N]") && !Contains("assumed") &&
                            !Contains("doubtful"));
}

TEST_CASE("separators, decimal commas and line ends", "[importing]") {
    Style s;
    for (const char separator : {';', '\t'})
        for (const char decimal : {'.', ','})
            for (const char* end : {"\n", "\r\n", "\r"}) {
                s.separator = separator;
                s.decimal = decimal;
                s.lineEnd = end;
                s.head = std::string("Zeit [s]") + separator + "Weg [mm]" + separator + "Kraft [N]";
                same(exported(s));
            }
    s = {};
    s.separator = ' ';
    s.head = "t_s d_mm F_N";
    s.head = "# t(s) d(mm) F(N)";
    same(exported(s));
    s.head = "t_s d_mm F_N";
    importing::Hints columns;
    columns.columns = {"time[s]", "displacement[mm]", "force[N]"};
    same(exported(s), columns);
}

TEST_CASE("decimal commas between commas are told apart by quotes", "[importing]") {
    std::string text = "\"Zeit (s)\",\"Weg (mm)\",\"Kraft (N)\"\n";
    for (int i = 0; i < rows; ++i) {
        const double t = timeOf(i);
        text += "\"" + printed(t, 6, ',') + "\",\"" + printed(wayOf(t), 6, ',') + "\",\"" +
                printed(forceOf(wayOf(t)), 6, ',') + "\"\n";
    }
    same(text);
}

TEST_CASE("encodings", "[importing]") {
    same("\xEF\xBB\xBF" + exported());
    same(utf16(exported(), false));
    same(utf16(exported(), true));
    Style s;
    s.head = "Pr\xFC"
             "fer: M\xFCller\nPr\xFC"
             "fzeit (s),D\xE9placement (\xB5m),Pr\xFC"
             "fkraft (N)";
    s.perMillimetre = 1000.0;
    same(exported(s));
    CHECK_THAT(accountOf(exported(s)), Contains("Windows-1252") && Contains("Prüfer: Müller") && Contains("[µm]"));
}

TEST_CASE("exports in Cyrillic and Japanese", "[importing]") {
    Style s;
    s.separator = ';';
    s.decimal = ',';
    s.head = "\xCE\xE1\xF0\xE0\xE7\xE5\xF6;7\n"                        // Образец
             "\xC2\xF0\xE5\xEC\xFF, \xF1;"                             // Время, с
             "\xCF\xE5\xF0\xE5\xEC\xE5\xF9\xE5\xED\xE8\xE5, \xEC\xEC;" // Перемещение, мм
             "\xCD\xE0\xE3\xF0\xF3\xE7\xEA\xE0, \xEA\xCD";             // Нагрузка, кН
    s.perNewton = 1e-3;
    s.digits = 9;
    same(exported(s));
    CHECK_THAT(accountOf(exported(s)), Contains("Windows-1251") && Contains("column 3 \"Нагрузка, кН\" is force [кН]"));
    s = {};
    s.head = "\x8E\x8E\x8C\xB1\x93\xFA,2020/1/1\n"                        // 試験日
             "\x8E\x9E\x8A\xD4,\x83\x58\x83\x67\x83\x8D\x81\x5B\x83\x4E," // 時間, ストローク
             "\x8E\x8E\x8C\xB1\x97\xCD\nsec,mm,N";                        // 試験力
    same(exported(s));
    CHECK_THAT(accountOf(exported(s)), Contains("Shift-JIS") && Contains("column 3 \"試験力\" is force [N]"));
}

TEST_CASE("units in names, in brackets, on a line of their own", "[importing]") {
    Style s;
    s.head = "Time,Extension,Load\n(min),(in),(lbf)";
    s.perSecond = 1.0 / 60.0;
    s.perMillimetre = 1.0 / 25.4;
    s.perNewton = 1.0 / 4.4482216152605;
    s.digits = 9;
    same(exported(s));
    s = {};
    s.head = "Zeit/ms,Weg in m,Standardkraft <kN>";
    s.perSecond = 1e3;
    s.perMillimetre = 1e-3;
    s.perNewton = 1e-3;
    s.digits = 9;
    same(exported(s));
}

TEST_CASE("a header block is kept in the account", "[importing]") {
    Style s;
    s.head = "\"Test report\"\n\"Operator\",\"A, B\"\nTest speed: 30 mm/min\n# Sample rate = 20 Hz\n\n\ntime_s,"
             "displacement_mm,force_N";
    same(exported(s));
    CHECK_THAT(accountOf(exported(s)), Contains("line 2: Operator: A, B") &&
                                           Contains("line 3: Test speed: 30 mm/min") &&
                                           Contains("line 4: Sample rate: 20 Hz") && !Contains("doubtful"));
}

TEST_CASE("other columns, sparse remarks, blank lines and sums below are left out", "[importing]") {
    std::string text = "time_s;displacement_mm;cycle;force_N;remark\n";
    for (int i = 0; i < rows; ++i) {
        const double t = timeOf(i);
        text += printed(t, 6) + ";" + printed(wayOf(t), 6) + ";1;" + printed(forceOf(wayOf(t)), 6) + ";" +
                (i == 200 ? "turn" : "") + "\n" + (i == 100 ? "\n" : "");
    }
    text += "\nMaximum;4;1;6;\nend of test\n";
    same(text);
    CHECK_THAT(accountOf(text), Contains("left out   line 1: column 3 \"cycle\", 5 \"remark\": not needed here") &&
                                    Contains("line 365: \"Maximum;4;1;6;\": column 1 \"time_s\" holds no number"));
}

TEST_CASE("a heading of remarks that no row has is none", "[importing]") {
    Style s;
    s.head = "time_s,displacement_mm,force_N,remark";
    same(exported(s));
}

TEST_CASE("the more direct of two columns of one quantity is used and reported", "[importing]") {
    std::string text = "time_s,crosshead position (mm),compressive displacement (mm),force_N,force setpoint (N)\n";
    for (int i = 0; i < rows; ++i) {
        const double t = timeOf(i);
        text += printed(t, 6) + "," + printed(7.0 + 1.1 * wayOf(t), 6) + "," + printed(wayOf(t), 6) + "," +
                printed(forceOf(wayOf(t)), 6) + ",99\n";
    }
    same(text);
    CHECK_THAT(accountOf(text),
               Contains("column 2 \"crosshead position (mm)\" is also a displacement; column 3 \"compressive") &&
                   Contains("(choose with --columns)"));
    importing::Hints hints;
    hints.columns = {"time[s]", "displacement[mm]", "-", "force[N]", "-"};
    const auto all = read(text, hints);
    REQUIRE(all);
    CHECK((*all->runs[0].signals.find(Quantity::Displacement))[180] == Approx(1.1 * 4e-3));
}

TEST_CASE("without headings the columns are asked for", "[importing]") {
    Style s;
    s.head = "test 7";
    CHECK(errorOf(exported(s)) ==
          "x.csv:2:1: there are no headings; expected time, displacement and force, or name them "
          "with --columns time[s],displacement[mm],force[N]");
    importing::Hints hints;
    hints.columns = {"time[s]", "displacement[mm]", "force[N]"};
    same(exported(s), hints);
}

TEST_CASE("units that nobody states are asked for", "[importing]") {
    Style s;
    s.head = "time,displacement,force";
    CHECK(errorOf(exported(s)) == "x.csv:1:6: no unit is stated for displacement (column 2 \"displacement\") and force "
                                  "(column 3 \"force\"); state it with --units, for instance --units mm,N");
    importing::Hints hints;
    hints.units = {importing::unitOf("mm"), importing::unitOf("kN")};
    s.perNewton = 1e-3;
    s.digits = 9;
    same(exported(s), hints); // fractions make a clock one of seconds
    hints.columns = {"time", "displacement", "force"};
    same(exported(s), hints);
}

TEST_CASE("without times they come from a rate or a speed", "[importing]") {
    std::string text = "displacement_mm,force_N\n";
    for (int i = 0; i < rows; ++i)
        text += printed(wayOf(timeOf(i)), 6) + "," + printed(forceOf(wayOf(timeOf(i))), 6) + "\n";
    importing::Hints hints;
    hints.rate = 20.0;
    same(text, hints);
    same("Sampling rate: 20 Hz\n" + text);
    CHECK_THAT(accountOf(text), Contains("assumed    there is no time; the crosshead is assumed to move at 1 mm/s"));
    const auto all = read("Speed: 30 mm/min\n" + text); // dwells cannot be timed: 16 s of motion remain
    REQUIRE(all);
    CHECK(all->runs[0].drive.time.back() == Approx(16.0).margin(0.05));
    CHECK_THAT(importing::worst(*all), Contains(" of 361 rows were left out"));
    CHECK_THAT(importing::account(*all),
               Contains("line 1: there is no time; the crosshead moves at 0.5 mm/s as stated in the header"));
}

TEST_CASE("an ambiguous decimal mark is reported", "[importing]") {
    std::string text = "t (s);d (mm);F (N)\n";
    for (int i = 0; i < 50; ++i)
        text += std::to_string(i) + ";" + std::to_string(1 + i) + ".500;" + std::to_string(2 + i) + ".125\n";
    CHECK_THAT(accountOf(text), Contains("every number has three digits behind its point; it is taken as the decimal"));
}

TEST_CASE("markers come with the run or in a file of their own", "[importing]") {
    std::string run = exported(), markers = "time_s,m0_x_mm,m0_y_mm,tip_x_mm,tip_y_mm,lost_x_mm\n";
    for (int i = 0; i < rows; i += 4)
        markers += printed(timeOf(i), 3) + ",1,2,3," + printed(wayOf(timeOf(i)), 4) + ",5\n";
    const Folder folder;
    const auto all = importing::readExports({folder.write("a.csv", run), folder.write("b.csv", markers)}, {});
    INFO(all.error());
    REQUIRE(all);
    REQUIRE(all->runs.size() == 1);
    CHECK(all->markerNames == std::vector<std::string>{"m0", "tip"});
    CHECK(all->runs[0].markersFile == "run_1_markers.csv");
    CHECK(all->runs[0].markers.rows() == 91);
    CHECK_THAT(importing::account(*all), Contains("marker lost has only one coordinate"));
    const auto files = importing::runFiles(*all);
    REQUIRE(files);
    CHECK(files->size() == 2);
    CHECK((*files)[1].second.substr(0, 42) == "time_s,m0_x_mm,m0_y_mm,tip_x_mm,tip_y_mm\n0");
    CHECK_THAT(importing::readExports({folder.path + "/b.csv"}, {}).error(),
               Contains("expected the file of the run first"));
}

TEST_CASE("markers keep their time against the run", "[importing]") {
    // both clocks start at 100 s, the camera 2 s later: its first frame is at 2 s of the run
    std::string run = "time_s,displacement_mm,force_N\n", markers = "time_s,m_x_mm,m_y_mm\n";
    for (int i = 0; i < rows; ++i)
        run += printed(100.0 + timeOf(i), 3) + "," + printed(wayOf(timeOf(i)), 6) + "," +
               printed(forceOf(wayOf(timeOf(i))), 6) + "\n";
    for (int i = 40; i < rows; i += 4)
        markers += printed(100.0 + timeOf(i), 3) + ",1," + printed(wayOf(timeOf(i)), 4) + "\n";
    const Folder folder;
    const std::string runFile = folder.write("a.csv", run);
    auto all = importing::readExports({runFile, folder.write("b.csv", markers)}, {});
    REQUIRE(all);
    CHECK(all->runs[0].markers.find(Quantity::Time)->front() == Approx(2.0));
    // another clock: both are assumed to start together, with a remark
    std::string other = "time_s,m_x_mm,m_y_mm\n";
    for (int i = 0; i < rows; i += 4)
        other += printed(timeOf(i), 3) + ",1,2\n";
    all = importing::readExports({runFile, folder.write("d.csv", other)}, {});
    REQUIRE(all);
    CHECK(all->runs[0].markers.find(Quantity::Time)->front() == 0.0);
    CHECK_THAT(importing::account(*all), Contains("both are taken to start together"));
}

TEST_CASE("an angle alone is converted", "[importing]") {
    std::string text = "trigger_deg, sample_rate, duration\n90, 1000, 5\n";
    for (int i = 0; i < 100; ++i)
        text += printed(-90.0 - 0.1 * i, 2) + "\n";
    CHECK_THAT(errorOf(text), Contains("x.csv:3:1: there are no headings") && Contains("--columns angle[deg]"));
    importing::Hints hints;
    hints.columns = {"angle[deg]"};
    const auto all = read(text, hints);
    INFO(all.error());
    REQUIRE(all);
    CHECK(all->runs[0].signals.find(Quantity::Angle)->at(10) == Approx(-91.0 * M_PI / 180.0));
    CHECK(all->runs[0].rate == Approx(1000.0));
    CHECK_THAT(importing::account(*all), Contains("assumed    line 2: there is no time; rows come at 1000 Hz"));
}

TEST_CASE("an export gives bitwise identical files", "[importing]") {
    const auto a = read(exported()), b = read(exported());
    REQUIRE((a && b));
    CHECK(importing::runFiles(*a).value() == importing::runFiles(*b).value());
}

TEST_CASE("a separator that names no quantity is no close runner-up", "[importing]") {
    Style s;
    s.head = "Zeit (s);Weg (mm);Kraft (N)";
    s.separator = ';';
    s.decimal = ',';
    const auto all = read(exported(s));
    REQUIRE(all);
    const importing::Decision& d = all->sources[0].table.layout.decisions.front();
    CHECK(d.question == "separator");
    CHECK(d.answer == "semicolon");
    CHECK(d.odds > 1000.0); // three named quantities, ten to one each
}

TEST_CASE("placeholders and rules below the headings are skipped", "[importing]") {
    for (const char* line :
         {"-,-,-", "---,---,---", "n/a,n/a,n/a", "------------------", "*,*,*", "=====,=====,====="}) {
        for (const char* head : {"time_s,displacement_mm,force_N\n", "time,displacement,force\ns,mm,N\n"}) {
            Style s;
            s.head = std::string(head) + line;
            const auto all = read(exported(s));
            INFO(s.head << ": " << all.error());
            REQUIRE(all);
            checkValues(all->runs[0]);
        }
    }
}

TEST_CASE("lengths in messages have a unit that suits them", "[importing]") {
    CHECK(importing::shownLength(1.196e-5) == "11.96 µm");
    CHECK(importing::shownLength(2e-10) == "0.2 nm");
    CHECK(importing::shownLength(0.012) == "12 mm");
    CHECK(importing::shownLength(-1.5) == "-1.5 m");
}
