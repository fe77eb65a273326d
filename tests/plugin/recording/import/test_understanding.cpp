// What decides, and what is asked for: columns, clocks, units, signs, zeros, and faults of the whole.

#include "tests/plugin/recording/import/support.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// Rows of the known run, written by `row`.
template <class Row>
std::string table(const std::string& head, const Row& row) {
    std::string text = head + "\n";
    for (int i = 0; i < rows; ++i)
        text += row(i, timeOf(i), wayOf(timeOf(i)), forceOf(wayOf(timeOf(i)))) + "\n";
    return text;
}

std::string cell(double v, int digits = 6, char decimal = '.') {
    return printed(v, digits, decimal);
}

/// The run, pushed on from a force that is there at the start.
std::string preloaded(double force, double dwell, double noise = 0.0) {
    std::string text = "time_s,displacement_mm,force_N\n";
    for (int i = 0; i < 400; ++i) {
        const double t = 0.05 * i, way = std::max(0.0, t - dwell);
        text += cell(t) + "," + cell(way) + "," + cell(force + 5.0 * way + noise * std::sin(12.9898 * i * i)) + "\n";
    }
    return text;
}

} // namespace

TEST_CASE("specimens side by side are runs of their own", "[importing]") {
    const auto text = table("Raw 1,,,Annealed,,\nTime,Force,Stroke,Time,Force,Stroke\nsec,N,mm,sec,N,mm",
                            [](int i, double t, double way, double force) {
                                const std::string first = cell(t) + "," + cell(force) + "," + cell(way);
                                const std::string second = cell(t) + "," + cell(2.0 * force) + "," + cell(way);
                                return (i < 300 ? first : ",,") + "," + second;
                            });
    const auto all = imported(text);
    REQUIRE(all.runs.size() == 2);
    checkValues(all.runs[0], 1e-6, 0, 300);
    CHECK(all.runs[1].signals.rows() == static_cast<std::size_t>(rows));
    CHECK(all.runs[1].signals.find(Quantity::Force)->at(180) == Approx(12.0));
    CHECK(all.sources[0].table.specimen == "Raw 1");
    CHECK(all.sources[1].table.specimen == "Annealed");
    CHECK(all.sources[0].lost + all.sources[1].lost == 0);
}

TEST_CASE("a decimal comma beside a decimal point", "[importing]") {
    const auto all = imported(table("time (s);displacement (mm);force (N)", [](int, double t, double way, double f) {
        return cell(t, 6, ',') + ";" + cell(way) + ";" + cell(f, 6, ',');
    }));
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all), Contains("column 2 has decimal points"));
}

TEST_CASE("blocks with remarks, a counter and two clocks", "[importing]") {
    // the second clock starts again with every block of 100 rows; block lines and a stray number are no rows
    const auto text =
        table("C:\\data\\1.TXT\t\t\t\t\t\nAxial Counts\t0\t\t\t\t\nPoints\tElapsed Time\tScan Time\tDisp 1\tLoad 1"
              "\tLoad 2\n      \tSec     \tSec\tmm    \tN\tN\t-0.08",
              [](int i, double t, double way, double force) {
                  return (i > 0 && i % 100 == 0 ? std::string("Axial Counts\t0\t\t\t\t\n") : "") +
                         std::to_string(i + 1) + "\t" + cell(t) + "\t" + cell(timeOf(i % 100)) + "\t" + cell(way) +
                         "\t" + cell(force) + "\t" + cell(-4.94 + 0.001 * (i % 3)) + "\t";
              });
    const auto all = imported(text);
    REQUIRE(all.runs.size() == 1);
    checkValues(all.runs[0]);
    CHECK(all.sources[0].lost == 0);
}

