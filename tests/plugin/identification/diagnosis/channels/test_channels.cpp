// Likelihood and noise of several channels, on a straight line whose answers are known.

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/localisation/windows.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/noise.h"
#include "tests/plugin/identification/diagnosis/toy.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using namespace supercircle::diagnosis;

namespace {

constexpr double kSecond = 0.3; // standard deviation of the second channel, in its unit

/// The toy's spring, and a second channel that reads 40 times its force.
class TwoChannels final : public toy::Spring {
public:
    explicit TwoChannels(const RecordedData& data) : Spring(data) {}
    [[nodiscard]] std::string identity() const override { return "spring with two channels"; }

private:
    void alter(std::size_t r, const ParameterPoint&, Response& out) const override {
        if (data_.runs[r].furtherCount > 0)
            out.further = 40.0 * out.force;
    }
};

/// White noise in both channels, the second without memory.
RecordedData recordings(std::uint64_t seed, double weight = 1.0) {
    RecordedData data = toy::recordings(seed);
    Random random(seed + 100);
    data.further = {{"moment", "N_mm", kSecond, weight}};
    const RecordedData one = data;
    const toy::Spring model(one);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        RecordedRun& run = data.runs[r];
        run.furtherCount = 1;
        run.further = 40.0 * model.simulate(r, {{103.0, 0.08}, {}}, Fidelity::Fine, nullptr).force;
        for (double& v : run.further)
            v += kSecond * random.normal();
    }
    return data;
}

std::vector<Response> at(const Model& model, const RecordedData& data, double stiffness) {
    std::vector<Response> all;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        all.push_back(model.simulate(r, {{stiffness, 0.08}, {}}, Fidelity::Fine, nullptr));
    return all;
}

Noise whiteNoise() {
    Noise n;
    n.white = 0.01;
    Noise second;
    second.white = kSecond;
    n.further = {second};
    return n;
}

} // namespace

TEST_CASE("each channel is whitened by its own noise", "[diagnosis][channels]") {
    const RecordedData data = recordings(3);
    const TwoChannels model(data);
    const auto there = at(model, data, 103.0);
    LikelihoodSettings s = toy::exact().likelihood;
    const Likelihood likelihood(data, whiteNoise(), there, there, s);
    const auto residual = likelihood.residual(there);
    REQUIRE(residual);
    double first = 0.0, second = 0.0, rows = 0.0;
    for (std::size_t r = 0; r < likelihood.runs(); ++r)
        for (Eigen::Index k = 0; k < likelihood.rowsOf(r); ++k) {
            const double u = (*residual)[likelihood.start(r) + k];
            const std::size_t channel = likelihood.channelOf(r, k);
            REQUIRE((channel == 0 || channel == 2));
            (channel == 0 ? first : second) += u * u;
            rows += channel == 2 && likelihood.counts(r, k) ? 1.0 : 0.0;
            REQUIRE(likelihood.timeOfReading(r, k) == data.runs[r].time[k % data.runs[r].time.size()]);
        }
    CHECK(rows > 1000.0);
    CHECK(second / rows == Approx(1.0).epsilon(4.0 * std::sqrt(2.0 / rows))); // four standard deviations
    // whitening and its transpose are adjoint
    Random random(5);
    Eigen::VectorXd a(likelihood.rowsOf(0)), b(likelihood.rowsOf(0));
    for (Eigen::Index k = 0; k < a.size(); ++k) {
        a[k] = random.normal();
        b[k] = random.normal();
    }
    const double there1 = likelihood.whiten(0, a).dot(b), there2 = a.dot(likelihood.whitenTransposed(0, b));
    CHECK(there1 == Approx(there2).epsilon(1e-9));
}

TEST_CASE("information of channels adds up, in the share of their weights", "[diagnosis][channels]") {
    // Squared whitened signal of a change of stiffness: with both channels it is the sum of those of each.
    const auto information = [&](double weight, bool firstOnly) {
        RecordedData data = recordings(4, weight);
        if (firstOnly) {
            data.further.clear();
            for (RecordedRun& run : data.runs) {
                run.further.resize(0);
                run.furtherCount = 0;
            }
        }
        const TwoChannels model(data);
        const auto here = at(model, data, 103.0), up = at(model, data, 104.0);
        const Likelihood likelihood(data, whiteNoise(), here, here, toy::exact().likelihood);
        return likelihood.whitenedDifference(up, here)->squaredNorm();
    };
    const double first = information(1.0, true), both = information(1.0, false);
    CHECK(both > 1.5 * first); // 40 / 0.3 against 1 / 0.01: 1.8 times as much again
    CHECK(information(0.25, false) - first == Approx(0.25 * (both - first)).epsilon(0.02)); // the zero is free in both
    CHECK(information(0.0, false) == Approx(first).epsilon(1e-12));
}

TEST_CASE("the noise of each channel is estimated by itself", "[diagnosis][channels]") {
    const RecordedData data = recordings(6);
    const Noise noise = estimateNoise(data), alone = estimateNoise(toy::recordings(6));
    REQUIRE(noise.further.size() == 1);
    CHECK(noise.white == alone.white);
    CHECK(noise.correlated == alone.correlated);
    CHECK(noise.further[0].total() == Approx(kSecond).epsilon(0.2)); // the prior of a stated noise
}

TEST_CASE("a fit to two channels is as narrow as their information says", "[diagnosis][channels]") {
    const RecordedData data = recordings(8);
    const TwoChannels model(data);
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    ParameterPoint start;
    for (const Scalar& s : model.nominal())
        start.nominal.push_back(s.value);
    const auto there = evaluator.simulateAllRuns({start}, Fidelity::Fine).front();
    const Likelihood likelihood(data, whiteNoise(), there, there, toy::exact().likelihood);
    const FitResult fitted = fit(evaluator, likelihood, start, {});
    REQUIRE(fitted.failure.empty());
    // One newton per metre changes the second channel by 40 times the displacement.
    double information = 0.0;
    for (const RecordedRun& run : data.runs)
        for (const double x : run.displacement)
            information += std::pow(40.0 * x / kSecond, 2);
    CHECK(std::abs(fitted.point.nominal[0] - 103.0) < 4.0 / std::sqrt(information / 3.0)); // a zero is fitted as well
    // what the second channel alone shows is found in its windows
    bool found = false;
    for (const WindowRows& w : windowsOf(likelihood))
        found = found || w.window.channel == "moment";
    CHECK(found);
}

TEST_CASE("a channel can stand in place of the first", "[diagnosis][channels]") {
    RecordedData data = recordings(9);
    const RecordedRun first = data.runs.front().withChannel(0);
    CHECK(first.force == data.runs.front().further);
    CHECK(first.furtherCount == 0);
    const RecordedData second = data.withChannel(0);
    CHECK(second.channel == "moment");
    CHECK(second.unit == "N_mm");
    CHECK(second.further.empty());
    CHECK(second.runs.size() == data.runs.size());
}
