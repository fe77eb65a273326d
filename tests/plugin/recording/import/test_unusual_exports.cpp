// Exports that look like others and are not: what they hold is read, or asked for, never guessed in silence.

#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/import/reading/metadata.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// Rows of the known run below a head, written by `row`.
template <class Row>
std::string rowsBelow(const std::string& head, const Row& row) {
    std::string text = head + "\n";
    for (int i = 0; i < rows; ++i)
        text += row(i, timeOf(i), wayOf(timeOf(i)), forceOf(wayOf(timeOf(i)))) + "\n";
    return text;
}

/// The known run below a head of three names.
std::string below(const std::string& head, char separator = ',', char decimal = '.') {
    Style s;
    s.head = head;
    s.separator = separator;
    s.decimal = decimal;
    return exported(s);
}

} // namespace

TEST_CASE("velocities beside an angle are averaged and cut with it", "[importing]") {
    std::string text = "time_s,angle_deg,position_mm,velocity_mm_s\n";
    for (int i = 0; i < 5000; ++i)
        text +=
            printed(1e-3 * i, 3) + "," + printed(30.0 * std::cos(0.01 * i), 6) + "," + printed(0.01 * i, 6) + ",10\n";
    importing::Hints hints;
    hints.average = 100;
    CHECK_THAT(accountOf(text, hints),
               Contains("understood the velocities add up to a way of 49 mm, the displacement to 49 mm"));
    hints.fromTurningPoint = 1;
    CHECK_THAT(accountOf(text, hints), Contains("understood the velocities add up to a way of 4"));
}

TEST_CASE("a torque is no displacement, whatever the letters of its unit", "[importing]") {
    for (const char* head : {"Time (s),Torque (Nm),Force (N)", "Time (s),M (Nm),Force (N)", "Time (s),M_Nm,Force (N)",
                             "Time (s),Biegemoment [NM],Force (N)", "Time (s),Moment (mm),Force (N)"}) {
        INFO(head);
        CHECK_THAT(errorOf(below(head)), Contains("there is a force but no displacement"));
    }
    Style s;
    s.head = "Time (s),Gap (nm),Force (mN)";
    s.perMillimetre = 1e6;
    s.perNewton = 1e3;
    checkValues(imported(exported(s)).runs[0]);
}

TEST_CASE("letters of a unit count where another unit has them", "[importing]") {
    using importing::unitOf;
    for (const char* none : {"Nm", "NM", "nM", "n", "M", "mn", "Mn", "mS", "µS", "µM"}) {
        INFO(none);
        CHECK(unitOf(none).measures == Quantity::None);
    }
    for (const char* any : {"MM", "KN", "kn", "S", "Sec", "IN", "LBF", "N", "mN", "MN", "nm", "m", "µm", "ms"}) {
        INFO(any);
        CHECK(unitOf(any).measures != Quantity::None);
    }
    // beside a word for the quantity there is no other unit
    for (const char* head : {"TIME (S),POSITION (MM),LOAD (N)", "time (s),position (mm),load (n)",
                             "t_s,position_mm,load_n", "Time,Position,Load\nS,MM,n"}) {
        INFO(head);
        checkValues(imported(below(head)).runs[0]);
    }
    CHECK(importing::headingOf("ZEIT [MS]", "").unit.factor == 1e-3);
    CHECK(importing::headingOf("Conductance [mS]", "").quantity == Quantity::None);
    CHECK(importing::headingOf("n", "").quantity == Quantity::None);
}

TEST_CASE("a remark in brackets is no unit", "[importing]") {
    for (const char* head :
         {"Time (s);Weg (Traverse) [mm];Kraft (Kanal 1) [N]", "Time (s);Weg [mm] (Traverse);Kraft [N] (Kanal 1)",
          "Time (s);Weg (oben) {mm};Kraft (Kanal 1) in N", "Zeit (ab Start);Weg (Traverse);Kraft (Kanal 1)\ns;mm;N"}) {
        INFO(head);
        checkValues(imported(below(head, ';', ',')).runs[0]);
    }
}

