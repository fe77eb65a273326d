#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/decimate.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/pages/run/geometry.h"
#include "plugin/pages/run/key_labels.h"
#include "plugin/pages/run/motion_data.h"

using namespace supercircle;
using namespace supercircle::graphics;
using namespace supercircle::pages;

TEST_CASE("ticks are round numbers inside the range, enough and not too many") {
    for (int e = -12; e <= 12; e += 3)
        for (const double lo : {-1.0, 0.0, 0.37, 123.4})
            for (const double span : {0.11, 1.0, 3.3, 97.0}) {
                const double s = std::pow(10.0, e);
                const AxisRange range{lo * s, (lo + span) * s};
                const Ticks ticks = niceTicks(range, 8);
                INFO(range.lo << " .. " << range.hi);
                REQUIRE(ticks.values.size() >= 3); // steps grow by at most 2.5: never fewer than 8 / 2.5, rounded down
                REQUIRE(ticks.values.size() <= 8);
                const double mantissa = ticks.step / std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
                CHECK(
                    (std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 || std::abs(mantissa - 5) < 1e-9));
                for (const double value : ticks.values) {
                    CHECK(value >= range.lo - 1e-9 * ticks.step);
                    CHECK(value <= range.hi + 1e-9 * ticks.step);
                    CHECK(std::abs(value / ticks.step - std::round(value / ticks.step)) < 1e-6);
                }
            }
}

TEST_CASE("a low diagram has two numbers on its scale at least") {
    // Between steps of 2 and 5 a range of 6 to 10 about zero has four numbers or one.
    for (const double lo : {-4.9, -4.4, -4.1, -2.3, -45.0})
        for (const double hi : {4.9, 3.3, 2.6, 21.0}) {
            const Ticks ticks = niceTicks({lo, hi}, 3);
            INFO(lo << " .. " << hi);
            CHECK(ticks.values.size() >= 2);
            CHECK(ticks.values.size() <= 5);
        }
    CHECK(niceTicks({-4.6, 3.3}, 3).values == std::vector<double>{-4.0, -2.0, 0.0, 2.0});
    CHECK(niceTicks({-1.2, 1.1}, 3).values == std::vector<double>{-1.0, 0.0, 1.0});
}

TEST_CASE("ranges without extent have no ticks and can be padded") {
    CHECK(niceTicks({1.0, 1.0}, 8).values.empty());
    CHECK(niceTicks({0.0, std::nan("")}, 8).values.empty());
    CHECK(niceTicks({1e15, 1e15 + 0.125}, 8).values.empty()); // steps below round-off
    CHECK(padded({2.0, 2.0}, 0.1).span() > 0.0);
    CHECK(padded({0.0, 0.0}, 0.1).span() > 0.0);
    CHECK(padded({HUGE_VAL, -HUGE_VAL}, 0.1).span() == 1.0);
}

TEST_CASE("tick labels have equal decimals and a true minus sign") {
    const Ticks ticks = niceTicks({-0.3, 0.31}, 7);
    std::vector<std::string> labels;
    for (const double value : ticks.values)
        labels.push_back(ticks.label(value));
    CHECK(labels == std::vector<std::string>{"\u22120.3", "\u22120.2", "\u22120.1", "0.0", "0.1", "0.2", "0.3"});
}

TEST_CASE("numbers and labels as text") {
    CHECK(significant(0.13421) == "0.1342");
    CHECK(significant(9.9996) == "10.00");
    CHECK(significant(-5.0, 3) == "\u22125.00");
    CHECK(significant(3.2e-9, 2) == "3.2 × 10⁻⁹");
    CHECK(significant(123456.0, 3) == "123456");
    CHECK(significant(std::nan("")) == "–");
    CHECK(trimmed(0.35) == "0.35");
    CHECK(trimmed(30.0) == "30");
    CHECK(trimmed(300.0) == "300");
    CHECK(trimmed(2e9) == "2 × 10⁹");
    CHECK(readableUnit(0.05, "J").text == "mJ");
    CHECK(readableUnit(5.0, "N").text == "N");
    CHECK(keyUnit("creep_speed_m_s") == "m/s");
    CHECK(keyUnit("peak_force_R2_over_B") == "B/R²");
    CHECK(keyLabel("work_in_J") == "work in");
    CHECK(keyUnit("dissipation_ratio").empty());
}

TEST_CASE("the energy map's lightness falls strictly and its steps are equal") {
    constexpr int n = 64;
    double least = 1.0, most = 0.0;
    for (int i = 0; i < n; ++i) {
        const Colour a = energyColour(double(i) / n), b = energyColour((i + 1.0) / n);
        CHECK(lightness(b) < lightness(a));
        least = std::min(least, colourDistance(a, b));
        most = std::max(most, colourDistance(a, b));
    }
    // Chords of a path walked at constant speed; clipping to sRGB is the only thing that could spoil it. 5 % cannot be
    // seen.
    CHECK(most < 1.05 * least);
    CHECK(lightness(energyColour(0.0)) < 0.85); // visible on white (1.0)
    CHECK(hexText(energyColour(-1.0)) == hexText(energyColour(0.0)));
    CHECK(hexText(energyColour(std::nan(""))) == "#9aa0a6");
}

TEST_CASE("the signed map is symmetric in lightness and grey in the middle") {
    for (const double t : {0.25, 0.5, 1.0}) // 0.01: below what is seen, sRGB rounds chroma
        CHECK(lightness(signedColour(t)) == Approx(lightness(signedColour(-t))).margin(0.01));
    const Colour grey = signedColour(0.0);
    CHECK(grey.r == Approx(grey.b).margin(1e-3));
}

