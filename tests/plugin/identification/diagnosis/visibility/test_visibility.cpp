// What runs could show, on a spring whose answers are known.

#include "plugin/identification/diagnosis/visibility.h"
#include "tests/plugin/identification/diagnosis/toy.h"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::diagnosis;

namespace {

/// Independent noise of this standard deviation, N.
Noise white(double size) {
    Noise n;
    n.white = size;
    return n;
}

Visibility visible(const RecordedData& data, double noise) {
    const toy::Spring model(data);
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    return visibilityOf(data, white(noise), evaluator);
}

const VisibleEffect& effect(const Visibility& v, const std::string& label) {
    const auto at = std::find_if(v.effects.begin(), v.effects.end(), [&](const auto& e) { return e.label == label; });
    REQUIRE(at != v.effects.end());
    return *at;
}

/// One run of one speed, without the readings of its dwells.
RecordedData oneSpeed() {
    RecordedData data = toy::recordings(2);
    data.runs.resize(1);
    RecordedRun& run = data.runs.front();
    for (Eigen::Index k = 0; k < run.time.size(); ++k)
        if (run.phase(k) == Phase::Hold)
            run.force[k] = std::nan("");
    return data;
}

} // namespace

TEST_CASE("numbers that runs determine are told with their accuracy", "[diagnosis][visibility]") {
    const RecordedData data = toy::recordings(2);
    const Visibility v = visible(data, 1.0); // noise that hides the model error
    REQUIRE(v.failure.empty());
    REQUIRE(v.numbers.size() == 2);
    // Normal equations by hand of stiffness and friction, in half-widths. Each run has a zero of its own, known to 5
    // standard deviations of the noise.
    constexpr double kHalfStiffness = 6.0, kHalfFriction = 0.05; // N/m, N, as in toy::Spring
    constexpr double kInterval = 3.0;                            // inverse variance of an interval, in half-widths
    double kk = kInterval, kf = 0.0, ff = kInterval;
    for (const RecordedRun& run : data.runs) {
        Eigen::VectorXd k(run.time.size()), f(run.time.size());
        for (Eigen::Index i = 0; i < k.size(); ++i) {
            k[i] = kHalfStiffness * run.displacement[i];
            const double speed =
                run.segments[static_cast<std::size_t>(run.segmentOfRow[static_cast<std::size_t>(i)])].speed;
            f[i] = speed > 0.0 ? kHalfFriction : speed < 0.0 ? -kHalfFriction : 0.0;
        }
        const double zero = 1.0 / 25.0 + static_cast<double>(k.size());
        kk += k.squaredNorm() - k.sum() * k.sum() / zero;
        kf += k.dot(f) - k.sum() * f.sum() / zero;
        ff += f.squaredNorm() - f.sum() * f.sum() / zero;
    }
    const double det = kk * ff - kf * kf;
    CHECK(v.numbers[0].name == "stiffness");
    CHECK(v.numbers[0].left ==
          Approx(kHalfStiffness * std::sqrt(ff / det)).epsilon(0.05)); // rows at reversals do not count
    CHECK(v.numbers[1].left == Approx(kHalfFriction * std::sqrt(kk / det)).epsilon(0.05));
    CHECK(visible(data, 0.01).numbers[0].seen());
    const Visibility noisy = visible(data, 100.0);
    CHECK_FALSE(noisy.numbers[0].seen());
    CHECK(noisy.numbers[0].left == Approx(kHalfStiffness / std::sqrt(kInterval)).epsilon(0.01)); // the runs add nothing
}

TEST_CASE("effects are seen, imitated or too weak", "[diagnosis][visibility]") {
    // A force per speed is seen with several speeds; with one it is friction.
    const Visibility threeSpeeds = visible(toy::recordings(2), 0.01);
    CHECK(effect(threeSpeeds, "dashpot").seen());
    const Visibility single = visible(oneSpeed(), 0.01);
    CHECK_FALSE(effect(single, "dashpot").seen());
    CHECK(effect(single, "dashpot").imitated());
    CHECK(effect(single, "dashpot").like == "friction");
    CHECK(effect(single, "drift").own < effect(threeSpeeds, "drift").own);
    const Visibility noisy = visible(toy::recordings(2), 10.0);
    CHECK_FALSE(effect(noisy, "dashpot").seen());
    CHECK_FALSE(effect(noisy, "dashpot").imitated());
}

TEST_CASE("an interrupt leaves out effects, not the numbers", "[diagnosis][visibility]") {
    const RecordedData data = toy::recordings(2);
    const toy::Spring model(data);
    const Visibility whole = visible(data, 0.01);
    CHECK(whole.untried.empty());
    const auto stoppedAfter = [&](std::size_t simulations) {
        SimulationCache cache;
        std::atomic<bool> enough{simulations == 0};
        Evaluator evaluator(model, data.runs.size(), {}, cache, &enough);
        std::size_t done = 0;
        evaluator.onRun = [&] { enough = ++done >= simulations; };
        return visibilityOf(data, white(0.01), evaluator);
    };
    const std::size_t forNumbers = data.runs.size() * (1 + model.nominal().size());
    const Visibility some = stoppedAfter(forNumbers + 1); // in the first effect
    REQUIRE(some.numbers.size() == whole.numbers.size());
    for (std::size_t i = 0; i < whole.numbers.size(); ++i)
        CHECK(some.numbers[i].left == whole.numbers[i].left);
    CHECK(some.effects.empty());
    CHECK(some.untried.size() == whole.effects.size());
    CHECK_THROWS_AS(stoppedAfter(forNumbers - 1), Stopped);
}
