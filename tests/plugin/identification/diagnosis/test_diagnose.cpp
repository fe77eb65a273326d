#include "toy.h"

#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/result/verdict.h"
#include "supercircle/step/parallel.h"

#include <catch2/catch.hpp>
#include <filesystem>

using namespace supercircle::diagnosis;

namespace {

Diagnosis run(const RecordedData& data, const Model& model, std::uint64_t seed = 1, int threads = 1,
              const std::string& file = {}) {
    SimulationCache cache;
    if (!file.empty())
        REQUIRE(cache.open(file, model.identity()).empty());
    Evaluator evaluator(model, data.runs.size(), supercircle::step::threadLoop(threads), cache);
    return diagnose(data, evaluator, toy::exact(seed));
}

} // namespace

TEST_CASE("recordings without missing physics are adequate", "[diagnosis]") {
    const RecordedData data = toy::recordings(11);
    const toy::Spring spring(data);
    const Diagnosis d = run(data, spring);
    CHECK(d.verdict == "adequate");
    CHECK(d.adequate > 0.5);
    CHECK_FALSE(d.improved); // though effects were tried
    CHECK(d.improvedTraining == d.baselineTraining);
    CHECK(d.improvedHeldOut == d.baselineHeldOut);
    CHECK((d.improvement == 0.0 && d.improvementCi.low == 0.0 && d.improvementCi.high == 0.0));
    for (const RunCurves& run : d.runs)
        CHECK((run.improved.empty() && run.visibleIntervals.empty()));
    CHECK(d.baselineChiSquaredPerReading ==
          Approx(1.0).margin(0.15)); // 900 rows: 5 % sampling error, and uncertainty of the noise
}

TEST_CASE("without missing physics one diagnosis in twenty is significant, with estimated noise", "[diagnosis]") {
    // The dwell intervals contain about 24 correlation times of the slow noise, so its size is known to a quarter.
    int alarms = 0, fitted = 0;
    constexpr int kTrials = 30;
    for (int i = 0; i < kTrials; ++i) {
        const RecordedData data = toy::recordings(static_cast<std::uint64_t>(201 + i));
        const toy::Spring spring(data);
        const Diagnosis d = run(data, spring);
        alarms += d.misfit.p <= 0.05 ? 1 : 0;
        if (d.verdict == "adequate") { // a fitted effect is not shown
            fitted += d.effects.empty() ? 0 : 1;
            CHECK(d.improvedHeldOut == d.baselineHeldOut);
            CHECK((d.improvement == 0.0 && d.improvementCi.low == 0.0 && d.improvementCi.high == 0.0));
        }
    }
    CHECK(fitted > 0);
    CHECK(alarms <= 5); // binomial with 5 %: 1.5 +- 1.2; six or more in 0.3 % of all luck
}

namespace {

/// A spring on another solution branch, half a newton away, in a corner of the stated intervals.
class TwoSided final : public toy::Spring {
public:
    using Spring::Spring;

private:
    void alter(std::size_t, const ParameterPoint& p, Response& out) const override {
        const bool there = p.nominal[0] > 100.5 && p.nominal[1] < 0.095; // of 94 to 106, .05 to .15
        out.force = (there ? 1.0 : -1.0) * out.force;
    }
};

} // namespace

TEST_CASE("the baseline fit finds the recorded solution branch", "[diagnosis]") {
    for (const std::uint64_t seed : {21, 22, 23, 24}) {
        const RecordedData data = toy::recordings(seed); // 103 N/m, .08 N
        const Diagnosis known = run(data, toy::Spring(data)), d = run(data, TwoSided(data));
        INFO("seed " << seed << ": " << d.verdict << ": " << d.statement << " (one side: " << known.verdict << ")");
        // A left-out run may change the branch of its fold; the fit to all runs is checked.
        CHECK(d.misfit.p == Approx(known.misfit.p).margin(0.02)); // few draws
        CHECK(d.baselineChiSquaredPerReading == Approx(known.baselineChiSquaredPerReading).epsilon(0.01));
    }
}