TEST_CASE("a column whose unit cannot be told is stated with --columns", "[importing]") {
    CHECK_THAT(errorOf(below("Time (s),Weg (Traverse),Kraft (N)")),
               Contains("\"Traverse\" is no unit of displacement") &&
                   Contains("--columns time[s],displacement[mm],force[N]"));
    CHECK_THAT(errorOf(below("Time (s),Weg (mm),Force (kN)\ns,mm,N")),
               Contains("\"Force (kN)\" has two units, kN and N") &&
                   Contains("--columns time[s],displacement[mm],force[N]"));
    CHECK_THAT(errorOf(below("Time (s),Weg (mm) (in),Force (N)")),
               Contains("\"mm and in\" is no unit of displacement") && Contains("--columns time[s]"));
}

TEST_CASE("pounds of force are written in several ways", "[importing]") {
    for (const char* head : {"Time (s),Extension (mm),Load (lb-f)", "Time (s),Extension (mm),Load (lb_f)",
                             "time_s,extension_mm,load_lb_f", "Time,Extension,Load\ns,mm,lb f"}) {
        Style s;
        s.head = head;
        s.perNewton = 1.0 / 4.4482216152605;
        s.digits = 9;
        INFO(head);
        checkValues(imported(exported(s)).runs[0]);
    }
}

TEST_CASE("clocks with other words in their names are clocks", "[importing]") {
    for (const char* name : {"Time Stamp (s)", "Cycle Time (s)", "Total Cycle Time [s]", "Elapsed Time", "X_Value",
                             "X_Value (s)", "Zyklus Zeit (s)", "Time Stamp"}) {
        INFO(name);
        const auto all = imported(below(std::string(name) + ",Extension (mm),Load (N)"));
        checkValues(all.runs[0]);
    }
    // a clock without such words goes first
    const auto both =
        rowsBelow("Cycle Time (s),Time (s),Extension (mm),Load (N)", [](int i, double t, double way, double force) {
            return printed(timeOf(i % 60), 6) + "," + printed(t, 6) + "," + printed(way, 6) + "," + printed(force, 6);
        });
    checkValues(imported(both).runs[0]);
    for (const char* other : {"Elapsed Cycles", "Cycle", "Cycle force [N]", "Time rate"})
        CHECK(importing::headingOf(other, "").quantity == Quantity::None);
}

TEST_CASE("times are not made up beside a column that may hold them", "[importing]") {
    CHECK_THAT(errorOf(below("Cycle duration (s),Extension (mm),Load (N)")),
               Contains("column 1 \"Cycle duration (s)\" has a unit of time, but no column is named a time") &&
                   Contains("--columns time[s],displacement[mm],force[N], else --rate HZ or --speed MM_PER_S"));
    const std::string even = below("Channel A,Extension (mm),Load (N)");
    CHECK_THAT(errorOf(even), Contains("column 1 \"Channel A\" runs on evenly, as a clock does"));
    importing::Hints hints;
    hints.columns = {"time[s]", "displacement[mm]", "force[N]"};
    checkValues(imported(even, hints).runs[0]);
    hints.columns = {"-", "displacement[mm]", "force[N]"};
    CHECK_THAT(accountOf(even, hints), Contains("the crosshead is assumed to move at 1 mm/s"));
    CHECK_THAT(accountOf("Sampling rate;20;Hz\n" + even),
               Contains("doubtful") && Contains("\"Channel A\" runs on evenly") && Contains("rows come at 20 Hz"));
    // numbers of rows, and what does not run on evenly or has another unit, are no clocks
    for (const char* name : {"Zyklen", "Dehnung", "A (%)", "B (bar)"}) {
        INFO(name);
        CHECK_THAT(accountOf(below(std::string(name) + ",Extension (mm),Load (N)")),
                   Contains("the crosshead is assumed to move at 1 mm/s"));
    }
}

