// Replacement of uncertain forces by tangents of steady ones.

#include "plugin/identification/replay/trace.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::replay;

namespace {

using Forces = std::vector<ForceSample>;

/// Forces of a curve every 10 ms; some are uncertain and wrong by 1 %.
template <class Curve, class Uncertain>
Forces read(const Curve& force, const Uncertain& doubtful) {
    Forces out;
    for (int k = 0; k < 40; ++k) {
        const double at = 0.01 * k;
        out.push_back({at, force(at) * (doubtful(k) ? 1.01 : 1.0),
                       doubtful(k) ? MeanForceKind::Uncertain : MeanForceKind::Steady, 1e-5});
    }
    return out;
}

bool some(int k) {
    return k >= 20 && k < 24;
}

/// Linear interpolation.
double at(const Forces& f, double time) {
    std::size_t i = 0;
    while (i + 2 < f.size() && f[i + 1].time < time)
        ++i;
    const double share = (time - f[i].time) / (f[i + 1].time - f[i].time);
    return (1.0 - share) * f[i].force + share * f[i + 1].force;
}

} // namespace

TEST_CASE("a kink between steady means is found", "[replay]") {
    const auto kink = [](double t) { return t < 0.2137 ? 1.0 - 3.0 * t : 1.0 - 3.0 * 0.2137 - 0.1 * (t - 0.2137); };
    const Forces t = despiked(read(kink, some));
    for (double time = 0.0; time < 0.39; time += 1e-3)
        CHECK(at(t, time) == Approx(kink(time)).margin(1e-12)); // two straight lines: exact
}

TEST_CASE("a smooth curve is interpolated to second order", "[replay]") {
    const auto smooth = [](double t) { return 2.0 + std::sin(2.0 * t); };
    const Forces t = despiked(read(smooth, some));
    for (double time = 0.0; time < 0.39; time += 1e-3) // 1/8 gap^2 F'', F'' below 4, the gap 0.05
        CHECK(at(t, time) == Approx(smooth(time)).margin(1.3e-3));
}

TEST_CASE("forces around a jump are kept", "[replay]") {
    const auto jump = [](double t) { return t < 0.215 ? 2.0 - t : 1.0 - t; };
    const Forces before = read(jump, some), t = despiked(before);
    REQUIRE(t.size() == before.size());
    for (std::size_t k = 0; k < t.size(); ++k)
        CHECK((t[k].force == before[k].force && t[k].time == before[k].time));
}

TEST_CASE("every other step may be uncertain", "[replay]") {
    const auto line = [](double t) { return 1.5 + 0.2 * t; };
    Forces all = read(line, [](int k) { return k % 2 == 1; });
    const Forces t = despiked(all);
    CHECK(endTangent(all)->at(0.4) == Approx(line(0.4)));
    CHECK(all.size() == 39);                            // the last one is dropped
    for (double time = 0.03; time < 0.36; time += 1e-3) // the first and the last have one steady neighbour
        CHECK(at(t, time) == Approx(line(time)).epsilon(1e-9));
}

TEST_CASE("a long interval of uncertain steps is kept", "[replay]") {
    const Forces all = read([](double) { return 1.0; }, [](int k) { return k >= 10 && k < 20; });
    CHECK(despiked(all).size() == all.size());
}