TEST_CASE("a dashpot is identified with its constant", "[diagnosis]") {
    const RecordedData data = toy::recordings(12, "dashpot", 10.0);
    const toy::Spring spring(data);
    const Diagnosis d = run(data, spring);
    for (const FittedEffect& e : d.effects)
        UNSCOPED_INFO(e.label << " " << e.probability << " gain " << e.gain << " +- " << e.gainError << ", group of "
                              << e.confoundedWith.size());
    INFO(d.verdict << ": nothing " << d.adequate << ", unknown " << d.outsideCatalogue << ", p " << d.misfit.p);
    REQUIRE(d.verdict == "identified");
    const FittedEffect& e = d.effects.front();
    CHECK(e.label == "dashpot");
    CHECK(e.parameters.front().value == Approx(10.0).epsilon(0.15));
    CHECK(e.parameters.front().identifiedOnlyBy.empty()); // three speeds
    CHECK(d.improvedHeldOut < 1.15 * std::hypot(toy::kWhite, toy::kColoured));
    CHECK(d.misfit.p <= 0.05);
    CHECK(d.residualAfterBest.p > 0.01);
    // Visible intervals contain every row near which the mean change exceeds 0.7 sigma, and no row farther away than
    // the averaging window and closed gaps.
    std::size_t shown = 0;
    for (const RunCurves& c : d.runs) {
        std::vector<double> visible;
        for (std::size_t k = 0; k < c.time.size(); ++k) {
            double sum = 0.0, rows = 0.0;
            for (std::size_t j = 0; j < c.time.size(); ++j)
                if (std::abs(c.time[j] - c.time[k]) <= 0.125 + 1e-9) {
                    sum += (c.improved[j] - c.baseline[j]) / d.noise.total();
                    rows += 1.0;
                }
            if (std::abs(sum) < 0.7 * rows)
                continue;
            visible.push_back(c.time[k]);
            CHECK(std::any_of(c.visibleIntervals.begin(), c.visibleIntervals.end(),
                              [&](const TimeInterval& s) { return s.from <= c.time[k] && c.time[k] <= s.to; }));
        }
        shown += visible.size();
        for (const TimeInterval& s : c.visibleIntervals)
            for (double t = s.from; t <= s.to; t += 0.04)
                CHECK(std::any_of(visible.begin(), visible.end(),
                                  [&](double v) { return std::abs(v - t) < 0.125 + 0.3 + 0.04; }));
    }
    CHECK(shown > 20);
}

TEST_CASE("effects of one hypothesis do not compete", "[diagnosis]") {
    RecordedData data = toy::recordings(12, "dashpot", 80.0, 100.0);
    for (RecordedRun& run : data.runs) // outside the catalogue: pairs are tried
        run.force.array() += 0.03 * (9e3 * run.displacement.array()).sin();
    data.runs[0].force.array() += 1.5e-3 * data.runs[0].time.array(); // a drift that other runs do not know
    const Diagnosis d = run(data, toy::Spring(data));
    INFO(d.verdict << ": " << d.statement);
    REQUIRE(d.effects.size() > 1);
    CHECK(d.effects.front().label == "dashpot");
    CHECK(d.effects.front().confoundedWith == std::vector<std::string>{"dashpot"});
    // Much worse without the dashpot, so they are shown beside it; they are indistinguishable only together with it.
    CHECK(std::any_of(d.effects.begin(), d.effects.end(), [](const FittedEffect& e) { return !e.jointWith.empty(); }));
}

TEST_CASE("a parameter that one run alone identifies is reported as such", "[diagnosis]") {
    RecordedData data = toy::recordings(12);
    const toy::Spring spring(data);
    const auto& candidates = spring.candidates();
    const auto cubic =
        static_cast<std::size_t>(std::find_if(candidates.begin(), candidates.end(),
                                              [](const CandidateEffect& c) { return c.label == "cubic"; }) -
                                 candidates.begin());
    Random random(12);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        RecordedRun& run = data.runs[r];
        if (r > 0) // half a millimetre of ten: 0.04 mN of the cubic, noise 10 mN
            run.displacement *= 0.05;
        run.force =
            spring.simulate(r, ParameterPoint{{103.0, 0.08}, {Term{cubic, {3e5}}}}, Fidelity::Fine, nullptr).force;
        toy::addNoise(run, random);
    }
    const Diagnosis d = run(data, spring);
    INFO(d.verdict << ": " << d.statement);
    REQUIRE_FALSE(d.effects.empty());
    REQUIRE(d.effects.front().label == "cubic");
    CHECK(d.effects.front().parameters.front().identifiedOnlyBy == "slow");
    CHECK((d.verdict != "identified" || d.statement.find("slow alone identifies b") != std::string::npos));
    CHECK(d.verdict == "identified");
}

