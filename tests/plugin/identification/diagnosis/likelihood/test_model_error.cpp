// What a likelihood takes for the error of the simulation, and which rows it leaves out.

#include "tests/plugin/identification/diagnosis/toy.h"

#include "plugin/identification/diagnosis/likelihood/model_error.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/noise.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle::diagnosis;

TEST_CASE("marker positions have a common error in each segment", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    data.runs.resize(1);
    const RecordedRun& run = toy::withMarkers(data, {0.5});
    const Eigen::Index n = run.time.size();
    const std::vector<Response> there = {{{}, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(2 * n)}};
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    Eigen::VectorXd shifted = Eigen::VectorXd::Zero(2 * n), shaken = shifted;
    double rows = 0.0;
    for (Eigen::Index k = 0; k < n; ++k)
        if (run.segmentOfRow[static_cast<std::size_t>(k)] == 1) { // the first loading, x
            shifted[k] = 1e-5;
            shaken[k] = (k % 2 == 0 ? 1e-5 : -1e-5);
            rows += 1.0;
        }
    REQUIRE(rows > 100.0);
    const auto size = [&](const Eigen::VectorXd& markers) {
        Eigen::VectorXd rawResidual(3 * n);
        rawResidual << Eigen::VectorXd::Zero(n), markers;
        return likelihood.whiten(0, rawResidual).norm();
    };
    // Sums over rows of the transposed map are products with whitened shifts.
    Random random(7);
    Eigen::VectorXd a(3 * n), b(3 * n);
    for (Eigen::Index k = 0; k < 3 * n; ++k) {
        a[k] = 1e-4 * random.normal();
        b[k] = random.normal();
    }
    CHECK(likelihood.whiten(0, a).dot(b) == Approx(a.dot(likelihood.whitenTransposed(0, b))).epsilon(1e-9));
    // A shift counts as much as the mean, whose sigma is that of the position and of so many rows.
    const double one = std::hypot(3e-5, LikelihoodSettings{}.markerAccuracy), shift = LikelihoodSettings{}.markerShift;
    CHECK(size(shifted) == Approx(1e-5 / std::sqrt(shift * shift + one * one / rows)).epsilon(0.001));
    CHECK(size(shaken) == Approx(std::sqrt(rows) * 1e-5 / one).epsilon(0.01));
}

TEST_CASE("markers are excluded while a released specimen oscillates", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const RecordedRun& run = toy::withMarkers(data, {0.5});
    const Eigen::Index n = run.time.size();
    // Contact at 2 s, 1 N at 5 s, release at 8 s: too slow for a snap.
    Response there{{}, Eigen::VectorXd(n), Eigen::VectorXd::Zero(2 * n)};
    for (Eigen::Index k = 0; k < n; ++k)
        there.force[k] = std::max(0.0, 1.0 - std::abs(run.time[k] - 5.0) / 3.0);
    LikelihoodSettings settings;
    settings.contactAccuracy = settings.reversalRows = 0.0; // the friction of the recorded spring acts immediately
    const ModelError errors = modelErrorOf(run, estimateNoise(data), there, there, 1.0, settings);
    REQUIRE(errors.snaps.empty());
    const double below = 8.0 - 3.0 * settings.releasedShare; // at a hundredth of the peak, to one row
    for (Eigen::Index k = 0; k < n; ++k) {
        const double t = run.time[k], row = run.spacing();
        CAPTURE(t);
        CHECK(std::isfinite(errors.force[k]));
        CHECK(std::isfinite(errors.markers[k]) == std::isfinite(errors.markers[n + k])); // x and y alike
        if (t < below - row || t > below + settings.releaseOscillation + row)
            CHECK(std::isfinite(errors.markers[k]));
        if (t > below + row && t < below + settings.releaseOscillation - row)
            CHECK_FALSE(std::isfinite(errors.markers[k]));
    }
}