TEST_CASE("decimation keeps every extreme") {
    std::vector<double> y(1'000'000);
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = std::sin(1e-5 * static_cast<double>(i));
    y[123'457] = 50.0;
    y[765'433] = -50.0;
    const auto rows = decimate(y, {0, y.size() - 1}, 500);
    CHECK(rows.size() <= 2000);
    CHECK(rows.front() == 0);
    CHECK(rows.back() == y.size() - 1);
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    CHECK(std::adjacent_find(rows.begin(), rows.end()) == rows.end());
    CHECK(std::count(rows.begin(), rows.end(), 123'457) == 1);
    CHECK(std::count(rows.begin(), rows.end(), 765'433) == 1);
    CHECK(decimate(y, {5, 9}, 500) == std::vector<std::size_t>{5, 6, 7, 8, 9});
}

TEST_CASE("gaps in a series are gaps") {
    const double nan = std::nan("");
    const auto s = finiteRanges({0, 1, nan, 3, 4, 5}, {0, 1, 2, nan, 4, 5});
    REQUIRE(s.size() == 2);
    CHECK(s[0].last == 1);
    CHECK(s[1].first == 4);
    CHECK(finiteRanges({nan}, {1.0}).empty());
    CHECK(finiteRanges({}, {}).empty());
}

TEST_CASE("branches end at reversals, not at jitter") {
    std::vector<double> d{0.0, 0.0};
    for (int i = 0; i <= 300; ++i) // up, down, up; jitter of 1 % of the travel
        d.push_back((i <= 100 ? i : i <= 200 ? 200 - i : i - 200) / 100.0 + (i % 2 == 0 ? 0.005 : -0.005));
    const auto found = curveBranches(d);
    REQUIRE(found.size() == 3);
    CHECK(found[0].loading);
    CHECK_FALSE(found[1].loading);
    CHECK(found[2].loading);
    CHECK(found[0].cycle == 1);
    CHECK(found[1].cycle == 1);
    CHECK(found[2].cycle == 2);
    CHECK(found[0].rows.last == found[1].rows.first);
    CHECK(found[0].rows.last == 2 + 100);
    CHECK(found.back().rows.last == d.size() - 1);
    CHECK(curveBranches({}).empty());
    CHECK(curveBranches({std::nan("")}).empty());
    CHECK(curveBranches({1.0}).size() == 1);
    CHECK(curveBranches({1.0, 1.0, 1.0}).size() == 1);
}

TEST_CASE("the centre line of a uniform arc lies on its circle and ends where it must") {
    const record::ShellInfo shell{"", 0.09, 5e-4, 0.0, false, {0.03, 0.03, 0.03}, {}};
    const record::ShellPose pose{{0.0, 0.0}, 0.0, {50.0F, 50.0F, 50.0F}, 0.0};
    const auto line = centreLine(shell, pose, 1e-6);
    for (const Point& p : line) // tangent to x at the origin: centre (0, 1/50); 1e-12: round-off
        CHECK(std::hypot(p.x, p.y - 0.02) == Approx(0.02).margin(1e-12));
    CHECK(line.back().x == Approx(0.02 * std::sin(4.5)).margin(1e-12));
    for (std::size_t i = 1; i < line.size(); ++i) { // chords leave the arc by their sagitta, at most the tolerance
        const double x = 0.5 * (line[i].x + line[i - 1].x), y = 0.5 * (line[i].y + line[i - 1].y);
        CHECK(0.02 - std::hypot(x, y - 0.02) < 1.001e-6);
    }
    CHECK(line.size() < 232); // 4.5 rad / sqrt(8 * 1e-6 * 50) = 225 chords, each of three elements rounded up
    const record::ShellPose broken{{0.0, std::nan("")}, 0.0, {50.0F}, 0.0};
    CHECK(centreLine(shell, broken, 1e-6).empty());
    const record::ShellPose straight{{0.0, 0.0}, 0.5, {0.0F}, 0.0}; // one element: the shell names three
    CHECK(centreLine(shell, straight, 1e-6).back().x == Approx(0.09 * std::cos(0.5)));
}

TEST_CASE("base64 is that of RFC 4648") {
    const auto encode = [](std::string_view text) {
        return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    };
    CHECK(encode("").empty());
    CHECK(encode("f") == "Zg==");
    CHECK(encode("fo") == "Zm8=");
    CHECK(encode("foo") == "Zm9v");
    CHECK(encode("foobar") == "Zm9vYmFy");
}

TEST_CASE("quantised turns never drift") {
    const double unit = 2.0 * std::numbers::pi / 32768.0;
    std::vector<double> turns(200, 0.4999 * unit); // each alone would round to nothing
    double angle = 0.0;
    long long sum = 0;
    const auto quantised = quantisedTurns(turns, unit);
    for (std::size_t i = 0; i < turns.size(); ++i) {
        angle += turns[i];
        sum += quantised[i];
        REQUIRE(std::abs(static_cast<double>(sum) * unit - angle) <= 0.5000001 * unit);
    }
    CHECK(quantisedTurns({std::nan(""), 1.0}, 1.0) == std::vector<int>{0, 1});
}

TEST_CASE("text is escaped and coordinates are short") {
    CHECK(escaped("<a & \"b\">") == "&lt;a &amp; &quot;b&quot;&gt;");
    std::string out;
    for (const double value : {1.0, 1.5, -0.001, 100.0, std::nan(""), 0.126}) {
        appendFixed(out, value);
        out += ' ';
    }
    CHECK(out == "1 1.5 0 100 0 0.13 ");
}