TEST_CASE("without a clock the speed of the test counts, not the first one", "[importing]") {
    const std::string table = rowsBelow("Weg (mm);Kraft (N)", [](int, double, double way, double force) {
        return printed(way, 6, ',') + ";" + printed(force, 6, ',');
    });
    const auto speedsOf = [&](const std::string& header) { return accountOf(header + table); };
    CHECK_THAT(speedsOf("Geschwindigkeit Vorkraft;5;mm/min\nPrüfgeschwindigkeit;120;mm/min\n"),
               Contains("line 2: there is no time; the crosshead moves at 2 mm/s"));
    CHECK_THAT(speedsOf("Return speed;500;mm/min\nSpeed;30;mm/min\n"),
               Contains("line 2: there is no time; the crosshead moves at 0.5 mm/s"));
    CHECK_THAT(speedsOf("Pre-Test Speed;1;mm/s\nTest Speed;0,5;mm/s\nPost-Test Speed;10;mm/s\n"),
               Contains("line 2: there is no time; the crosshead moves at 0.5 mm/s"));
    CHECK_THAT(speedsOf("Speed;5;mm/min\nTest speed;30;mm/min\n"), Contains("moves at 0.5 mm/s"));
    CHECK_THAT(speedsOf("Speed;30;mm/min\nVelocity;0,5;mm/s\n"), Contains("moves at 0.5 mm/s")); // they agree
    CHECK_THAT(speedsOf("Druckgeschwindigkeit;30;mm/min\n"), Contains("moves at 0.5 mm/s"));
    const std::string two = "Speed 1;6;mm/min\nSpeed 2;30;mm/min\n";
    CHECK_THAT(errorOf(two + table), Contains("x.csv:1:1: there is no time, and the header states no speed that is "
                                              "clearly that of the test: \"Speed 1\" of 0.1 mm/s (line 1), \"Speed 2\" "
                                              "of 0.5 mm/s (line 2)") &&
                                         Contains("--speed MM_PER_S"));
    CHECK_THAT(errorOf("Return speed;500;mm/min\n" + table), Contains("no speed that is clearly that of the test"));
    importing::Hints hints;
    hints.speed = 1e-3;
    CHECK_THAT(accountOf(two + table, hints), Contains("moves at 1 mm/s as given"));
    CHECK_THAT(accountOf(two + exported()), !Contains("doubtful")); // beside a clock they are no question
}

TEST_CASE("the width of a grip is not that of the specimen", "[importing]") {
    using importing::MetadataKey;
    const auto width =
        importing::metadataValue({{1, "Grip width", "60 mm"}, {2, "Width", "12.5 mm"}}, MetadataKey::Width);
    REQUIRE(width);
    CHECK(width->value == Approx(12.5e-3));
    for (const char* machine : {"Grip width", "Breite der Spannbacken", "Clamp width (mm)", "Support width"})
        CHECK_FALSE(importing::metadataValue({{1, machine, "60 mm"}}, MetadataKey::Width));
    CHECK_FALSE(importing::metadataValue({{1, "Jaw thickness", "60 mm"}}, MetadataKey::Thickness));
    CHECK(importing::metadataValue({{1, "Probenbreite", "60 mm"}}, MetadataKey::Width));
}

TEST_CASE("decimal commas between commas without quotes are named, with the remedy", "[importing]") {
    const auto torn = [](const std::string& head, double start) {
        return rowsBelow(head, [&](int, double t, double way, double force) {
            return printed(t, 2, ',') + "," + printed(start + way, 3, ',') + "," + printed(-force, 4, ',');
        });
    };
    for (const char* head : {"Time (s),Weg (mm),Kraft (N)", "Bericht\nZeit,Weg,Kraft\ns,mm,N"}) {
        INFO(head);
        CHECK_THAT(
            errorOf(torn(head, 12.5)),
            Contains("has 3 cells, the rows have 6: decimal commas cannot be told from the commas between cells") &&
                Contains("export again with semicolons or tabs between the cells, with decimal points, or with "
                         "quotes"));
    }
    importing::Hints hints;
    hints.columns = {"time[s]", "displacement[mm]", "force[N]"};
    CHECK_THAT(errorOf(torn("Time (s),Weg (mm),Kraft (N)", 0.0), hints), Contains("export again with semicolons"));
}

