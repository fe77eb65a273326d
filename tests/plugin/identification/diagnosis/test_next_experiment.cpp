// Choice of the next experiment, on models whose readings are sines and straight lines.

#include "plugin/identification/diagnosis/model/decompositions.h"
#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/identification/diagnosis/next_experiment/run_likelihood.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace supercircle::diagnosis;

namespace {

/// A model with candidate runs only.
class Designs : public Model {
public:
    Designs(std::vector<CandidateRun> candidateRuns, std::vector<CandidateEffect> candidates)
        : designs_(std::move(candidateRuns)), candidates_(std::move(candidates)) {}
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }
    [[nodiscard]] std::string identity() const override { return "designs"; }
    [[nodiscard]] Response simulate(std::size_t, const ParameterPoint&, Fidelity,
                                    const std::atomic<bool>*) const override {
        return {};
    }
    [[nodiscard]] std::vector<CandidateRun> candidateRuns() const override { return designs_; }

protected:
    /// An effect of one linear amplitude.
    static CandidateEffect effect(const std::string& label, const std::string& unit, double lower, double upper,
                                  double step) {
        return {label, "", "", "", {{"a", unit, "", 0.0, lower, upper, step, Scale::Linear, true}}, {{step}}};
    }

private:
    std::vector<CandidateRun> designs_;
    std::vector<Scalar> nominal_ = {{"slope", "N/s", "", 0.0, -50.0, 50.0, 50.0, Scale::Linear, false}};
    std::vector<CandidateEffect> candidates_;
};

/// Two candidate runs and two effects beside a straight line, 200 readings in ten seconds.
class Pairs : public Designs {
public:
    /// Response to one newton of an effect in a candidate run.
    using Shape =
        std::function<Eigen::ArrayXd(std::size_t candidateRun, std::size_t effect, const Eigen::ArrayXd& time)>;
    Pairs(const char* oneRun, const char* otherRun, const char* oneEffect, const char* otherEffect, Shape shape)
        : Designs({{oneRun, 0}, {otherRun, 0}},
                  {effect(oneEffect, "N", -9.0, 9.0, 1.0), effect(otherEffect, "N", -9.0, 9.0, 1.0)}),
          shape_(std::move(shape)) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t i, const ParameterPoint& p,
                                                            const std::atomic<bool>*) const override {
        CandidateRunResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = p.nominal[0] * out.time;
        for (const Term& t : p.terms)
            out.force += t.values[0] * shape_(i, t.candidate, out.time.array()).matrix();
        return out;
    }

private:
    Shape shape_;
};

/// In the first candidate run an effect is large and resembles the nominal parameter; in the second it resembles
/// nothing else. The other effect has no influence.
class TwoDesigns final : public Pairs {
public:
    TwoDesigns()
        : Pairs("alike", "apart", "swing", "other",
                [](std::size_t candidateRun, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    if (effect == 1)
                        return 0.0 * time;
                    return candidateRun == 0 ? Eigen::ArrayXd(10.0 * time) : Eigen::ArrayXd(time.sin());
                }) {}
};

