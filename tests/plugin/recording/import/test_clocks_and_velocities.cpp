// Clocks as people write them, velocities, and what happens in a recording.

#include "tests/plugin/recording/import/support.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// Hours, minutes and seconds of the day; after midnight from 0 on.
struct Clock {
    int hours, minutes;
    double seconds;
};

Clock clockAt(double secondsOfDay) {
    const double s = std::fmod(secondsOfDay, 86400.0);
    const int whole = static_cast<int>(s + 1e-9) / 60;
    return {whole / 60, whole % 60, std::max(0.0, s - 60.0 * whole)};
}

/// The known run, started at this time of day.
template <class Write>
std::string withClock(const std::string& head, double start, const Write& write) {
    std::string text = head + "\n";
    for (int i = 0; i < rows; ++i) {
        const double way = wayOf(timeOf(i));
        text += write(clockAt(start + timeOf(i))) + "," + printed(way, 6) + "," + printed(forceOf(way), 6) + "\n";
    }
    return text;
}

std::string twelveHours(const Clock& c, const char* am, const char* pm) {
    char text[40];
    std::snprintf(text, sizeof text, "%d:%02d:%05.2f %s", (c.hours + 11) % 12 + 1, c.minutes, c.seconds,
                  c.hours < 12 ? am : pm);
    return text;
}

std::string iso(const Clock& c, const char* date, const char* zone) {
    char text[60];
    std::snprintf(text, sizeof text, "%sT%02d:%02d:%05.2f%s", date, c.hours, c.minutes, c.seconds, zone);
    return text;
}

void checkRun(const std::string& text) {
    const auto all = read(text);
    INFO(text.substr(0, 200) << all.error());
    REQUIRE(all);
    REQUIRE(all->runs.size() == 1);
    checkValues(all->runs[0]);
}

/// A push at 0.5 mm/s, 20 rows a second; the force is `force(row, way in mm)`.
template <class Force>
std::string pushed(int count, const Force& force) {
    std::string text = "time_s,displacement_mm,force_N\n";
    for (int i = 0; i < count; ++i) {
        const double way = i < 20 ? 0.0 : 0.025 * (i - 20);
        text += printed(0.05 * i, 4) + "," + printed(way, 6) + "," + printed(force(i, way), 6) + "\n";
    }
    return text;
}

} // namespace

TEST_CASE("halves of a day over noon and over midnight are a clock", "[importing]") {
    const std::string head = "Clock,Crosshead (mm),Load cell (N)";
    for (const double start : {43195.0, 3.0 * 3600.0, 46790.0}) { // noon, the night, one o'clock
        checkRun(withClock(head, start, [](const Clock& c) { return twelveHours(c, "AM", "PM"); }));
        checkRun(withClock(head, start, [](const Clock& c) { return twelveHours(c, "a.m.", "p.m."); }));
    }
}

TEST_CASE("dates with times of day are a clock, over midnight too", "[importing]") {
    for (const char* zone : {"", "Z", "+02:00", "-05:30"})
        checkRun(withClock("timestamp,position_mm,force_N", 86392.0,
                           [&](const Clock& c) { return iso(c, c.hours > 0 ? "2024-05-11" : "2024-05-12", zone); }));
    checkRun(withClock("Time,position_mm,force_N", 50000.0,
                       [](const Clock& c) { return "5/11/2024 " + twelveHours(c, "AM", "PM"); }));
}

TEST_CASE("hours, minutes and seconds are seconds whatever the heading says", "[importing]") {
    for (const char* head : {"Time of Day,position_mm,force_N", "Time (h),position_mm,force_N"})
        checkRun(withClock(head, 50000.0, [](const Clock& c) {
            char text[40];
            std::snprintf(text, sizeof text, "%d:%02d:%05.2f", c.hours, c.minutes, c.seconds);
            return std::string(text);
        }));
}

TEST_CASE("a clock that cannot be read is asked for, not made up from the way", "[importing]") {
    const std::string text =
        withClock("time,position_mm,force_N", 0.0, [](const Clock&) { return std::string("noon"); });
    CHECK_THAT(errorOf(text), Contains("column 1 \"time\" is a time that cannot be read") && Contains("--rate HZ"));
    importing::Hints hints;
    hints.rate = 20.0;
    const auto all = read(text, hints);
    REQUIRE(all);
    checkValues(all->runs[0]);
}

TEST_CASE("a velocity stands for a displacement that is not there", "[importing]") {
    // the velocity at a row is the mean of those beside it: the trapezoidal rule gives the way but for the corners, at
    // the turning point by half of a row's way of 25 um
    std::string text = "time (s),velocity (mm/min),force (N)\n";
    for (int i = 0; i < rows; ++i) {
        const double t = timeOf(i), v = (wayOf(t + 0.025) - wayOf(t - 0.025)) / 0.05;
        text += printed(t, 4) + "," + printed(60.0 * v, 6) + "," + printed(forceOf(wayOf(t)), 6) + "\n";
    }
    const auto all = read(text);
    INFO(all.error());
    REQUIRE(all);
    const auto& d = *all->runs[0].signals.find(Quantity::Displacement);
    for (int i = 0; i < rows; ++i)
        REQUIRE(std::abs(1e3 * d[static_cast<std::size_t>(i)] - wayOf(timeOf(i))) <= 0.0125 + 1e-6);
    CHECK_THAT(importing::account(*all), Contains("the velocities are integrated"));
    CHECK(all->runs[0].signals.find(Quantity::Velocity) == nullptr);
}