TEST_CASE("without a clock an empty first displacement takes one row with it", "[importing]") {
    const auto text = [](bool counted, double noise) {
        return rowsBelow(counted ? "Index;Weg (mm);Kraft (N)" : "Weg (mm);Kraft (N)",
                         [&](int i, double, double, double force) {
                             const double way = 0.02 * i + noise * std::sin(12.9898 * i * i);
                             return (counted ? std::to_string(i + 1) + ";" : "") + (i < 2 ? "" : printed(way, 6, ',')) +
                                    ";" + printed(force, 6, ',');
                         });
    };
    // ticks of a counter, ticks of a noisy displacement, times from the steps of a clean one
    const auto counted = imported(text(true, 0.0)), noisy = imported(text(false, 0.05)),
               clean = imported(text(false, 0.0));
    CHECK(counted.runs[0].signals.find(Quantity::Time)->back() == Approx(7.2)); // 0.02 mm a row at 1 mm/s
    CHECK(noisy.runs[0].signals.find(Quantity::Time)->back() == Approx(7.2).epsilon(0.05));
    CHECK(clean.runs[0].signals.rows() == static_cast<std::size_t>(rows - 2));
    CHECK_THAT(importing::account(clean), Contains("2 rows in which the displacement does not change or is missing"));
}

TEST_CASE("the return of a head that moves in steps is no reset of its counter", "[importing]") {
    // 30 steps of 0.1 mm within a row each, rests of 30 rows, back to 0 within a row
    for (const bool loaded : {true, false}) { // the second returns before it touches the specimen again
        std::string text = "time_s,displacement_mm,force_N\n";
        for (int i = 0; i < 1200; ++i) {
            const double way = i < 930 ? 0.1 * (i / 30) : 0.0, force = loaded || i < 900 ? 2.0 * way : 0.0;
            text += printed(0.05 * i, 3) + "," + printed(way, 4) + "," + printed(force, 4) + "\n";
        }
        const auto all = imported(text);
        const auto& d = *all.runs[0].signals.find(Quantity::Displacement);
        CHECK(d[920] == Approx(3e-3));
        CHECK(d[1100] == Approx(0.0).margin(1e-12));
        CHECK_THAT(importing::account(all), !Contains("the counter was reset") &&
                                                Contains("line 932: the displacement jumps from 3 mm to 0 mm"));
    }
}

TEST_CASE("a counter of a ramp that is unloaded within a row was not reset", "[importing]") {
    const std::string text = rowsBelow("time_s,displacement_mm,force_N", [](int i, double t, double way, double force) {
        return printed(t, 6) + "," + printed(i < 150 ? way : 0.0, 6) + "," + printed(i < 150 ? force : 0.0, 6);
    });
    const auto all = imported(text);
    CHECK(all.runs[0].signals.find(Quantity::Displacement)->back() == Approx(0.0).margin(1e-12));
}

TEST_CASE("a column of specimens splits stacked tests wherever they start", "[importing]") {
    const auto stacked = [](const std::string& head, bool clock, double clockStart) {
        std::string text = head + "\n";
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < rows; ++i) {
                const double way = wayOf(timeOf(i));
                text += (head[0] == 'S' ? std::to_string(k + 1) : std::string(1, static_cast<char>('A' + k))) +
                        (clock ? "," + printed(timeOf(i) + (k > 0 ? clockStart : 0.0), 6) : "") + "," +
                        printed(way + 1.3 * k, 6) + "," + printed(forceOf(way), 6) + "\n";
            }
        return text;
    };
    for (const char* head : {"Specimen,Time (s),Disp (mm),Force (N)", "Sample No.,Time (s),Disp (mm),Force (N)",
                             "Probennummer,Time (s),Disp (mm),Force (N)", "Test,Time (s),Disp (mm),Force (N)"}) {
        INFO(head);
        const auto all = imported(stacked(head, true, 0.0));
        REQUIRE(all.runs.size() == 3);
        for (const auto& run : all.runs)
            checkValues(run);
        CHECK_THAT(importing::account(all),
                   Contains("line 363: another run begins: another specimen or test is named"));
        CHECK(importing::worst(all) == "every row is used, and nothing is doubtful");
    }
    CHECK(imported(stacked("Specimen,Disp (mm),Force (N)", false, 0.0)).runs.size() == 3);
    // a clock that runs on, and a column that counts something else, are one test
    const std::string on =
        rowsBelow("Test,Time (s),Disp (mm),Force (N)", [](int i, double t, double way, double force) {
            return std::to_string(i / 100) + "," + printed(t, 6) + "," + printed(way, 6) + "," + printed(force, 6);
        });
    CHECK(imported(on).runs.size() == 1);
    const std::string each = rowsBelow("Run,Disp (mm),Force (N)", [](int i, double, double way, double force) {
        return std::to_string(i / 2) + "," + printed(way, 6) + "," + printed(force, 6);
    });
    CHECK(imported(each).runs.size() == 1);
}

