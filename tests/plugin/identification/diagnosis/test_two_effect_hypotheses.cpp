// Starts of fits: laws with a threshold, second effects, searches in a corner.

#include "toy.h"

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/law_variants.h"
#include "plugin/identification/diagnosis/selection/two_effect_hypotheses.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace supercircle::diagnosis;

namespace {

/// A spring that yields beyond a force and is linear below it. Its internal value is the reciprocal of that force.
class GivesWay final : public toy::Spring {
public:
    using Spring::Spring;
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        for (const Term& t : p.terms)
            if (t.candidate == 0)
                for (double& force : out.force)
                    force = t.values[0] > 0.0 ? std::min(force, 1.0 / t.values[0]) : force;
        for (const Term& t : p.terms)
            if (t.candidate == 1) // of the sensor: added last
                out.force += t.values[0] * data_.runs[r].time;
    }

    std::vector<CandidateEffect> candidates_ = {
        {"gives_way", "", "", "", {{"most", "1/N", "", 0.0, 0.0, 10.0, 0.1, Scale::Linear, true}}, {{2.0}}},
        {"ramp", "", "", "", {{"a", "N/s", "", 0.0, -1.0, 1.0, 1e-2, Scale::Linear, true}}, {{0.05}}}};
};

} // namespace

TEST_CASE("a law with a threshold is fitted from an amplitude at which it acts", "[diagnosis]") {
    // The recorded force yields at 0.9 N of 1.1 N; the probe yields at 0.5 N. Its signature scaled by a third would
    // fit, but a third of the probe yields at 1.5 N and has no effect.
    RecordedData data = toy::recordings(3);
    const GivesWay model(data);
    toy::hide(data, model, {{0, {1.0 / 0.9}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const FitResult base = fit(evaluator, likelihood, ParameterPoint{{100.0, 0.1}, {}});
    const ScreenedProbe probe = screen(evaluator, likelihood, base).front();
    REQUIRE(probe.gain > 100.0);
    REQUIRE(probe.values[0] < 1.0 / 1.1); // below the threshold
    const FitResult lost = fit(evaluator, likelihood, ParameterPoint{base.point.nominal, {{0, probe.values}}});
    CHECK(lost.chiSquared > base.chiSquared - 1.0);
    const FitResult found =
        fit(evaluator, likelihood,
            ParameterPoint{base.point.nominal, {{0, bestAmplitudeValues(evaluator, likelihood, base, probe)}}});
    CHECK(found.chiSquared < base.chiSquared - probe.gain);
    CHECK(found.point.terms[0].values[0] == Approx(1.0 / 0.9).epsilon(0.02));
}

namespace {

/// A spring that yields beyond a threshold so sharply that 1e-3 more amplitude removes half of its force, like the tip
/// of a strip.
class Yields final : public toy::Spring {
public:
    using Spring::Spring;
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        const auto& at = data_.runs[r].displacement;
        for (const Term& t : p.terms)
            for (Eigen::Index k = 0; k < out.force.size(); ++k)
                out.force[k] -= at[k] > 0.005 ? 500.0 * std::max(0.0, t.values[0] - 1.0) : 0.0;
    }

    std::vector<CandidateEffect> candidates_ = {
        {"yields", "", "", "", {{"size", "1", "", 0.0, 0.0, 10.0, 0.1, Scale::Linear, true}}, {{2.0}}}};
};

} // namespace

TEST_CASE("a law whose signature grows a hundredfold just above its threshold is fitted", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const Yields model(data);
    toy::hide(data, model, {{0, {1.0004}}}); // 0.2 N; the probe removes 500 N, at 1.0 it has no effect
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, toy::exact().likelihood);
    const FitResult base = fit(evaluator, likelihood, ParameterPoint{{100.0, 0.1}, {}});
    const ScreenedProbe probe = screen(evaluator, likelihood, base).front();
    REQUIRE(probe.gain > 100.0);
    const std::vector<double> settled = bestAmplitudeValues(evaluator, likelihood, base, probe);
    CHECK(settled[0] > 1.0001); // half of the linearised gain is reached from 0.3 to 1.7 times the hidden force
    CHECK(settled[0] < 1.0007);
    const FitResult found = fit(evaluator, likelihood, ParameterPoint{base.point.nominal, {{0, settled}}});
    // The derivative changes a hundredfold within a step, so it is refreshed until that brings nothing: a patient fit
    // ends no more than 2 lower, and so do the hidden numbers.
    const ParameterPoint hidden{{103.0, 0.08}, {{0, {1.0004}}}};
    const auto noise = likelihood.residual(evaluator.simulateAllRuns({hidden}, Fidelity::Fine).front());
    REQUIRE(noise);
    CHECK(found.chiSquared < noise->squaredNorm() + 2.0);
    CHECK(found.chiSquared < 1.2 * static_cast<double>(likelihood.countedRows())); // noise
    FitSettings patient;
    patient.iterations = 200;
    patient.refreshes = patient.nominalRefreshes = 50;
    const FitResult best = fit(evaluator, likelihood, ParameterPoint{base.point.nominal, {{0, settled}}}, patient);
    INFO(found.chiSquared << ", patient " << best.chiSquared);
    CHECK(found.chiSquared < best.chiSquared + 2.0);
    CHECK(found.point.terms[0].values[0] == Approx(1.0004).epsilon(5e-5));
}

TEST_CASE("the second of two effects starts from an amplitude at which it acts", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const GivesWay model(data);
    toy::hide(data, model, {{1, {0.1}}, {0, {1.0 / 0.9}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    // All rows count, although friction acts immediately at reversals.
    const Likelihood likelihood(data, estimateNoise(data), there, there, toy::exact().likelihood);
    const FitResult base = fit(evaluator, likelihood, ParameterPoint{{100.0, 0.1}, {}});
    FittedHypothesis drift;
    drift.candidates = {1};
    drift.fit = fit(evaluator, likelihood, ParameterPoint{base.point.nominal, {{1, {0.05}}}});
    const std::vector<FittedHypothesis> pairs = fitTwoEffects(evaluator, likelihood, {drift});
    REQUIRE(pairs.size() == 1);
    CHECK(pairs[0].candidates == std::vector<std::size_t>{1, 0});
    CHECK(pairs[0].fit.chiSquared <
          1.2 * static_cast<double>(likelihood.countedRows())); // noise; the drift alone leaves more
    CHECK(drift.fit.chiSquared > 1.5 * static_cast<double>(likelihood.countedRows()));
    CHECK(pairs[0].fit.point.terms[1].values[0] == Approx(1.0 / 0.9).epsilon(0.02));
}

namespace {

/// A spring whose objective has local minima in the friction, at the true 0.08 N and at 0.14 N: from one end of the
/// stated interval no step leads to the first.
class Rugged final : public toy::Spring {
public:
    explicit Rugged(const RecordedData& data) : Spring(data) {}
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        constexpr double kPi = 3.14159265358979;
        out.force += 30.0 * (1.0 - std::cos(2.0 * kPi * (p.nominal[1] - 0.08) / 0.06)) * data_.runs[r].displacement;
    }

    std::vector<CandidateEffect> candidates_{Spring::candidates()[0],
                                             Spring::candidates()[1]}; ///< dashpot and drift alone
};

} // namespace

TEST_CASE("a fit that ended in a corner is repeated from the stated parameters", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const Rugged model(data);
    toy::hide(data, model, {{0, {5.0}}, {1, {0.01}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const double noise = static_cast<double>(likelihood.countedRows());
    FittedHypothesis drift;
    drift.candidates = {1};
    drift.fit = fit(evaluator, likelihood, ParameterPoint{{100.0, 0.15}, {{1, {0.01}}}});
    REQUIRE(drift.fit.point.nominal[1] > 0.12); // stayed in the corner
    const auto better = refitFromStated(evaluator, likelihood, drift);
    REQUIRE(better);
    CHECK(better->candidates == drift.candidates);
    CHECK(better->fit.chiSquared < drift.fit.chiSquared);
    CHECK(better->fit.point.nominal[1] == Approx(0.08).margin(0.01));
    CHECK_FALSE(refitFromStated(evaluator, likelihood, *better)); // no improvement
    // In the corner friction imitates the dashpot; from the new start the second effect is found.
    const std::vector<FittedHypothesis> pairs = fitTwoEffects(evaluator, likelihood, {*better});
    REQUIRE(pairs.size() == 1);
    CHECK(pairs[0].candidates == std::vector<std::size_t>{1, 0});
    CHECK(pairs[0].fit.chiSquared < 1.2 * noise);
    // Within three standard errors.
    const Variables v(model, pairs[0].fit.point);
    const Eigen::Index c = v.size() - 1;
    const double error = v.scalar(c).step * std::sqrt(posteriorCovariance(v, pairs[0].fit.jacobian, 1.0)(c, c));
    CHECK(error < 1.0);
    CHECK(pairs[0].fit.point.terms[1].values[0] == Approx(5.0).margin(3.0 * error));
}

namespace {

/// Minima of the friction at the stated 0.10 N and at 0.14 N.
class Grooved final : public toy::Spring {
public:
    explicit Grooved(const RecordedData& data) : Spring(data) {}

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        constexpr double kPi = 3.14159265358979;
        out.force += 300.0 * (1.0 - std::cos(2.0 * kPi * (p.nominal[1] - 0.10) / 0.04)) * data_.runs[r].displacement;
    }
};

} // namespace

TEST_CASE("no fit is beaten by the stated numbers with its law", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const Grooved model(data);
    toy::hide(data, model, {{0, {5.0}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, toy::exact().likelihood);
    FitResult base; // in the wrong groove
    const Variables v(model, ParameterPoint{{100.0, 0.1}, {}});
    base.x = v.of(ParameterPoint{{100.0, 0.14}, {}});
    REQUIRE(evaluate(evaluator, likelihood, v, base));
    differentiate(evaluator, likelihood, v, base.x, 0.01, {0, 1}, base.jacobian);
    const std::vector<ScreenedProbe> screened = screen(evaluator, likelihood, base);
    std::size_t left = 0; // the wrong groove
    for (const RankedProbes& probes : byLabel(model, screened, 8.0)) {
        double least = 0.0;
        std::set<std::size_t> fitted;
        const auto found = fitLabel(evaluator, likelihood, base, probes, least, fitted);
        REQUIRE(found);
        ParameterPoint stated = found->fit.point;
        stated.nominal = {100.0, 0.1};
        const auto residual = likelihood.residual(evaluator.simulateAllRuns({stated}, Fidelity::Fine).front());
        REQUIRE(residual);
        CHECK(found->fit.chiSquared <= residual->squaredNorm());
        left += found->fit.point.nominal[1] < 0.12 ? 1 : 0;
    }
    CHECK(left > 0);
}