TEST_CASE("plasticity and nonlinear elasticity are indistinguishable without unloading", "[diagnosis]") {
    RecordedData data = toy::recordings(12);
    CHECK_FALSE(structurallyIndistinguishable(data, "plasticity", "nonlinear_elasticity")); // there is unloading
    for (RecordedRun& run : data.runs)
        for (DriveSegment& segment : run.segments)
            segment.phase = segment.phase == Phase::Unloading ? Phase::Hold : segment.phase;
    CHECK(structurallyIndistinguishable(data, "plasticity", "nonlinear_elasticity"));
    CHECK_FALSE(structurallyIndistinguishable(data, "plasticity", "wear"));
    CHECK_FALSE(structurallyIndistinguishable(data, "plasticity", "plasticity"));
}

TEST_CASE("an effect outside the catalogue is not identified as another one", "[diagnosis]") {
    const RecordedData data = toy::recordings(13, "dashpot", 60.0);
    const toy::Spring without(data, false);
    const Diagnosis d = run(data, without);
    CHECK(d.verdict == "outside_catalogue");
    CHECK(d.misfit.p <= 0.05);
}

TEST_CASE("a periodic disturbance is not counted as noise", "[diagnosis]") {
    // 20 mN with a period of 1.3 s, twice the noise, with dwell intervals of 1, 2 and 1 s.
    RecordedData data = toy::recordings(15);
    double phase = 0.3;
    for (RecordedRun& run : data.runs) {
        run.force.array() += 0.02 * (2.0 * M_PI / 1.3 * run.time.array() + phase).sin();
        phase += 2.0; // phase of each run
    }
    const Noise noise = estimateNoise(data);
    CHECK(noise.disturbancePeriod == Approx(1.3).epsilon(0.03));
    CHECK(noise.disturbance == Approx(0.02).epsilon(0.25)); // trends absorb part of 4 s of dwell
    CHECK(noise.total() == Approx(std::hypot(toy::kWhite, toy::kColoured)).epsilon(0.25));
    const toy::Spring spring(data);
    const Diagnosis d = run(data, spring);
    CHECK(d.verdict == "outside_catalogue");
    CHECK_THAT(d.statement, Catch::Contains("a period of 1.3"));
}

TEST_CASE("a periodic disturbance is not identified as an effect and does not hide a larger one", "[diagnosis]") {
    // A drift as large as the disturbance is detected.
    const auto swinging = [](RecordedData data) {
        double phase = 0.3;
        for (RecordedRun& run : data.runs) {
            run.force.array() += 0.02 * (2.0 * M_PI / 1.3 * run.time.array() + phase).sin();
            phase += 2.0;
        }
        return data;
    };
    const RecordedData alone = swinging(toy::recordings(15, "drift", 6e-4)),
                       beside = swinging(toy::recordings(15, "dashpot", 100.0));
    REQUIRE(estimateNoise(alone).disturbance > 0.015);
    REQUIRE(estimateNoise(beside).disturbance > 0.015);
    const Diagnosis weak = run(alone, toy::Spring(alone)), strong = run(beside, toy::Spring(beside));
    CHECK(weak.verdict == "outside_catalogue");
    CHECK(weak.outsideCatalogue > 0.9);
    REQUIRE_FALSE(strong.effects.empty());
    CHECK(strong.effects.front().label == "dashpot");
}

TEST_CASE("noise and relaxation are not periodic disturbances", "[diagnosis]") {
    for (std::uint64_t seed = 401; seed < 431; ++seed) {
        RecordedData data = toy::recordings(seed);
        if (seed % 2 == 0)
            for (RecordedRun& run : data.runs) // 30 sigma, within half a second or one after a stop
                for (const DriveSegment& segment : run.segments)
                    if (segment.phase == Phase::Hold)
                        for (Eigen::Index k = 0; k < run.time.size(); ++k)
                            if (run.time[k] >= segment.from && run.time[k] <= segment.to && segment.from > 0.0)
                                run.force[k] +=
                                    0.3 * std::exp(-(run.time[k] - segment.from) / (seed % 4 == 0 ? 0.5 : 1.0));
        CAPTURE(seed);
        CHECK(estimateNoise(data).disturbance == 0.0);
    }
}

