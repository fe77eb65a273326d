// Specimens that differ: the standard deviation against the closed form of a random-effects model, what is held out,
// and the verdict beside a hidden effect.

#include "../toy.h"

#include "plugin/identification/diagnosis/estimation/baseline_fit.h"
#include "plugin/identification/diagnosis/estimation/scatter.h"
#include "plugin/identification/diagnosis/selection/cross_validation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using namespace supercircle::diagnosis;
using Catch::Matchers::Contains;

namespace {

constexpr double kScale = 4.0; // N/m, stated, of the standard deviation of the stiffness

/// The toy's springs, one a run, whose stiffness differs.
class Bars final : public toy::Spring {
public:
    explicit Bars(const RecordedData& data) : toy::Spring(data), nominal_(toy::Spring::nominal()) {
        nominal_[0].lower = 60.0; // wide, as the closed form supposes
        nominal_[0].upper = 140.0;
        nominal_[0].step = 40.0;
        for (std::size_t r = 0; r < data.runs.size(); ++r) {
            Scalar s;
            s.name = "stiffness." + data.runs[r].specimen;
            s.unit = "N/m";
            s.step = kScale;
            s.specimen = static_cast<int>(r);
            s.batch = 0;
            nominal_.push_back(s);
        }
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] std::vector<BatchFactor> batch() const override { return {{"stiffness", "N/m", {}, 100.0, kScale}}; }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity f,
                                    const std::atomic<bool>* interrupt) const override {
        ParameterPoint one = p;
        one.nominal = {p.nominal[0] + p.nominal[2 + r], p.nominal[1]};
        return toy::Spring::simulate(r, one, f, interrupt);
    }
    [[nodiscard]] ParameterPoint simulated(std::size_t run, const ParameterPoint& p) const override {
        ParameterPoint out = p;
        for (std::size_t i = 2; i < out.nominal.size(); ++i)
            if (i != 2 + run)
                out.nominal[i] = 0.0;
        return out;
    }

private:
    std::vector<Scalar> nominal_;
};

/// Recordings of one spring a run.
/// @param deviations N/m
RecordedData batchOf(const std::vector<double>& deviations, std::uint64_t seed, double dashpot = 0.0) {
    RecordedData data;
    data.statedForceNoise = 0.01;
    Random random(seed);
    for (std::size_t s = 0; s < deviations.size(); ++s) {
        data.runs.push_back(toy::motion("run " + std::to_string(s + 1), s % 2 == 0 ? 2e-3 : 5e-3, 10.0));
        data.runs.back().specimen = "s" + std::to_string(s + 1);
    }
    const toy::Spring spring(data);
    std::vector<Term> hidden;
    if (dashpot > 0.0)
        hidden = {{0, {dashpot}}};
    for (std::size_t s = 0; s < deviations.size(); ++s) {
        data.runs[s].force = spring.simulate(s, {{101.0 + deviations[s], 0.1}, hidden}, Fidelity::Fine, nullptr).force;
        toy::addNoise(data.runs[s], random);
    }
    return data;
}

/// Median of tau for values x_s = theta + tau z_s known exactly, theta flat: the likelihood of a normal sample.
double closedForm(const std::vector<double>& x, double scale) {
    const double n = static_cast<double>(x.size()), mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
    double squares = 0.0;
    for (const double v : x)
        squares += (v - mean) * (v - mean);
    constexpr double kStep = 1e-3;
    std::vector<double> sum = {0.0};
    for (double t = kStep; t < 6.0; t += kStep) {
        const double tau = t * scale;
        sum.push_back(sum.back() + std::exp(-(n - 1.0) * std::log(tau) - 0.5 * squares / (tau * tau) - 0.5 * t * t));
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        if (sum[i] > 0.5 * sum.back())
            return kStep * static_cast<double>(i);
    return 0.0;
}

struct Fitted {
    BaselineFit baseline;
    std::vector<Scatter> scatter;
    Grouping grouping;
    explicit Fitted(const RecordedData& data) {
        const Bars bars(data);
        SimulationCache cache;
        Evaluator evaluator(bars, data.runs.size(), {}, cache);
        baseline = fitBaseline(data, evaluator, estimateNoise(data), toy::exact(), [](double, const std::string&) {});
        REQUIRE(baseline.failure.empty());
        scatter = scattersOf(bars, *baseline.likelihood, baseline.fit);
        grouping = groupingOf(*baseline.likelihood);
    }
};

} // namespace

