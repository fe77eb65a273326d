// What channels beside the first one show: their sensors, their jumps, and what they would tell in a next run.

#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/next_experiment/run_likelihood.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/recording/experiment/load.h"
#include "tests/plugin/identification/diagnosis/toy.h"
#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

constexpr double kDrop = 20.0, kSecond = 0.3; // of the second channel, in its unit

/// The toy's spring. A second channel reads 40 times its force, and falls where a latch opens that the first one does
/// not see.
class HiddenLatch final : public toy::Spring {
public:
    HiddenLatch(const RecordedData& data, double place) : Spring(data), place_(place) {}
    [[nodiscard]] double opens(std::size_t r) const {
        const DriveSegment& down = data_.runs[r].segments[1];
        return down.from + place_ / down.speed;
    }

private:
    void alter(std::size_t r, const ParameterPoint&, Response& out) const override {
        if (data_.runs[r].furtherCount == 0)
            return;
        out.further = 40.0 * out.force;
        for (Eigen::Index k = 0; k < out.force.size(); ++k)
            out.further[k] -= data_.runs[r].time[k] > opens(r) ? kDrop : 0.0;
        out.jumps = Eigen::VectorXd::Constant(1, opens(r));
    }
    double place_; ///< m
};

RecordedData latched(double place) {
    RecordedData data = toy::recordings(11);
    Random random(12);
    data.further = {{"moment", "N_mm", kSecond, 1.0}};
    for (RecordedRun& run : data.runs) {
        run.furtherCount = 1;
        run.further = Eigen::VectorXd::Zero(run.force.size());
    }
    const HiddenLatch model(data, place);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        data.runs[r].further = model.simulate(r, {{103.0, 0.08}, {}}, Fidelity::Fine, nullptr).further;
        for (double& v : data.runs[r].further)
            v += kSecond * random.normal();
    }
    return data;
}

Noise whiteNoise() {
    Noise n, second;
    n.white = 0.01;
    second.white = kSecond;
    n.further = {second};
    return n;
}

experiment::Experiment oscillator() {
    const test::Folder folder;
    std::string rows = "time_s,y_mm,a_m_s2\n";
    for (int k = 0; k < 100; ++k)
        rows += std::to_string(0.01 * k) + "," + std::to_string(50.0 * std::cos(0.1 * k)) + "," +
                std::to_string(-4.0 * std::cos(0.1 * k)) + "\n";
    folder.write("run.csv", rows);
    auto out = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "mass_on_spring", "channels": [{"observe": "position", "column": "y_mm", "noise_std": 0.1},
        {"observe": "acceleration", "column": "a_m_s2", "noise_std": 0.05}], "runs": [{"file": "run.csv"}]})"));
    INFO(out.error());
    REQUIRE(out);
    return *out;
}

} // namespace

TEST_CASE("a jump that only a further channel shows is a time", "[diagnosis][channels]") {
    const RecordedData data = latched(6.4e-3);
    const HiddenLatch model(data, 6.4e-3), late(data, 6.7e-3);
    std::vector<Response> there, after;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        there.push_back(model.simulate(r, {{103.0, 0.08}, {}}, Fidelity::Fine, nullptr));
        after.push_back(late.simulate(r, {{103.0, 0.08}, {}}, Fidelity::Fine, nullptr));
    }
    const Likelihood likelihood(data, whiteNoise(), there, there, toy::exact().likelihood);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        CAPTURE(r);
        REQUIRE(likelihood.jumps(r).size() == 1);
        const RawDifference d = likelihood.rawResidual(r, after[r]);
        REQUIRE(d.rows.size() == likelihood.rowsOf(r));
        // the recorded jump is known to a row
        CHECK(d.rows[d.rows.size() - 1] == Approx(model.opens(r) - late.opens(r)).margin(data.runs[r].spacing()));
        // rows between the two jumps are masked in the channel that falls: none is wrong by its height
        const Eigen::Index n = data.runs[r].force.size();
        double most = 0.0;
        for (Eigen::Index k = n; k < 2 * n; ++k)
            most = likelihood.counts(r, k) ? std::max(most, std::abs(d.rows[k])) : most;
        CHECK(most < 0.5 * kDrop);
    }
}

TEST_CASE("a next run tells by all of its channels", "[diagnosis][channels]") {
    CandidateRun press;
    press.description = "press";
    press.time = {0.0, 10.0};
    press.displacement = {0.0, 0.01};
    press.rate = 20.0;
    CandidateRunResponse one, other;
    one.time = Eigen::VectorXd::LinSpaced(201, 0.0, 10.0);
    one.force = Eigen::VectorXd::LinSpaced(201, 0.0, 1.0);
    other = one;
    other.force *= 1.02;
    const auto information = [&](const CandidateRunResponse& a, const CandidateRunResponse& b) {
        const RunLikelihood likelihood(press, a, whiteNoise(), 0.0, 1);
        const auto d = likelihood.difference(a, b);
        REQUIRE(d);
        return d->squaredNorm();
    };
    const double first = information(one, other);
    press.further = {1.0};
    one.further = 30.0 * one.force; // as noisy as the first one, in its unit
    other.further = one.further;
    CHECK(information(one, other) == Approx(first).epsilon(1e-9));
    other.further = 30.0 * other.force;
    CHECK(information(one, other) == Approx(2.0 * first).epsilon(1e-6)); // shares of the peak scale likewise
    press.further = {0.0};
    CHECK(information(one, other) == Approx(first).epsilon(1e-9));
}

TEST_CASE("sensors of further channels are candidates that change them alone", "[diagnosis][channels]") {
    const experiment::Experiment e = oscillator();
    const ReplayModel model(e);
    std::size_t found = 0;
    ParameterPoint point;
    for (const Scalar& s : model.nominal())
        point.nominal.push_back(s.value);
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const CandidateEffect& candidate = model.candidates()[c];
        if (candidate.label != "sensor_gain")
            continue;
        ++found;
        ParameterPoint with = point;
        with.terms.push_back({c, {0.06}});
        CHECK(model.simulated(0, with).terms.empty()); // no simulation
        const Response plain = model.simulate(0, point, Fidelity::Coarse, nullptr);
        Response read = plain;
        model.read(0, with, read);
        const bool ofFirst = candidate.variant.empty();
        CHECK((ofFirst || candidate.variant == "channel acceleration"));
        CHECK(read.force.isApprox((ofFirst ? 1.06 : 1.0) * plain.force, 1e-12));
        CHECK(read.further.isApprox((ofFirst ? 1.0 : 1.06) * plain.further, 1e-12));
        replay::Parameters p; // and the replay does the same
        REQUIRE(model.parametersAt(with, p).empty());
        const auto again = responseOf(e, 0, replay::simulate(e, 0, p, replay::Resolution::coarse()));
        CHECK(again.further.isApprox(read.further, 1e-12));
    }
    CHECK(found == 2);
}