TEST_CASE("a run that cannot be simulated is reported with the time", "[diagnosis]") {
    class Breaks final : public toy::Spring {
    public:
        using Spring::Spring;

    private:
        void alter(std::size_t r, const ParameterPoint&, Response& out) const override {
            out.failure = r == 1 ? "the wire broke (at t = 2 s)" : "";
        }
    };
    const RecordedData data = toy::recordings(11);
    CHECK(run(data, Breaks(data)).failure ==
          "fast cannot be simulated with the stated parameters: the wire broke (at t = 2 s)");
}

TEST_CASE("the zero of an untared load cell is not missing physics", "[diagnosis]") {
    RecordedData data = toy::recordings(11);
    double zero = 0.05; // N, five sigma of the noise; the peak is 1.1 N
    for (RecordedRun& run : data.runs) {
        run.force.array() += zero;
        zero = -zero;
    }
    const toy::Spring spring(data);
    const Diagnosis d = run(data, spring);
    INFO(d.statement);
    CHECK(d.verdict == "adequate");
    CHECK(d.baselineHeldOut == Approx(d.noise.total()).epsilon(0.15)); // nor a prediction error
    data.zeroWindow = 0.5;                                             // the same in tared readings
    CHECK(run(data, spring).misfit.p <= 0.05);
}

TEST_CASE("the zero of the force is free within what is stated, not within a share of the peak", "[diagnosis]") {
    const RecordedData data = toy::recordings(11);
    const toy::Spring spring(data);
    SimulationCache cache;
    Evaluator evaluator(spring, data.runs.size(), {}, cache);
    const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
    const Noise noise = estimateNoise(data);
    const auto zero = [&](double halfWidth, double window) {
        RecordedData other = data;
        other.zeroHalfWidth = halfWidth;
        other.zeroWindow = window;
        for (RecordedRun& run : other.runs)
            run.force *= 10.0; // the peak does not matter
        return Likelihood(other, noise, there, there).zeroStd(0);
    };
    CHECK(zero(0.0, 0.0) == Approx(5.0 * noise.total()));
    CHECK(zero(0.3, 0.0) == Approx(0.3 / std::sqrt(3.0))); // standard deviation of an interval
    const double mean = noise.stdOfMean(0.5, data.runs[0].spacing());
    CHECK(zero(0.0, 0.5) == Approx(mean));
    CHECK(zero(0.3, 0.5) == Approx(std::hypot(mean, 0.3 / std::sqrt(3.0))));
}

TEST_CASE("markers of free bodies have no arc fraction", "[diagnosis]") {
    class Follows final : public toy::Spring {
    public:
        using Spring::Spring;

    private:
        void alter(std::size_t r, const ParameterPoint&, Response& out) const override {
            out.markers = Eigen::VectorXd::Zero(r == 0 ? 2 * out.force.size() : 0);
        }
    };
    RecordedData data = toy::recordings(11);
    RecordedRun& slow = toy::withMarkers(data, {0.25});
    const Eigen::Index n = slow.time.size();
    Random random(5);
    for (Eigen::Index k = 0; k < 2 * n; ++k) // oscillations that are not simulated
        slow.markers[k] = 3e-5 * random.normal() + 2e-4 * std::sin(3.0 * slow.time[k % n]);
    for (const bool free : {false, true}) {
        data.free = free;
        const Diagnosis d = run(data, Follows(data));
        const auto place = free ? -1.0 : 0.25;
        int markers = 0;
        for (const ResidualWindow& w : d.misfit.significant)
            if (w.channel.rfind("m0", 0) == 0) {
                ++markers;
                CHECK(w.arcFraction == place);
            }
        CHECK(markers > 0);
        REQUIRE_FALSE(d.runs.front().markers.empty());
        CHECK(d.runs.front().markers.front().arcFraction == place);
    }
}

