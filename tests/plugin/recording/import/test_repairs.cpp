// Recordings with correctable faults: result and remark.

#include "tests/plugin/recording/import/support.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// Rows of the known run with changed time, displacement and force.
template <class Change>
std::string changed(const Change& change) {
    std::string text = "time_s,displacement_mm,force_N\n";
    for (int i = 0; i < rows; ++i) {
        double t = timeOf(i), way = wayOf(t), force = forceOf(way);
        change(i, t, way, force);
        const auto cell = [](double v) { return std::isfinite(v) ? printed(v, 6) : std::string(); };
        text += cell(t) + "," + cell(way) + "," + cell(force) + "\n";
    }
    return text;
}

const double none = std::nan("");

} // namespace

TEST_CASE("a clock that was set back continues", "[importing]") {
    const auto all = imported(changed([](int i, double& t, double&, double&) { t -= i >= 200 ? 9.95 : 0.0; }));
    REQUIRE(all.runs.size() == 1); // the crosshead is not at its start: no new run
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all), Contains("corrected  line 202: the clock jumps back from 9.95 s to 0.05 s"));
}

TEST_CASE("single rows out of order are left out", "[importing]") {
    const auto all =
        imported(changed([](int i, double& t, double&, double&) { t -= i == 50 || i == 90 ? 0.12 : 0.0; }));
    CHECK(all.runs[0].signals.rows() == rows - 2);
    CHECK_THAT(importing::account(all), Contains("left out   line 52: a row whose time, 2.38 s, is before"));
}

TEST_CASE("a coarse clock is spread", "[importing]") {
    // ticks of 0.2 s for rows at 20 Hz
    const auto all = imported(changed([](int, double& t, double&, double&) { t = 0.2 * std::floor(t / 0.2 + 1e-9); }));
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all), Contains("270 rows have the time of the row before them: they are spread"));
}

TEST_CASE("missing times are interpolated", "[importing]") {
    const auto all = imported(changed([](int i, double& t, double&, double&) {
        if (i == 20 || (i > 100 && i < 110))
            t = none;
    }));
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all), Contains("10 rows have no time: 10 are interpolated, 0 left out"));
}

TEST_CASE("a clock that does not start at zero", "[importing]") {
    const auto all = imported(changed([](int, double& t, double&, double&) { t += 1234.5; }));
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all),
               Contains("line 2: the clock starts at 1234 s, which becomes 0") || Contains("starts at 1235 s"));
}

TEST_CASE("missing samples stay missing and are counted", "[importing]") {
    const auto all = imported(changed([](int i, double&, double& way, double& force) {
        if (i >= 40 && i < 43)
            force = none;
        if (i == 77)
            way = none;
    }));
    const auto& run = all.runs[0];
    CHECK(std::isnan(run.signals.find(Quantity::Force)->at(41)));
    CHECK(run.signals.find(Quantity::Force)->at(43) == Approx(forceOf(wayOf(timeOf(43)))).margin(1e-6));
    CHECK(std::isnan(run.signals.find(Quantity::Displacement)->at(77)));
    CHECK(run.drive.time.size() == 5);
    CHECK_THAT(importing::account(all), Contains("line 42: 3 of 361 values of the force are missing") &&
                                            Contains("line 79: 1 of 361 values of the displacement are missing"));
}

TEST_CASE("a reset counter continues", "[importing]") {
    // reset at 1.5 mm of loading
    const auto all = imported(changed([](int i, double&, double& way, double&) { way -= i >= 81 ? 1.5 : 0.0; }));
    const auto& d = *all.runs[0].signals.find(Quantity::Displacement);
    for (int i = 0; i < rows; ++i) // the travel of one row is unknown: 25 um
        REQUIRE(1e3 * d[static_cast<std::size_t>(i)] == Approx(wayOf(timeOf(i))).margin(0.03));
    CHECK_THAT(importing::account(all), Contains("line 83: the displacement falls from 1.5 mm to 0.025 mm") &&
                                            Contains("the counter was reset"));
}

TEST_CASE("a reset counter without a clock continues", "[importing]") {
    std::string text = "Speed: 30 mm/min\ndisplacement_mm,force_N\n";
    for (int i = 0; i < 200; ++i)
        text += printed(0.025 * (i < 120 ? i : i - 120), 6) + "," + printed(forceOf(0.025 * i), 6) + "\n";
    const auto all = imported(text);
    CHECK(all.runs[0].signals.find(Quantity::Displacement)->back() == Approx(0.025e-3 * 199));
    CHECK(all.runs[0].drive.time.size() == 2);
}

TEST_CASE("another jump is reported and kept", "[importing]") {
    const auto all = imported(changed([](int i, double&, double& way, double&) { way += i >= 100 ? 1.0 : 0.0; }));
    CHECK_THAT(importing::account(all), Contains("doubtful   line 102: the displacement jumps from"));
    CHECK(all.runs[0].drive.largestDistance < all.runs[0].drive.tolerance * 1.01);
}