/// The second of them alone.
class OneDesign final : public Designs {
public:
    OneDesign() : Designs({{"apart", 0}}, {effect("swing", "N", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t, const ParameterPoint& p,
                                                            const std::atomic<bool>* i) const override {
        return TwoDesigns().simulateCandidateRun(1, p, i);
    }
};

/// Each effect is visible in one candidate run, as a sine.
class EachItsOwn final : public Pairs {
public:
    EachItsOwn()
        : Pairs("left", "right", "first", "second",
                [](std::size_t candidateRun, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    return (candidateRun == effect ? 1.0 : 0.0) * (2.0 * time).sin();
                }) {}
};

/// The first effect is visible in both candidate runs, the second in the second one only.
class TwoSuspects final : public Pairs {
public:
    TwoSuspects()
        : Pairs("one", "both", "first", "second",
                [](std::size_t candidateRun, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    return (effect == 1 && candidateRun == 0 ? 0.0 : 1.0) * ((effect == 0 ? 2.0 : 3.0) * time).sin();
                }) {}
};

/// A sensor with a possible delay, in a run sampled twenty times a second and in the same run sampled four hundred
/// times.
class TwoRates final : public Designs {
public:
    TwoRates() : Designs({{"slow", 0}, {"quick", 0}}, {effect("late", "s", 0.0, 1.0, 0.01)}) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t i, const ParameterPoint& p,
                                                            const std::atomic<bool>*) const override {
        CandidateRunResponse out;
        out.time = Eigen::VectorXd::LinSpaced(i == 0 ? 200 : 4000, 0.0, 10.0);
        const double late = p.terms.empty() ? 0.0 : p.terms.front().values[0];
        out.force = 30.0 * (out.time.array() - late).sin().matrix();
        return out;
    }
};

/// Two effects invisible in the force, and one marker that moves by 0.1 mm for the first: filmed in the second
/// candidate run only.
class TwoCameras final : public Designs {
public:
    TwoCameras()
        : Designs({{"blind", 0, {0.0, 5.0, 10.0}, {0.0, 0.01, 0.0}}, {"filmed", 0, {0.0, 5.0, 10.0}, {0.0, 0.01, 0.0}}},
                  {effect("first", "1", -9.0, 9.0, 1.0), effect("second", "1", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t i, const ParameterPoint& p,
                                                            const std::atomic<bool>*) const override {
        CandidateRunResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = p.nominal[0] * out.time;
        if (i == 0)
            return out;
        out.markerTime = Eigen::VectorXd::LinSpaced(40, 0.0, 10.0);
        out.markers = Eigen::VectorXd::Zero(80);
        if (!p.terms.empty() && p.terms.front().candidate == 0)
            // A shape orthogonal to shifts of loading and of unloading.
            out.markers.head(40) = 1e-4 * p.terms.front().values[0] * (3.0 * out.markerTime.array()).sin();
        return out;
    }
};

/// Two sines with a delay each, and in the second candidate run an oscillation of the first only.
class TwoPhases final : public Designs {
public:
    TwoPhases()
        : Designs({{"phase", 0}, {"swing", 0}},
                  {effect("one", "s", 0.0, 3.0, 1.0), effect("other", "s", 0.0, 3.0, 1.0)}) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t i, const ParameterPoint& p,
                                                            const std::atomic<bool>*) const override {
        CandidateRunResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = (out.time.array() - p.terms.front().values[0]).sin().matrix();
        if (i == 1 && p.terms.front().candidate == 0)
            out.force += (5.0 * out.time.array()).sin().matrix();
        return out;
    }
};

/// A floor with an immediate force, 1 N at 2 mm, met 50 um later by the second effect.
class TwoTouches final : public Designs {
public:
    TwoTouches()
        : Designs({{"press", 0, {0.0, 10.0}, {0.0, 0.01}}},
                  {effect("high", "1", -9.0, 9.0, 1.0), effect("low", "1", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t, const ParameterPoint& p,
                                                            const std::atomic<bool>*) const override {
        CandidateRunResponse out;
        out.time = Eigen::VectorXd::LinSpaced(400, 0.0, 10.0);
        const double touch = p.terms.front().candidate == 0 ? 2.0 : 2.05;
        out.force = (out.time.array() >= touch).select(1.0 + 0.1 * out.time.array(), 0.0);
        return out;
    }
};

Noise quiet() {
    Noise noise;
    noise.white = 0.1;
    noise.correlated = 0.0;
    noise.correlationTime = 0.25;
    return noise;
}

/// The first effect, the second, or the baseline, with known parameters.
std::vector<CompetingHypothesis> known(const Model& model, double size, double first, double second) {
    std::vector<CompetingHypothesis> competing = {{"first", {{0.0}, {{0, {size}}}}, {}, {}, first},
                                                  {"second", {{0.0}, {{1, {size}}}}, {}, {}, second},
                                                  {"nothing", {{0.0}, {}}, {}, {}, 0.0}};
    for (CompetingHypothesis& r : competing) {
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = 1e-6 * Eigen::MatrixXd::Identity(r.x.size(), r.x.size());
    }
    return competing;
}

} // namespace

TEST_CASE("a further run discriminates all hypotheses, not only the most probable", "[diagnosis]") {
    const TwoSuspects model;
    // A sine of .08 N in 200 readings of .1 N: eight sigma.
    std::vector<CompetingHypothesis> competing = known(model, 0.08, 0.6, 0.4);
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    const auto next = nextExperiment(evaluator, competing, quiet(), 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "both");
    CHECK(next->runs.front().repeats == 1);
    CHECK(next->discriminates == std::vector<std::string>{"first", "second", "nothing"});
    CHECK(next->power > 0.99);
    // The most probable one alone would need the first run only.
    const auto narrow = nextExperiment(evaluator, {competing[0], competing[2]}, quiet(), 0.0);
    REQUIRE(narrow);
    CHECK(narrow->runs.front().candidateRun.description == "one");
    // A hypothesis that contains the true one cannot be rejected and is ignored.
    competing[1].point.terms.push_back({0, {0.05}}); // "second" beside the first
    competing[1].x = Variables(model, competing[1].point).of(competing[1].point);
    competing[1].covariance = 1e-6 * Eigen::MatrixXd::Identity(competing[1].x.size(), competing[1].x.size());
    const auto nested = nextExperiment(evaluator, competing, quiet(), 0.0);
    REQUIRE(nested);
    CHECK(nested->runs.front().candidateRun.description == "both");
    CHECK(nested->power > 0.99);
    CHECK_FALSE(nextExperiment(evaluator, {competing[0]}, quiet(), 0.0));
}

TEST_CASE("the clock error of a further run is taken into account", "[diagnosis]") {
    // 5 ms in 200 readings on slopes of 30 N/s are 15 sigma of 0.1 N and a tenth of a row, the accuracy of a clock; in
    // rows of 2.5 ms they are two.
    const TwoRates model;
    const Noise noise = quiet();
    CompetingHypothesis late{"late", {{0.0}, {{0, {0.005}}}}, {}, {}}, nothing{"nothing", {{0.0}, {}}, {}, {}};
    for (CompetingHypothesis* r : {&late, &nothing}) {
        r->x = Variables(model, r->point).of(r->point);
        r->covariance = 1e-8 * Eigen::MatrixXd::Identity(r->x.size(), r->x.size());
    }
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    const auto next = nextExperiment(evaluator, {late, nothing}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "quick");
    CHECK(next->power > 0.99);
}

TEST_CASE("a weak difference is resolved by repeats", "[diagnosis]") {
    const OneDesign model;
    const Noise noise = quiet();
    constexpr double kSize = 0.025; // N
    /// Between an oscillation and the baseline, with uncertain slope.
    /// @param known of the oscillation, N
    const auto asked = [&](const Model& of, double slope, double known) {
        CompetingHypothesis disturbance{"swing", {{0.0}, {{0, {kSize}}}}, {}, {}},
            nothing{"nothing", {{0.0}, {}}, {}, {}};
        for (CompetingHypothesis* r : {&disturbance, &nothing}) {
            r->x = Variables(of, r->point).of(r->point);
            r->covariance = Eigen::MatrixXd::Identity(r->x.size(), r->x.size()) * known * known;
            r->covariance(0, 0) = slope * slope; // its uncertainty, in steps
        }
        SimulationCache cache;
        Evaluator evaluator(of, 1, {}, cache);
        return nextExperiment(evaluator, {disturbance, nothing}, noise, 0.0);
    };
    // A sine in 200 readings without constant and slope; n runs improve it by sqrt(n).
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0), sine = time.array().sin();
    Eigen::MatrixXd taken(200, 2);
    taken << Eigen::VectorXd::Ones(200), time;
    const double one = (sine - taken * supercircle::dense::leastSquares(taken, sine)).norm() * kSize / 0.1;
    REQUIRE(one > 2.0);
    REQUIRE(one < 2.5);
    const auto several = asked(model, 1.0, 1e-6);
    REQUIRE(several);
    REQUIRE(several->runs.size() == 1);
    CHECK(several->runs[0].candidateRun.description == "apart");
    CHECK(several->runs[0].repeats == static_cast<std::size_t>(std::ceil(std::pow(5.0 / one, 2))));
    CHECK(describeNext(*several) == "apart, made " + std::to_string(several->runs[0].repeats) + " times");
    // An oscillation known to an eighth may be smaller: more runs, and a power below one.
    const auto more = asked(model, 1.0, kSize / 8.0);
    REQUIRE(more);
    CHECK(more->runs[0].repeats > several->runs[0].repeats);
    const double d = std::sqrt(static_cast<double>(more->runs[0].repeats)) * one;
    const double power = 0.5 * std::erfc(-(d - 1.645) / std::hypot(1.0, d / 8.0) / std::sqrt(2.0));
    CHECK(more->power == Approx(power).margin(0.005)); // clock, scale and contact positions absorb little
    // Another candidate run shows the oscillation ten times as large: one run of it suffices if the slope is known.
    const TwoDesigns two;
    const auto large = asked(two, 1e-6, 1e-6);
    REQUIRE(large);
    CHECK(describeNext(*large) == "alike");
    // With an uncertain slope the oscillation there resembles a slope of 0.25 N/s. The run without it determines the
    // slope to 0.0025 N/s, so one of each replaces six.
    const auto both = asked(two, 1.0, 1e-6);
    REQUIRE(both);
    CHECK(describeNext(*both) == "alike, and apart");
    CHECK(both->expectedConclusive);
}

TEST_CASE("two kinds of runs are proposed where one is not enough", "[diagnosis]") {
    const EachItsOwn model;
    const auto asked = [&](double size) { // N, equal for the other effect
        SimulationCache cache;
        Evaluator evaluator(model, 1, {}, cache);
        return nextExperiment(evaluator, known(model, size, 0.5, 0.5), quiet(), 0.0);
    };
    // A sine of .08 N in 200 readings of .1 N: eight sigma, where it shows.
    const auto once = asked(0.08);
    REQUIRE(once);
    CHECK(describeNext(*once) == "left, and right");
    CHECK(once->expectedConclusive);
    CHECK(once->power > 0.99);
    // A third of it: 2.5 sigma each, so five sigma need four runs each, and weaker effects more than eight.
    const auto often = asked(0.0275);
    REQUIRE(often);
    CHECK(describeNext(*often) == "left, made 4 times, and right, made 4 times");
    const auto weak = asked(0.016);
    REQUIRE(weak);
    CHECK_FALSE(weak->expectedConclusive);
    CHECK(weak->runs.size() == 2);
    CHECK_THAT(describeNext(*weak), Catch::Contains("they may be inconclusive"));
}

TEST_CASE("refitting is taken into account for a further run", "[diagnosis]") {
    const TwoDesigns model;
    const Noise noise = quiet();
    const auto competitor = [&](const std::string& label, std::size_t candidate, double slope) {
        CompetingHypothesis r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(slope * slope, 1e-4).asDiagonal(); // of the slope in its steps, of the amplitude
        return r;
    };
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    // With an uncertain slope the large difference of the first run is absorbed.
    auto next = nextExperiment(evaluator, {competitor("swing", 0, 0.5), competitor("other", 1, 0.5)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "apart");
    CHECK(next->power > 0.99); // a sine of 1 N, noise .1 N, 200 readings
    // With a known slope the first candidate run suffices.
    next = nextExperiment(evaluator, {competitor("swing", 0, 1e-6), competitor("other", 1, 1e-6)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "alike");
    // An interruption returns none, quickly.
    const std::atomic<bool> stop{true};
    Evaluator stopped(model, 1, {}, cache, &stop);
    CHECK_FALSE(nextExperiment(stopped, {competitor("swing", 0, 0.5), competitor("other", 1, 0.5)}, noise, 0.0));
}

TEST_CASE("a filmed run resolves what the force does not", "[diagnosis]") {
    const TwoCameras model;
    const auto competitor = [&](const std::string& label, std::size_t candidate) {
        CompetingHypothesis r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(0.25, 1e-4).asDiagonal();
        return r;
    };
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    Noise noise = quiet();
    noise.marker = 3e-5;
    const auto next = nextExperiment(evaluator, {competitor("first", 0), competitor("second", 1)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "filmed");
    // A sine of 0.1 mm in 40 frames, 30 um noise and 15 um model error: 13 sigma.
    CHECK(next->runs.front().repeats == 1);
    CHECK(next->power > 0.99);
    // The same for an ambiguous sign: the mirror image is a hypothesis of its own.
    CompetingHypothesis here = competitor("first", 0), there = competitor("first", 0);
    CHECK_FALSE(nextExperiment(evaluator, {here, there}, noise, 0.0)); // twice the same
    there.point.terms[0].values[0] = -1.0;
    there.x = Variables(model, there.point).of(there.point);
    there.mirrorImage = true;
    const auto side = nextExperiment(evaluator, {here, there}, noise, 0.0);
    REQUIRE(side);
    CHECK(side->runs.front().candidateRun.description == "filmed");
    CHECK(side->power > 0.99);
    CHECK(side->resolvesSign);
    CHECK(side->discriminates == std::vector<std::string>{"first"});
    CHECK_FALSE(next->resolvesSign);
    noise.marker = 3e-3; // a poor camera
    const auto poor = nextExperiment(evaluator, {competitor("first", 0), competitor("second", 1)}, noise, 0.0);
    CHECK((!poor || poor->power < 0.5));
}

TEST_CASE("refits are simulated where derivatives mislead", "[diagnosis]") {
    // Sines a radian apart: moved by its derivative one stays half a newton away (1 - cos 1, noise 0.1 N); moved along
    // the circle it equals the other.
    const TwoPhases model;
    const auto competitor = [&](const std::string& label, std::size_t candidate, double late) {
        CompetingHypothesis r{label, {{0.0}, {{candidate, {late}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(1e-6, 1.0).asDiagonal(); // of the slope and of the delay
        return r;
    };
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    const auto next = nextExperiment(evaluator, {competitor("one", 0, 0.5), competitor("other", 1, 1.5)}, quiet(), 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().candidateRun.description == "swing");
    CHECK(next->expectedConclusive);
    // Derivatives lead beyond the bound (3 s); the refit continues inside.
    const auto bounded =
        nextExperiment(evaluator, {competitor("one", 0, 2.9), competitor("other", 1, 1.9)}, quiet(), 0.0);
    REQUIRE(bounded);
    CHECK(bounded->runs.front().candidateRun.description == "swing");
}

TEST_CASE("a snap in one simulation only counts by the readings after it", "[diagnosis]") {
    const CandidateRun press{"press", 0, {0.0, 10.0}, {0.0, 0.01}};
    CandidateRunResponse smooth;
    smooth.time = Eigen::VectorXd::LinSpaced(401, 0.0, 10.0);
    smooth.force = 0.1 * smooth.time;
    CandidateRunResponse snaps = smooth; // loading and unloading within the excluded interval of a snap
    for (Eigen::Index k = 0; k < snaps.time.size(); ++k)
        snaps.force[k] += snaps.time[k] >= 5.0 && snaps.time[k] < 5.2 ? 1.0 : 0.0;
    const RunLikelihood likelihood(press, snaps, quiet(), 0.0, 1);
    const auto apart = likelihood.difference(snaps, smooth);
    REQUIRE(apart);
    CHECK(apart->norm() < 1.0);
    smooth.force.array() += (smooth.time.array() >= 5.0).select(Eigen::ArrayXd::Constant(401, 1.0), 0.0); // stays
    const auto stays = likelihood.difference(snaps, smooth);
    REQUIRE(stays);
    CHECK(stays->norm() > 5.0);
    smooth.force.conservativeResize(100);
    CHECK_FALSE(likelihood.difference(snaps, smooth));
}

TEST_CASE("excluded rows do not count for a further run", "[diagnosis]") {
    // Two readings of 11 sigma. The position of a contact is known to a share of the travel only, and readings beside
    // it are excluded.
    const TwoTouches model;
    const auto competitor = [&](const std::string& label, std::size_t candidate) {
        CompetingHypothesis r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = 1e-6 * Eigen::MatrixXd::Identity(2, 2);
        return r;
    };
    SimulationCache cache;
    Evaluator evaluator(model, 1, {}, cache);
    const auto next = nextExperiment(evaluator, {competitor("high", 0), competitor("low", 1)}, quiet(), 0.0);
    CHECK((!next || !next->expectedConclusive));
    if (next)
        CHECK(describeNext(*next).find("may be inconclusive") != std::string::npos);
}