TEST_CASE("an effect with a significant signature but no significant window is marked where it is visible",
          "[diagnosis]") {
    std::size_t marked = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const RecordedData data = toy::recordings(seed, "dashpot", 3.0); // 15 mN in the fast run, noise 10 mN
        const Diagnosis d = run(data, toy::Spring(data));
        INFO("seed " << seed << ": " << d.verdict << ", p " << d.misfit.p);
        const std::vector<ResidualWindow>& all = d.misfit.significant;
        if (d.misfit.p > kFamilyWise) {
            CHECK(all.empty());
            continue;
        }
        if (!std::any_of(all.begin(), all.end(),
                         [](const ResidualWindow& w) { return w.kind == StatisticKind::Signature; }))
            continue;
        ++marked;
        std::size_t stretches = 0;
        for (const RunCurves& c : d.runs)
            for (const TimeInterval& s : c.visibleIntervals) {
                REQUIRE(stretches < all.size());
                const ResidualWindow& w = all[stretches++];
                CHECK((w.kind == StatisticKind::Signature && w.run == c.name && w.timeFrom == s.from &&
                       w.timeTo == s.to));
                CHECK(w.run == "fast");
                CHECK(w.displacementTo - w.displacementFrom > 0.008); // of 0.01 m, up or down
                CHECK(w.p == d.misfit.p);
                CHECK(w.z == d.misfit.largestSignature);
            }
        CHECK(stretches == all.size());
    }
    CHECK(marked > 0);
}

TEST_CASE("model weights and verdict agree", "[diagnosis]") {
    for (std::uint64_t seed = 40; seed < 52; ++seed) {
        // From no effect to one that is just detectable.
        const RecordedData data = toy::recordings(seed, "dashpot", 0.4 * static_cast<double>(seed - 40));
        const toy::Spring spring(data);
        const Diagnosis d = run(data, spring);
        INFO(d.verdict << ": nothing " << d.adequate << ", unknown " << d.outsideCatalogue << ", p " << d.misfit.p);
        const double baseline = d.adequate + d.undetectable(); // detectable effects
        CHECK((baseline >= 0.5 || d.misfit.p > 0.05) == (d.verdict == "adequate" || d.verdict == "inconclusive"));
        // No hypothesis gains more than the family-wise bound allows; a catalogue of three gives each a fifth.
        CHECK((d.misfit.p > 0.3 ? baseline >= 0.29 : true));
        double sum = baseline + d.outsideCatalogue;
        for (const FittedEffect& e : d.effects)
            sum += e.probability;
        CHECK(sum == Approx(1.0).epsilon(1e-9)); // no pairs here
    }
}

TEST_CASE("a law outside the catalogue is learned and described", "[diagnosis]") {
    const RecordedData data =
        toy::recordings(18, "cubic", 6e5); // 0.6 N at the end, with the stiffness at its bound less
    const toy::Spring spring(data, true, true);
    const Diagnosis d = run(data, spring);
    INFO(d.statement);
    CHECK(d.verdict == "outside_catalogue");
    REQUIRE_FALSE(d.learned.empty());
    const LearnedLaw& law = d.learned.front();
    CHECK(law.probability > 0.5);
    // Compared with the linear part, which the stiffness absorbs: the second difference over the covered range.
    const double stiffness = d.nominal.front().fitted;
    INFO(law.description << "; stiffness " << stiffness);
    const double bend = law.value[36] - 2.0 * law.value[20] + law.value[4];
    const auto cubic = [&](int i) { return 6e5 * std::pow(law.states[static_cast<std::size_t>(i)], 3.0); };
    CHECK(bend == Approx(cubic(36) - 2.0 * cubic(20) + cubic(4)).epsilon(0.1));
    CHECK(law.description.find("added force") == 0);
}

TEST_CASE("scatter between repeats is measured and used", "[diagnosis]") {
    RecordedData data = toy::recordings(19);
    data.runs[1] = toy::motion("again", 1e-3, 25.0);
    data.runs[1].force = data.runs[0].force;
    Random random(7);
    toy::addNoise(data.runs[1], random);
    CHECK(estimateNoise(data).repeats == 1);
    CHECK(estimateNoise(data).runToRun < 0.01);
    for (Eigen::Index k = 0; k < data.runs[1].force.size(); ++k)
        data.runs[1].force[k] += 0.08 * std::sin(0.9 * data.runs[1].time[k]); // half the variance: 0.04 rms
    CHECK(estimateNoise(data).runToRun == Approx(0.04).epsilon(0.35));        // a sine is not normally distributed
}