TEST_CASE("wrapped angles go on", "[importing]") {
    const auto swing = [](double amplitude, double wrapAt) {
        std::string text = "time_s,angle_deg\n";
        for (int i = 0; i < 1000; ++i) {
            const double a = 170.0 + amplitude * std::sin(0.03 * i);
            text += printed(0.01 * i, 3) + "," + printed(a > wrapAt ? a - 360.0 : a, 4) + "\n";
        }
        return text;
    };
    const auto all = imported(swing(30.0, 180.0));
    const auto& a = *all.runs[0].signals.find(Quantity::Angle);
    for (std::size_t i = 0; i < a.size(); ++i)
        REQUIRE(180.0 / M_PI * a[i] == Approx(170.0 + 30.0 * std::sin(0.03 * static_cast<double>(i))).margin(1e-3));
    CHECK_THAT(importing::account(all),
               Contains("corrected  line 14: the angle jumps by a turn 10 times, here first: it is taken as going on"));
    CHECK_THAT(accountOf(swing(30.0, 1e3)), !Contains("jumps by a turn")); // nothing is wrapped
    // half a turn a row could have gone either way
    std::string fast = "time_s,angle_deg\n";
    for (int i = 0; i < 100; ++i)
        fast += printed(0.01 * i, 3) + "," + std::to_string((i * 170) % 360) + "\n";
    CHECK(imported(fast).runs[0].signals.find(Quantity::Angle)->at(3) == Approx(150.0 * M_PI / 180.0));
}

TEST_CASE("units beside the numbers are those of the columns", "[importing]") {
    const auto cells = [](const std::string& head, const char* length, double perMillimetre, const char* unitOfForce) {
        return rowsBelow(head, [&](int, double t, double way, double force) {
            return printed(t, 2, ',') + " s;" + printed(perMillimetre * way, 6, ',') + length + ";" +
                   printed(force, 6, ',') + " " + unitOfForce + ";22,8 °C";
        });
    };
    for (const auto& [length, perMillimetre] : {std::pair{" mm", 1.0}, {"µm", 1e3}}) {
        const auto all =
            imported(cells("Prüfgeschwindigkeit;30 mm/min\nZeit;Weg;Kraft;Temperatur", length, perMillimetre, "N"));
        checkValues(all.runs[0]);
        CHECK_THAT(importing::account(all), Contains("line 3: units stand beside the numbers") &&
                                                Contains("column 3 \"Kraft\" is force [N]") &&
                                                Contains("line 1: Prüfgeschwindigkeit: 30 mm/min"));
    }
    // two that contradict each other, and one that changes on the way
    CHECK_THAT(errorOf(cells("Zeit;Weg;Kraft (kN);Temperatur", " mm", 1.0, "N")),
               Contains("\"Kraft (kN)\" has two units, kN and N") &&
                   Contains("--columns time[s],displacement[mm],force[N]"));
    CHECK_THAT(errorOf(cells("Zeit;Weg;Kraft;Temperatur\ns;mm;kN;°C", " mm", 1.0, "N")),
               Contains("has two units, kN on the line of units and N beside its numbers"));
    CHECK_THAT(errorOf(with(cells("Zeit;Weg;Kraft;Temperatur", " mm", 1.0, "N"), "0,500000 N", "0,000500 kN")),
               Contains("column 3 changes its unit from N to kN here; export again with one unit a column"));
}