TEST_CASE("a velocity checks a displacement", "[importing]") {
    const auto with = [](const char* unit, double factor) {
        std::string text = std::string("time_s,position_mm,velocity_") + unit + ",force_N\n";
        for (int i = 0; i < rows; ++i) {
            const double t = timeOf(i), v = (wayOf(t + 0.025) - wayOf(t - 0.025)) / 0.05;
            text += printed(t, 4) + "," + printed(20.0 + wayOf(t), 6) + "," + printed(factor * v, 6) + "," +
                    printed(forceOf(wayOf(t)), 6) + "\n";
        }
        return text;
    };
    const auto good = read(with("mm_s", 1.0));
    REQUIRE(good);
    // the turning point takes a row's way of 25 um, as the velocity vanishes there
    checkValues(good->runs[0]); // the position counts from its start
    CHECK_THAT(importing::account(*good), Contains("understood the velocities add up to a way of 7.975 mm"));
    CHECK_THAT(accountOf(with("mm_min", 1.0)), Contains("doubtful   the velocities add up to a way of 0.1329 mm"));
    // two velocities are no question
    std::string two = with("mm_s", 1.0);
    two.replace(two.find("force_N"), 7, "v2 (mm/s),force_N");
    for (std::size_t at = two.find('\n'); (at = two.find(',', at)) != std::string::npos;) {
        at = two.find(',', at + 1); // behind the position
        at = two.find(',', at + 1);
        two.insert(at, ",1");
        at = two.find('\n', at);
    }
    const auto both = read(two);
    INFO(both.error());
    REQUIRE(both);
    checkValues(both->runs[0]);
    CHECK_THAT(importing::account(*both), Contains("one of several velocities"));
}

TEST_CASE("a slip is told, kept, and cut where wanted", "[importing]") {
    // at row 200 the grip slips by 2 mm: the force falls by 4 N and rises on at the same slope
    const std::string text =
        pushed(300, [](int i, double way) { return std::max(0.0, 2.0 * (way - 1.0) - (i < 200 ? 0.0 : 4.0)); });
    const auto kept = read(text);
    REQUIRE(kept);
    CHECK(kept->runs[0].signals.rows() == 300);
    CHECK_THAT(importing::account(*kept), Contains("line 202: 1 sudden fall of the force, here first"));
    importing::Hints hints;
    hints.cut = {"falls"};
    const auto cut = read(text, hints);
    REQUIRE(cut);
    CHECK(cut->runs[0].signals.rows() == 200);
    CHECK(cut->runs[0].drive.time.back() == Approx(0.05 * 199)); // no motion without rows
    CHECK_THAT(importing::account(*cut), Contains("100 rows from here on are left out"));
}

TEST_CASE("a gap in the samples is told, and cut where wanted", "[importing]") {
    const std::string text = exported(Style{}, 0, 100) + exported(Style{}, 130).substr(Style{}.head.size() + 1);
    CHECK_THAT(accountOf(text), Contains("understood line 102: 1 gap in the samples, the first after 4.95 s"));
    importing::Hints hints;
    hints.cut = {"gaps"};
    const auto cut = read(text, hints);
    REQUIRE(cut);
    checkValues(cut->runs[0], 1e-6, 0, 100);
    CHECK(cut->runs[0].drive.time.back() == Approx(4.95));
}

TEST_CASE("a break is found above an offset of the sensor", "[importing]") {
    const std::string text =
        pushed(300, [](int i, double way) { return 0.8 + (i < 200 ? std::max(0.0, 2.0 * (way - 1.0)) : 0.0); });
    CHECK_THAT(accountOf(text), Contains("line 202: the force falls to nothing"));
}

TEST_CASE("what a sensor beyond its range gives is a missing value", "[importing]") {
    for (const char* mark : {"***", "####", "OVER", "OL", "-----", "Overload"}) {
        std::string text = "time_s,displacement_mm,force_N\n";
        for (int i = 0; i < rows; ++i) {
            const double way = wayOf(timeOf(i)), force = forceOf(way);
            text +=
                printed(timeOf(i), 4) + "," + printed(way, 6) + "," + (force > 5.0 ? mark : printed(force, 6)) + "\n";
        }
        const auto all = read(text);
        INFO(mark << ": " << all.error());
        REQUIRE(all);
        const auto& f = *all->runs[0].signals.find(Quantity::Force);
        REQUIRE(f.size() == static_cast<std::size_t>(rows)); // the way goes on
        for (int i = 0; i < rows; ++i)
            CHECK(std::isnan(f[static_cast<std::size_t>(i)]) == (forceOf(wayOf(timeOf(i))) > 5.0));
    }
}

TEST_CASE("words in the place of many numbers are doubtful", "[importing]") {
    const auto text = [](int every) {
        std::string lines = "time_s,displacement_mm,force_N\n";
        for (int i = 0; i < rows; ++i)
            lines += printed(timeOf(i), 4) + "," + printed(wayOf(timeOf(i)), 6) + "," +
                     (i % every == every - 1 ? "bananas" : printed(forceOf(wayOf(timeOf(i))), 6)) + "\n";
        return lines;
    };
    CHECK_THAT(importing::worst(*read(text(10))),
               Contains("36 lines, here first, hold a part of the numbers of a row"));
    CHECK_THAT(importing::worst(*read(text(200))), Contains("nothing is doubtful"));
}

TEST_CASE("minutes and seconds are a unit, a mass is named a weight", "[importing]") {
    CHECK(importing::unitOf("min:sec").measures == Quantity::Time);
    CHECK(importing::unitOf("(hours:minutes:seconds)").factor == 1.0);
    CHECK(importing::unitOf("force:n").measures == Quantity::None);
    Style s;
    s.head = "Time(s),Stroke(mm),Load(kg)";
    CHECK_THAT(errorOf(exported(s)), Contains("a weight is stated with --columns as force[kgf]"));
}