TEST_CASE("a time of day beside a clock is not used", "[importing]") {
    const auto all =
        imported(table("Datum;Tageszeit;Laufzeit;Weg;Kraft\nd;d;s;mm;N", [](int, double t, double way, double force) {
            return "45364;" + cell(0.39 + t / 86400.0, 8) + ";" + cell(t) + ";" + cell(way) + ";" + cell(force);
        }));
    checkValues(all.runs[0]);
}

TEST_CASE("two sensors that differ are asked for, two that agree are one", "[importing]") {
    const auto two = [](double factor, double wave) {
        return table("time_s,Extension (mm),Load 1 (N),Load 2 (N)", [&](int i, double t, double way, double force) {
            return cell(t) + "," + cell(way) + "," + cell(force) + "," +
                   cell(factor * force + wave * std::sin(0.1 * i));
        });
    };
    CHECK_THAT(errorOf(two(0.5, 2.0)), Contains("\"Load 1 (N)\" and column 4 \"Load 2 (N)\" are both a force") &&
                                           Contains("--columns time[s],displacement[mm],force[N],-"));
    checkValues(imported(two(-1.0, 0.0)).runs[0]);
}

TEST_CASE("percent are no newtons", "[importing]") {
    for (const char* heading : {"Kraft in %", "Kraft [%]", "Load (%)"}) {
        Style s;
        s.head = std::string("time_s,displacement_mm,") + heading;
        CHECK_THAT(errorOf(exported(s)), Contains("is no unit of force"));
    }
}

TEST_CASE("a counter of the rows is a clock, noise is none", "[importing]") {
    const auto text = table("Index,Force [ kN ],Displacement [ mm ]", [](int i, double, double, double) {
        const double way = 0.01 * i, noise = 0.02 * std::sin(12.9898 * i * i);
        return std::to_string(i < 100 ? i + 1 : i + 11) + "," + cell(1e-3 * way) + "," + cell(way + noise);
    });
    const auto all = imported(text);
    const auto& t = *all.runs[0].signals.find(Quantity::Time);
    REQUIRE(t.size() == static_cast<std::size_t>(rows));
    for (std::size_t i = 1; i < t.size(); ++i) // ten rows are missing in the count
        REQUIRE(t[i] - t[i - 1] == Approx((i == 100 ? 11.0 : 1.0) * t[1]));
    // 3.6 mm at 1 mm/s; the turning points are known to the noise
    CHECK(t.back() == Approx(3.6 * (static_cast<double>(rows) + 9.0) / static_cast<double>(rows - 1)).epsilon(0.05));
}

TEST_CASE("a lost decimal mark is refused", "[importing]") {
    // a spreadsheet writes 33.3973 as 333,973 and 33.5970 as 33,597
    std::string text = "Time;Displacement;Force\n(s);(mm);(kN)\n";
    for (int i = 0; i < 300; ++i) {
        const long digits = 333973 + 167 * i;
        std::string way = std::to_string(digits % 10 == 0 ? digits / 10 : digits);
        way.insert(way.size() - 3, ",");
        text += cell(0.02 * i, 2, ',') + ";" + way + ";" + cell(0.02 + 1e-4 * i, 4, ',') + "\n";
    }
    CHECK_THAT(errorOf(text), Contains("the displacement jumps and comes back within two rows 30 times in 300 rows") &&
                                  Contains("--accept jumps"));
    importing::Hints hints;
    hints.accept = {"jumps"};
    CHECK_THAT(importing::account(imported(text, hints)), Contains("accepted by --accept jumps"));
}

TEST_CASE("rows that hold numbers and cannot be used are refused above one in a hundred", "[importing]") {
    const auto spoilt = [](int every) {
        return table("time_s,displacement_mm,force_N", [every](int i, double t, double way, double force) {
            return cell(t) + "," + cell(way) + (i % every == every - 1 ? "," : "") + "," + cell(force);
        });
    };
    CHECK_THAT(errorOf(spoilt(50)),
               Contains("x.csv:51:1: 7 of 361 rows could not be used, this one first") && Contains("--accept dropped"));
    CHECK(importing::worst(imported(spoilt(200))) == "1 of 361 rows were left out");
    importing::Hints hints;
    hints.accept = {"dropped"};
    CHECK(importing::worst(imported(spoilt(50), hints)) == "7 of 361 rows were left out");
}