TEST_CASE("a diagnosis is bitwise identical for any number of threads and after an interruption", "[diagnosis]") {
    const RecordedData data = toy::recordings(16, "drift", 4e-3);
    const toy::Spring spring(data);
    const std::string file = std::string(SC_BINARY_DIR) + "/toy_runs.cache";
    std::filesystem::remove(file);
    const Diagnosis one = run(data, spring, 5, 1, file), three = run(data, spring, 5, 3);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2 - 3); // interrupted during a write
    const Diagnosis again = run(data, spring, 5, 2, file);
    for (const Diagnosis* other : {&three, &again}) {
        CHECK(one.verdict == other->verdict);
        CHECK(one.statement == other->statement);
        CHECK(one.misfit.p == other->misfit.p);
        CHECK(one.forwardRuns == other->forwardRuns);
        REQUIRE(one.effects.size() == other->effects.size());
        for (std::size_t i = 0; i < one.effects.size(); ++i) {
            CHECK(one.effects[i].probability == other->effects[i].probability);
            CHECK(one.effects[i].parameters.front().value == other->effects[i].parameters.front().value);
        }
    }
}

TEST_CASE("90 % intervals cover the truth nine times in ten", "[diagnosis][slow]") {
    int covered = 0;
    constexpr int kTrials = 150;
    for (int i = 0; i < kTrials; ++i) {
        const RecordedData data = toy::recordings(static_cast<std::uint64_t>(500 + i), "dashpot", 10.0);
        const toy::Spring spring(data);
        for (const FittedEffect& e : run(data, spring).effects)
            if (e.label == "dashpot") {
                const Interval& ci = e.parameters.front().ci90;
                covered += ci.low <= 10.0 && 10.0 <= ci.high ? 1 : 0;
            }
    }
    // 135 +- 3.7; the estimated noise adds as much again.
    CHECK(covered >= 120);
    CHECK(covered <= 148);
}

namespace {

/// The toy with a drift limited to `most`.
class ModestDrift final : public toy::Spring {
public:
    ModestDrift(const RecordedData& data, double most) : Spring(data), candidates_(Spring::candidates()) {
        for (CandidateEffect& c : candidates_)
            if (c.label == "drift") {
                c.parameters.front().lower = -most;
                c.parameters.front().upper = most;
            }
    }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }

private:
    std::vector<CandidateEffect> candidates_;
};

} // namespace

TEST_CASE("an effect with an implausible amplitude is not identified", "[diagnosis]") {
    constexpr double kDrift = 8e-3;
    const RecordedData data = toy::recordings(21, "drift", kDrift);
    const ModestDrift wide(data, 1.0), tight(data, 0.97 * kDrift), narrow(data, 0.8 * kDrift);
    const Diagnosis free = run(data, wide), pressed = run(data, narrow);
    REQUIRE(free.verdict == "identified");
    CHECK(free.effects.front().label == "drift");
    CHECK(free.effects.front().atBound.empty());
    CHECK(pressed.verdict == "outside_catalogue");
    CHECK(pressed.outsideCatalogue > 0.5);
    REQUIRE(pressed.effects.front().label == "drift");
    CHECK(pressed.effects.front().atBound == std::vector<std::string>{"a"});
    CHECK(pressed.effects.front().parameters.front().value == Approx(0.8 * kDrift));
    CHECK(pressed.statement.find("implausibly large amplitude (a beyond 0.0064 N/s)") != std::string::npos);
    // A bound within the uncertainty of the fit does not reject it.
    const FittedParameter& a = free.effects.front().parameters.front();
    REQUIRE((a.ci90.high - a.ci90.low) / 3.3 > std::max(0.0, a.value - 0.97 * kDrift) / 3.0);
    const Diagnosis touching = run(data, tight);
    CHECK(touching.verdict == "identified");
    CHECK(touching.effects.front().atBound.empty());
}