TEST_CASE("the standard deviation of a batch is that of a random-effects model", "[diagnosis][specimens]") {
    const std::vector<double> deviations = {2.1, -3.4, 0.6, 4.2, -1.9};
    const RecordedData data = batchOf(deviations, 3);
    const Fitted f(data);
    REQUIRE(f.scatter.size() == 1);
    // Each stiffness is known to 0.2 N/m, a fifteenth of their scatter, which moves tau by 0.3 %; the draw of the noise
    // moves the five values by 0.2 N/m, tau by 3 %.
    CHECK(f.scatter[0].median == Approx(closedForm(deviations, kScale)).epsilon(0.05));
    CHECK(f.scatter[0].low < f.scatter[0].median);
    CHECK(f.scatter[0].high > f.scatter[0].median);
    CHECK(f.scatter[0].evidence > 3.0);
    CHECK_FALSE(f.scatter[0].isPrior);
    CHECK(f.baseline.fit.chiSquared / static_cast<double>(f.baseline.likelihood->countedRows()) < 1.2);
    for (std::size_t s = 0; s < deviations.size(); ++s) // to four of the 0.2 N/m
        CHECK(f.baseline.fit.point.nominal[0] + f.baseline.fit.point.nominal[2 + s] ==
              Approx(101.0 + deviations[s]).margin(0.8));
}

TEST_CASE("equal specimens and too few of them are told", "[diagnosis][specimens]") {
    const Fitted same(batchOf({0.0, 0.0, 0.0, 0.0, 0.0}, 4));
    CHECK(same.scatter[0].evidence < 0.0);
    CHECK(same.scatter[0].high < 0.25); // five known to 0.05 scales each
    const Fitted two(batchOf({3.0, -3.0}, 5));
    CHECK(two.scatter[0].isPrior);
    CHECK(two.scatter[0].median == Approx(0.6745).epsilon(0.01)); // of a half-normal distribution
    CHECK(two.scatter[0].high == Approx(1.960).epsilon(0.01));
}

TEST_CASE("all runs of a specimen are held out together", "[diagnosis][specimens]") {
    RecordedData data = batchOf({1.0, -1.0, 2.0, 0.0}, 6);
    for (std::size_t r = 0; r < 4; ++r)
        data.runs[r].specimen = r < 2 ? "a" : "b";
    const Likelihood likelihood(data, estimateNoise(data),
                                {{"", data.runs[0].force, {}},
                                 {"", data.runs[1].force, {}},
                                 {"", data.runs[2].force, {}},
                                 {"", data.runs[3].force, {}}},
                                {{"", data.runs[0].force, {}},
                                 {"", data.runs[1].force, {}},
                                 {"", data.runs[2].force, {}},
                                 {"", data.runs[3].force, {}}},
                                toy::exact().likelihood);
    const Grouping g = groupingOf(likelihood);
    CHECK(g.folds == 2);
    CHECK(g.names == std::vector<std::string>{"specimen a", "specimen b"});
}

TEST_CASE("a held-out specimen is predicted with the scatter of the batch", "[diagnosis][specimens]") {
    const RecordedData data = batchOf({2.1, -3.4, 0.6, 4.2, -1.9}, 7);
    const Bars bars(data);
    SimulationCache cache;
    Evaluator evaluator(bars, data.runs.size(), {}, cache);
    const BaselineFit f =
        fitBaseline(data, evaluator, estimateNoise(data), toy::exact(), [](double, const std::string&) {});
    const Grouping g = groupingOf(*f.likelihood);
    CHECK(g.folds == 5);
    const PredictiveScore held = crossValidate(evaluator, *f.likelihood, g, f.fit);
    // The deviation is integrated out: the standardised error of a reading is as in the fit, although the forecast by
    // the common value is off by up to 4 N/m over 10 mm, four times the noise. Five deviations and four other numbers
    // of 1500 rows change it by 1 %.
    const double inFit = f.fit.residual.squaredNorm() / static_cast<double>(f.likelihood->countedRows());
    CHECK(held.energy.sum() / held.rows.sum() == Approx(inFit).epsilon(0.05));
}

TEST_CASE("an effect is found beside specimens that differ", "[diagnosis][specimens]") {
    const auto diagnosed = [](double dashpot) {
        const RecordedData data = batchOf({2.1, -3.4, 0.6, 4.2, -1.9}, 8, dashpot);
        const Bars bars(data);
        SimulationCache cache;
        Evaluator evaluator(bars, data.runs.size(), {}, cache);
        return diagnose(data, evaluator, toy::exact());
    };
    const Diagnosis with = diagnosed(8.0);
    CHECK(with.verdict == "identified");
    REQUIRE(!with.effects.empty());
    CHECK(with.effects.front().label == "dashpot");
    CHECK(with.effects.front().parameters.front().ci90.low < 8.0);
    CHECK(with.effects.front().parameters.front().ci90.high > 8.0);
    CHECK_THAT(with.statement, Contains("The specimens differ: stiffness by "));
    REQUIRE(with.batch.size() == 1);
    CHECK(with.batch.front().std == Approx(3.0).epsilon(0.3)); // sample: 3.1 N/m
    CHECK(with.batch.front().specimens.size() == 5);
    CHECK(with.nominal.size() == 2); // deviations are no stated parameters
    const Diagnosis without = diagnosed(0.0);
    CHECK(without.verdict == "adequate");
    CHECK_THAT(without.statement, Contains("The specimens differ: stiffness by "));
}