TEST_CASE("the discretisation correction is subtracted", "[diagnosis]") {
    const RecordedData data = toy::recordings(3);
    const toy::Spring model(data);
    const ParameterPoint truth{{103.0, 0.08}, {}};
    LikelihoodSettings settings;
    settings.contactPosition = settings.shareOfPeak = 0.0;
    settings.contactAccuracy = settings.reversalRows = 0.0; // all rows count
    // An error of 2 mN that grows as the square of the elements' length.
    constexpr double kError = 2e-3;
    std::vector<Response> exact, fine, finer;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        exact.push_back(model.simulate(r, truth, Fidelity::Fine, nullptr));
        fine.push_back(exact.back());
        fine.back().force.array() += kError;
        finer.push_back(exact.back());
        finer.back().force.array() += kError * (1.0 - 1.0 / settings.refinement);
    }
    const Likelihood likelihood(data, estimateNoise(data), fine, finer, settings);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const Eigen::VectorXd left = likelihood.rawResidual(r, fine[r]).rows - (data.runs[r].force - exact[r].force);
        CHECK(left.cwiseAbs().maxCoeff() < 1e-12); // round-off of 1 N
        const ModelError& errors = likelihood.errors(r);
        CHECK(errors.force.maxCoeff() == Approx(settings.uncorrected * kError).epsilon(1e-6));
    }
    // Shells that move freely have one too, bodies alone do not: what they differ by comes from time steps.
    RecordedData freely = data;
    freely.free = freely.freeShells = true;
    const Likelihood shells(freely, estimateNoise(data), fine, finer, settings);
    freely.freeShells = false;
    const Likelihood bodies(freely, estimateNoise(data), fine, finer, settings);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        CHECK(shells.errors(r).correction == likelihood.errors(r).correction);
        CHECK(bodies.errors(r).correction.isZero(0.0));
    }
    // Another likelihood of the same simulations has the same error.
    const Likelihood again(data, estimateNoise(data), exact, likelihood.finerThan(exact), settings);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        CHECK((again.errors(r).correction - likelihood.errors(r).correction).cwiseAbs().maxCoeff() < 1e-12);
    // Where the difference alternates in sign, all of it stays as model error.
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        for (Eigen::Index k = 0; k < finer[r].force.size(); k += 2)
            finer[r].force[k] = fine[r].force[k] - (finer[r].force[k] - fine[r].force[k]);
    const Likelihood erratic(data, estimateNoise(data), fine, finer, settings);
    CHECK(erratic.errors(0).force.segment(100, 50).mean() == Approx(kError).epsilon(0.05)); // windows of odd length
}

TEST_CASE("a sample after the end of the drive is excluded", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const toy::Spring model(data);
    std::vector<Response> fine, finer;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        fine.push_back(model.simulate(r, ParameterPoint{{103.0, 0.08}, {}}, Fidelity::Fine, nullptr));
        fine.back().force.tail(1).setConstant(std::numeric_limits<double>::quiet_NaN()); // outside the drive
        finer.push_back(fine.back());
    }
    const Likelihood likelihood(data, estimateNoise(data), fine, finer, toy::exact().likelihood);
    const auto residual = likelihood.residual(fine);
    REQUIRE(residual);
    CHECK(residual->allFinite());
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        CHECK(!std::isfinite(likelihood.errors(r).force.tail(1)[0]));
        CHECK(likelihood.errors(r).force.head(data.runs[r].force.size() - 1).allFinite());
    }
}

TEST_CASE("repeats average noise but not model error", "[diagnosis]") {
    const auto squares = [](std::size_t repeats, double white) { // of a wave in every run
        RecordedData data = toy::recordings(3);
        data.runs.resize(1);
        const toy::Spring model(data);
        const Response there = model.simulate(0, {{100.0, 0.1}, {}}, Fidelity::Fine, nullptr);
        for (Eigen::Index k = 0; k < there.force.size(); ++k)
            data.runs[0].force[k] = there.force[k] + 1e-3 * std::sin(2.0 * data.runs[0].time[k]);
        data.runs.resize(repeats, data.runs.front());
        CHECK(data.repeatsOf(0) == repeats);
        Noise noise;
        noise.white = white;
        noise.correlated = 0.0;
        noise.correlationTime = 0.25;
        const std::vector<Response> all(repeats, there);
        return Likelihood(data, noise, all, all, {}).residual(all)->squaredNorm();
    };
    // Noise of a hundredth of the model error (4e-4 of a peak of 1 N): chi-squared of one run and of four are equal,
    // except for noise, clock and zero of each run.
    CHECK(squares(4, 4e-6) == Approx(squares(1, 4e-6)).epsilon(0.05));
    // Noise of a hundred times the model error: a factor of four.
    CHECK(squares(4, 4e-2) == Approx(4.0 * squares(1, 4e-2)).epsilon(0.01));
}
