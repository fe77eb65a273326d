// Forces of steps that change their length give way to what is beside them.

#include "plugin/replay/trace.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::replay;

namespace {

/// Readings of a curve every 10 ms; those of [from, to) are doubtful and off by 1 %.
template <class Curve>
Trace read(const Curve& force, int from = 20, int to = 24) {
    Trace t;
    for (int k = 0; k < 40; ++k) {
        const double at = 0.01 * k;
        const bool doubtful = k >= from && k < to;
        t.addForce(at, force(at) * (doubtful ? 1.01 : 1.0), doubtful ? Step::Doubtful : Step::Steady, 1e-5);
    }
    return t;
}

/// Linear interpolation.
double at(const Trace& t, double time) {
    std::size_t i = 0;
    while (i + 2 < t.forceTime.size() && t.forceTime[i + 1] < time)
        ++i;
    const double share = (time - t.forceTime[i]) / (t.forceTime[i + 1] - t.forceTime[i]);
    return (1.0 - share) * t.force[i] + share * t.force[i + 1];
}

} // namespace

TEST_CASE("a kink between steady means is found", "[replay]") {
    const auto kink = [](double t) { return t < 0.2137 ? 1.0 - 3.0 * t : 1.0 - 3.0 * 0.2137 - 0.1 * (t - 0.2137); };
    Trace t = read(kink);
    t.mend();
    for (double time = 0.0; time < 0.39; time += 1e-3)
        CHECK(at(t, time) == Approx(kink(time)).margin(1e-12)); // two lines: exact
}

TEST_CASE("a smooth curve goes on between steady means to second order", "[replay]") {
    const auto smooth = [](double t) { return 2.0 + std::sin(2.0 * t); };
    Trace t = read(smooth);
    t.mend();
    for (double time = 0.0; time < 0.39; time += 1e-3) // 1/8 gap^2 F'', F'' below 4, the gap 0.05
        CHECK(at(t, time) == Approx(smooth(time)).margin(1.3e-3));
}

TEST_CASE("where the force jumps its steps stay as they are", "[replay]") {
    const auto jump = [](double t) { return t < 0.215 ? 2.0 - t : 1.0 - t; };
    Trace t = read(jump);
    const Trace before = t;
    t.mend();
    CHECK(t.force == before.force);
    CHECK(t.forceTime == before.forceTime);
}

TEST_CASE("every other step may be doubtful", "[replay]") {
    const auto line = [](double t) { return 1.5 + 0.2 * t; };
    Trace t;
    for (int k = 0; k < 40; ++k)
        t.addForce(0.01 * k, line(0.01 * k) * (k % 2 == 1 ? 1.01 : 1.0), k % 2 == 1 ? Step::Doubtful : Step::Steady,
                   1e-5);
    CHECK(t.endTangent()->at(0.4) == Approx(line(0.4)));
    t.mend();
    for (double time = 0.03; time < 0.36; time += 1e-3) // the first and the last have one steady mean beside them
        CHECK(at(t, time) == Approx(line(time)).epsilon(1e-9));
}

TEST_CASE("a long stretch of doubtful steps is all there is", "[replay]") {
    Trace t = read([](double) { return 1.0; }, 10, 20);
    t.mend();
    CHECK(t.force.size() == 40);
}