TEST_CASE("a preload is kept, an offset is not", "[importing]") {
    const auto forceOfRow = [](const importing::Imported& all, std::size_t i) {
        return all.runs[0].signals.find(Quantity::Force)->at(i);
    };
    // a ramp from the first row on: its first half second is no zero
    CHECK(forceOfRow(imported(preloaded(8.0, 0.0)), 0) == Approx(8.0));
    CHECK(forceOfRow(imported(preloaded(8.0, 0.0, 0.05)), 0) == Approx(8.0).margin(0.051));
    // the crosshead rests, and the force goes up as it starts: the specimen was in contact
    const auto held = imported(preloaded(8.0, 1.0, 0.01));
    CHECK(forceOfRow(held, 0) == Approx(8.0).margin(0.011));
    CHECK_THAT(importing::account(held), Contains("kept as a preload (--force-zero 0.."));
    // stated zeros
    importing::Hints hints;
    hints.forceZero.kind = importing::ForceZero::Kind::Value;
    hints.forceZero.value = 2.0;
    CHECK(forceOfRow(imported(preloaded(8.0, 1.0), hints), 0) == Approx(6.0));
    hints.forceZero.kind = importing::ForceZero::Kind::Window;
    hints.forceZero.to = 0.5;
    CHECK(forceOfRow(imported(preloaded(8.0, 1.0), hints), 0) == Approx(0.0).margin(1e-12));
    hints.forceZero.kind = importing::ForceZero::Kind::None;
    CHECK(forceOfRow(imported(exported(), hints), 200) == Approx(forceOf(wayOf(timeOf(200)))));
    hints.forceZero.kind = importing::ForceZero::Kind::Window;
    hints.forceZero.from = 1e3;
    hints.forceZero.to = 2e3;
    CHECK_THAT(errorOf(exported(), hints), Contains("no sample of the force lies between 1000 and 2000 s"));
}

TEST_CASE("signs that contradict each other are asked for", "[importing]") {
    const auto unloading = table("time_s,displacement_mm,force_N", [](int, double t, double way, double) {
        return cell(t) + "," + cell(way) + "," + cell(8.0 - 1.5 * way);
    });
    CHECK_THAT(errorOf(unloading), Contains("a preload that is taken off, or a zero that is wrong") &&
                                       Contains("--force positive or --force negative"));
    const auto swing = table("time_s,displacement_mm,force_N", [](int, double t, double, double) {
        const double way = t < 4.0 ? 0.2 * t : 0.8 - 0.4 * (t - 4.0);
        return cell(t) + "," + cell(way) + "," + cell(std::abs(way));
    });
    CHECK_THAT(errorOf(swing), Contains("--displacement positive or --displacement negative"));
}

TEST_CASE("a saturated sensor leaves rows without a force", "[importing]") {
    const auto text = table("time_s,displacement_mm,force_N", [](int, double t, double way, double force) {
        return cell(t) + "," + cell(way) + "," + cell(std::min(force, 4.0));
    });
    const auto all = imported(text);
    CHECK(std::isnan(all.runs[0].signals.find(Quantity::Force)->at(180)));
    CHECK_THAT(importing::account(all),
               Contains("stays at its largest value, 4 N, in 81 rows: the sensor is saturated"));
    importing::Hints hints;
    hints.keep = {"saturation"};
    CHECK(imported(text, hints).runs[0].signals.find(Quantity::Force)->at(180) == Approx(4.0));
}