TEST_CASE("signs are reversed towards the specimen", "[importing]") {
    const auto all = imported(changed([](int, double&, double& way, double& force) {
        way = 5.0 - way;
        force = -force;
    }));
    checkValues(all.runs[0]);
    CHECK_THAT(importing::account(all), Contains("the displacement starts at 5 mm, which becomes 0") &&
                                            Contains("falls from its start") && Contains("the force falls at first") &&
                                            Contains("signs are reversed"));
    importing::Hints hints; // given by the user: a specimen that attracts
    hints.forceSign = 1;
    hints.displacementSign = -1;
    const auto kept = imported(changed([](int, double&, double& way, double& force) {
                                   way = -way;
                                   force = -force;
                               }),
                               hints);
    CHECK(kept.runs[0].signals.find(Quantity::Displacement)->at(180) == Approx(4e-3));
    CHECK(kept.runs[0].signals.find(Quantity::Force)->at(180) == Approx(-6.0));
}

TEST_CASE("the zero of the force is the mean before first contact", "[importing]") {
    const auto all = imported(changed([](int i, double&, double&, double& force) {
        force += 0.25 + 0.01 * ((i * 7) % 5 - 2); // an offset and a noise of mean 0 over five rows
    }));
    CHECK(all.runs[0].forceZero == Approx(0.25).margin(1e-9));
    CHECK_THAT(importing::account(all), Contains("the mean force of the first 0.5 s, 0.25 N, is taken as zero"));
    CHECK(all.runs[0].firstContact ==
          Approx(1.0e-3).margin(0.12e-3)); // seen above 5 x 0.04 N at 2 N/mm, in the next row
}

TEST_CASE("consecutive tests in a file are runs", "[importing]") {
    const Style s;
    const std::string body = exported(s).substr(s.head.size() + 1);
    for (const std::string& text : {exported(s) + body, exported(s) + exported(s)}) {
        const auto all = imported(text);
        REQUIRE(all.runs.size() == 2);
        checkValues(all.runs[0]);
        checkValues(all.runs[1]);
        CHECK(all.runs[1].file == "run_2.csv");
        CHECK_THAT(importing::account(all), Contains("another run begins: the clock starts again"));
    }
}

TEST_CASE("a gap in the samples is named", "[importing]") {
    std::string text = exported(Style{}, 0, 100);
    const std::string rest = exported(Style{}, 160, rows);
    text += rest.substr(rest.find('\n') + 1);
    CHECK_THAT(accountOf(text), Contains("line 102: 1 gap in the samples, the first after 4.95 s"));
}

TEST_CASE("an implausible unit is reported", "[importing]") {
    const auto withHead = [](const char* head, double way, double force, double time) {
        Style s;
        s.head = head;
        s.perMillimetre = way;
        s.perNewton = force;
        s.perSecond = time;
        return exported(s);
    };
    CHECK_THAT(accountOf(withHead("t (s),d (m),F (N)", 1.0, 1.0, 1.0)),
               Contains("doubtful   the crosshead travels 4000 mm; the unit of the displacement is stated as m"));
    importing::Hints units;
    units.units = {importing::unitOf("mm"), importing::unitOf("N")};
    CHECK_THAT(accountOf(withHead("time,displacement,force", 1e-3, 1e-6, 1.0), units),
               Contains("the crosshead travels 0.004 mm; the unit of the displacement is stated as mm") &&
                   Contains("the largest force is 6e-06 N; the unit of the force is stated as N"));
    CHECK_THAT(accountOf(withHead("t (h),d (mm),F (N)", 1.0, 1.0, 1.0)),
               Contains("the unit of the time is stated as h"));
    CHECK_THAT(accountOf(withHead("t (us),d (mm),F (MN)", 1.0, 1.0, 1.0)),
               Contains("the crosshead moves at 500 m/s") && Contains("the largest force is 6e+06 N"));
}

TEST_CASE("header entries that contradict the rows are reported", "[importing]") {
    const std::string head = "Test speed;30;mm/s\nSampling rate;100 Hz\nFmax;6;kN\nNumber of points;500\n";
    const std::string account = accountOf(head + exported());
    CHECK_THAT(
        account,
        Contains("doubtful   line 1: the header states 30 mm/s, but no segment of the motion has it (nearest: 0.5"));
    CHECK_THAT(account, Contains("doubtful   line 2: the header states 100 Hz, the times of the rows 20 Hz"));
    CHECK_THAT(account, Contains("doubtful   line 3: the header states 6000 N at most, the rows 6 N"));
    CHECK_THAT(account, Contains("doubtful   line 4: the header states 500 rows, 361 were read"));
    CHECK_THAT(accountOf("Test speed;30;mm/min\nSampling rate;20 Hz\nFmax;6;N\nNumber of points;361\n" + exported()),
               !Contains("doubtful"));
}

TEST_CASE("a glitch of the force is reported", "[importing]") {
    const std::string account =
        accountOf(changed([](int i, double&, double&, double& force) { force = i == 150 ? 5e3 : force; }));
    CHECK_THAT(account, Contains("doubtful   line 152: the force is 5000 N in this row, and below a hundredth of it"));
}

TEST_CASE("a noisy ramp gives few segments", "[importing]") {
    const auto all = imported(changed([](int i, double&, double& way, double&) {
        way += 0.002 * std::sin(12.9898 * i) * std::sin(78.233 * i * i); // 2 um, as a counter jitters
    }));
    REQUIRE(all.runs[0].drive.time.size() == 5);
    for (const auto& [i, t] : {std::pair{1, 1.0}, {2, 9.0}, {3, 17.0}}) // 5 um of tolerance at 0.5 mm/s
        CHECK(all.runs[0].drive.time[static_cast<std::size_t>(i)] == Approx(t).margin(0.02));
}