TEST_CASE("a break is told, and cut if wanted", "[importing]") {
    const auto text = table("time_s,displacement_mm,force_N", [](int i, double t, double, double) {
        return cell(t) + "," + cell(0.5 * t) + "," + cell(i < 300 ? 2.0 * t : 0.01);
    });
    const auto all = imported(text);
    CHECK(all.runs[0].signals.rows() == static_cast<std::size_t>(rows));
    CHECK_THAT(importing::account(all), Contains("line 302: the force falls to nothing within three rows"));
    importing::Hints hints;
    hints.cut = {"break"};
    CHECK(imported(text, hints).runs[0].signals.rows() == 300);
}

TEST_CASE("lines and tables beyond all bounds are refused", "[importing]") {
    CHECK_THAT(errorOf("time_s,force_N\n" + std::string(2 << 20, '1') + "\n2,3\n"),
               Contains("x.csv:2:1: a line of 2 MiB"));
    std::string wide;
    for (int row = 0; row < 3; ++row) {
        for (int i = 0; i < 5000; ++i)
            wide += std::to_string(row) + ",";
        wide += "1\n";
    }
    CHECK_THAT(errorOf(wide), Contains("a table of 5001 columns; expected at most 4096"));
}

TEST_CASE("a table of results above the readings is none of them", "[importing]") {
    Style s;
    s.head = "Results Table 1\n,Maximum Load,Extension at "
             "Max\n,(N),(mm)\n1,123.4,5.6\n2,120,5.5\n3,121,5.4\n\nTime,Extension,Load\n"
             "(s),(mm),(N)";
    const auto all = imported(exported(s));
    REQUIRE(all.runs.size() == 1);
    checkValues(all.runs[0]);
    CHECK(all.sources[0].lost == 0);
}

TEST_CASE("a table of readings above another one is not lost in silence", "[importing]") {
    const auto text = table("time_s,displacement_mm,force_N,stress_MPa", [](int i, double t, double way, double force) {
        const std::string row = cell(t) + "," + cell(way) + "," + cell(force);
        if (i == 60)
            return "time_s,displacement_mm,force_N\n" + row;
        return i < 60 ? row + ",1" : row;
    });
    CHECK_THAT(errorOf(text), Contains("of 361 rows could not be used"));
}

TEST_CASE("a second table with other units is refused", "[importing]") {
    Style newtons, kilonewtons;
    newtons.head = "Time (s),Extension (mm),Load (N)";
    kilonewtons.head = "Time (s),Extension (mm),Load (kN)";
    kilonewtons.perNewton = 1e-3;
    CHECK_THAT(errorOf(exported(newtons) + "\n" + exported(kilonewtons)),
               Contains("x.csv:364:1: another table begins here, with other columns or units"));
}

TEST_CASE("a fault in the first row hides no heading", "[importing]") {
    const auto text = table("Time (s),Extension (mm),Load (N),Ratio", [](int i, double t, double way, double force) {
        return cell(t) + "," + cell(way) + "," + (i % 100 == 0 ? "#DIV/0!" : cell(force)) + ",1";
    });
    const auto all = imported(text);
    CHECK(all.runs[0].signals.rows() == static_cast<std::size_t>(rows - 4));
    CHECK_THAT(importing::account(all), Contains("\"Load (N)\" holds no number"));
    CHECK(importing::worst(all) == "4 lines without the numbers of a row were left out; nothing is doubtful");
}

TEST_CASE("a time of day with a date is a clock, a step round in minutes is asked for", "[importing]") {
    const auto dated = table("Date/Time,Load [N],Crosshead [mm]", [](int, double t, double way, double force) {
        return "2024-03-13 09:50:" + cell(t, 3) + "," + cell(force) + "," + cell(way);
    });
    checkValues(imported(dated).runs[0]);
    Style s;
    s.head = "Time,Extension (mm),Load (N)";
    s.perSecond = 1.0 / 60.0;
    CHECK_THAT(errorOf(exported(s)), Contains("no unit is stated for time"));
}
