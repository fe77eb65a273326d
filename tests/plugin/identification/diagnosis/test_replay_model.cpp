#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/next_experiment/candidate_runs.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/experiment/natural_units.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

experiment::Experiment strip() {
    experiment::Experiment e;
    e.protocol = experiment::Protocol::ShellOnRigidCylinder;
    experiment::Specimen s;
    s.id = "A";
    s.length = 0.09;
    s.naturalCurvature = {50.0, 0.25};
    s.thickness = {5e-4, 1e-5};
    s.bendingModulus = {2e-4, 1.2e-5};
    s.linearMass = {5.7e-3, 1e-4};
    e.specimens = {s};
    e.friction = {0.3, 0.05};
    e.initialGapHalfWidth = 5e-5;
    experiment::Run run;
    run.file = "run_1.csv";
    run.driveTime = {0.0, 1.0, 11.0, 21.0};
    run.driveDisplacement = {0.0, 0.0, 0.02, 0.0};
    run.samplingRate = 20.0;
    e.runs = {run};
    return e;
}

} // namespace

TEST_CASE("internal and physical values correspond", "[diagnosis]") {
    for (const Scale scale : {Scale::Linear, Scale::Reciprocal, Scale::ReciprocalSquare, Scale::Logarithm})
        for (const double v : {0.02, 1.0, 350.0})
            CHECK(toPhysical(scale, toInternal(scale, v)) == Approx(v).epsilon(1e-14));
    CHECK(std::isinf(toPhysical(Scale::Reciprocal, 0.0)));
    CHECK(std::isinf(toPhysical(Scale::ReciprocalSquare, 0.0)));
}

TEST_CASE("every catalogue effect is a candidate and absent at zero amplitude", "[diagnosis]") {
    const experiment::Experiment e = strip();
    const CandidateEffects candidateEffects = candidateEffectsFor(e);
    std::set<std::string> labels;
    REQUIRE(candidateEffects.candidates.size() == candidateEffects.mappings.size());
    for (std::size_t i = 0; i < candidateEffects.candidates.size(); ++i) {
        const CandidateEffect& c = candidateEffects.candidates[i];
        if (c.learned) // no part of the catalogue
            continue;
        labels.insert(c.label);
        INFO(c.label << " " << c.variant);
        effects::Setting setting = candidateEffects.mappings[i].base;
        for (std::size_t k = 0; k < c.parameters.size(); ++k)
            setting.values[candidateEffects.mappings[i].parameterAt[k]] =
                toPhysical(c.parameters[k].scale, c.parameters[k].value);
        CHECK(effects::isOff(setting));
        CHECK_FALSE(c.probes.empty());
        for (const std::vector<double>& probe : c.probes) {
            REQUIRE(probe.size() == c.parameters.size());
            for (std::size_t k = 0; k < probe.size(); ++k) {
                CHECK(probe[k] >= c.parameters[k].lower);
                CHECK(probe[k] <= c.parameters[k].upper);
                setting.values[candidateEffects.mappings[i].parameterAt[k]] =
                    toPhysical(c.parameters[k].scale, probe[k]);
            }
            CHECK_FALSE(effects::isOff(setting));
            CHECK(effects::validate({setting}).empty());
        }
    }
    const auto candidate = std::find_if(candidateEffects.candidates.begin(), candidateEffects.candidates.end(),
                                        [](const CandidateEffect& c) { return c.label == "local_damage"; });
    REQUIRE(candidate->derived.size() == 1); // depth and width of a bell; its area is sqrt(2 pi)
    CHECK(candidate->parameters[candidate->derived[0].amplitude].name == "curvature_change_1_m");
    CHECK(candidate->parameters[candidate->derived[0].extent].name == "gauss_width_m");
    CHECK(candidate->derived[0].factor == Approx(2.5066282746));
    for (const effects::Effect& effect : effects::catalog())
        CHECK(labels.count(effect.name) == (replay::acts(e, effect.key) ? 1 : 0));
    CHECK(candidateEffectsFor(e, {"plasticity"}).candidates.size() < candidateEffects.candidates.size());
}

TEST_CASE("cached runs belong to an experiment, however its path is written", "[diagnosis]") {
    experiment::Experiment e = strip(), same = e, other = e;
    e.file = "experiments/a/experiment.json";
    same.file = (std::filesystem::current_path() / "experiments/b/../a/experiment.json").string();
    other.file = "experiments/b/experiment.json";
    CHECK(ReplayModel(e).identity() == ReplayModel(same).identity());
    CHECK(ReplayModel(e).identity() != ReplayModel(other).identity());
    same.text =
        R"({"markers": [{"arc_fraction": 0.4}]})"; // a corrected marker: the old tracks belong to another position
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
    same = e;
    same.runs[0].readings.time = {0.0, 0.05}; // filtered differently: equal row counts may differ
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
    same = e;
    same.runs[0].markers.time = {0.0, 0.1};
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
}

TEST_CASE("nominal parameters are those with stated intervals and an ordinary compliance", "[diagnosis]") {
    experiment::Experiment e = strip();
    const bool lengthwise = GENERATE(false, true); // then the compliance is at the contact
    if (lengthwise)
        e.protocol = experiment::Protocol::StripOnRigidFloor;
    const ReplayModel model(e);
    std::set<std::string> names;
    for (const Scalar& s : model.nominal()) {
        names.insert(s.name);
        CHECK(s.lower < s.upper);
        CHECK(s.step == Approx(0.5 * (s.upper - s.lower)));
    }
    CHECK(names == std::set<std::string>{"bending_modulus", "natural_curvature", "thickness", "linear_mass", "friction",
                                         "gap_shift", lengthwise ? "touch_compliance" : "series_compliance"});
}

TEST_CASE("a repeat shares its simulation", "[diagnosis]") {
    const auto loaded = experiment::load(SC_TEST_DATA "/recordings/baseline/case_101/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    e.runs.resize(1);
    e.runs.push_back(e.runs.front()); // a repeat
    e.runs.push_back(e.runs.front()); // another drive
    for (double& d : e.runs.back().driveDisplacement)
        d *= 0.9;
    e.runs[1].readings.force[5] += 1.0;
    const ReplayModel model(e);
    CHECK(model.replicateOf(0) == 0);
    CHECK(model.replicateOf(1) == 0);
    CHECK(model.replicateOf(2) == 2);
    SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), {}, cache);
    diagnosis::ParameterPoint stated;
    for (const Scalar& s : model.nominal())
        stated.nominal.push_back(s.value);
    const auto read = evaluator.simulateAllRuns({stated}, Fidelity::Coarse).front();
    CHECK(evaluator.distinctRequests() == 2);
    REQUIRE(read[0].failure.empty());
    CHECK(read[0].force == read[1].force);
    CHECK(read[0].force != read[2].force);
}

TEST_CASE("candidate runs start at rest with increasing time", "[diagnosis]") {
    const experiment::Experiment e = strip();
    const auto candidateRuns = candidateRunsFor(e);
    REQUIRE(candidateRuns.size() >= 4);
    for (std::size_t i = 0; i < candidateRuns.size(); ++i) {
        replay::Parameters parameters = replay::nominal(e);
        const experiment::Experiment one = withCandidateRun(e, i, parameters);
        REQUIRE(one.runs.size() == 1);
        const experiment::Run& run = one.runs.front();
        INFO(candidateRuns[i].description);
        CHECK(run.driveDisplacement.front() == 0.0);
        for (std::size_t k = 1; k < run.driveTime.size(); ++k)
            CHECK(run.driveTime[k] > run.driveTime[k - 1]);
    }
}

TEST_CASE("a run with a reversed specimen has its own simulation", "[diagnosis]") {
    experiment::Experiment e = strip();
    e.runs.push_back(e.runs.front());
    e.runs.back().specimenReversed = true;
    CHECK(ReplayModel(e).replicateOf(1) == 1);
    const RecordedData data = recordedDataOf(e);
    CHECK(data.firstOf(1) == 1);   // no repeat of the first
    CHECK(data.repeatsOf(0) == 2); // but with the same model error
    const auto candidateRuns = candidateRunsFor(e);
    const auto specimenReversed = std::find_if(candidateRuns.begin(), candidateRuns.end(),
                                               [](const CandidateRun& d) { return d.specimenReversed; });
    REQUIRE(specimenReversed != candidateRuns.end());
    CHECK(specimenReversed->description == "a run with the specimen mounted end for end");
    replay::Parameters parameters = replay::nominal(e);
    CHECK(withCandidateRun(e, static_cast<std::size_t>(specimenReversed - candidateRuns.begin()), parameters)
              .runs.front()
              .specimenReversed);
    CHECK(std::count_if(candidateRuns.begin(), candidateRuns.end(),
                        [](const CandidateRun& d) { return d.specimenReversed; }) == 1);
}

TEST_CASE("markers are proposed where there are none and kept where there are", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    const std::size_t recorded = e.markers.size();
    REQUIRE(recorded > 0);
    const auto filmed = [](const CandidateRun& d) { return !d.markers.empty(); };
    const auto stated = [](const Model& model) {
        diagnosis::ParameterPoint p;
        for (const Scalar& s : model.nominal())
            p.nominal.push_back(s.value);
        return p;
    };
    std::vector<CandidateRun> candidateRuns = candidateRunsFor(e);
    CHECK(std::none_of(candidateRuns.begin(), candidateRuns.end(), filmed));
    CHECK(std::all_of(candidateRuns.begin(), candidateRuns.end(),
                      [](const CandidateRun& d) { return d.markerRate > 0.0; }));
    const ReplayModel seen(e);
    const CandidateRunResponse read = seen.simulateCandidateRun(0, stated(seen), nullptr);
    REQUIRE(read.failure.empty());
    CHECK(read.markerTime.size() > 20);
    CHECK(read.markers.size() == 2 * static_cast<Eigen::Index>(recorded) * read.markerTime.size());

    e.markers.clear();
    for (experiment::Run& run : e.runs) {
        run.markers = {};
        run.markersFile.clear();
        run.markersSamplingRate = 0.0;
    }
    candidateRuns = candidateRunsFor(e);
    const auto camera = std::find_if(candidateRuns.begin(), candidateRuns.end(), filmed);
    REQUIRE(camera != candidateRuns.end());
    CHECK(camera->description == "a filmed run with 6 markers on the specimen");
    CHECK(std::count_if(candidateRuns.begin(), candidateRuns.end(),
                        [](const CandidateRun& d) { return d.markerRate > 0.0; }) == 1);
    const ReplayModel blind(e);
    const auto index = static_cast<std::size_t>(camera - candidateRuns.begin());
    const CandidateRunResponse frames = blind.simulateCandidateRun(index, stated(blind), nullptr);
    REQUIRE(frames.failure.empty());
    CHECK(frames.markers.size() == 12 * frames.markerTime.size());
    CHECK(blind.simulateCandidateRun(0, stated(blind), nullptr).markers.size() == 0);
}

TEST_CASE("no candidate run is faster or sampled more often than the recorded ones", "[diagnosis]") {
    const std::string name = GENERATE("case_101", "case_103");
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/" + name + "/experiment.json");
    REQUIRE(loaded);
    const auto fastest = [](const std::vector<double>& time, const std::vector<double>& displacement) {
        double most = 0.0;
        for (std::size_t i = 1; i < time.size(); ++i)
            most = std::max(most, std::abs(displacement[i] - displacement[i - 1]) / (time[i] - time[i - 1]));
        return most;
    };
    double recorded = 0.0, rate = 0.0;
    for (const experiment::Run& run : loaded->runs) {
        recorded = std::max(recorded, fastest(run.driveTime, run.driveDisplacement));
        rate = std::max(rate, run.samplingRate);
    }
    REQUIRE(recorded > 0.0);
    const std::vector<CandidateRun> candidateRuns = candidateRunsFor(*loaded);
    REQUIRE(candidateRuns.size() >= 6);
    for (const CandidateRun& d : candidateRuns) {
        INFO(d.description);
        CHECK(fastest(d.time, d.displacement) <= recorded * (1.0 + 1e-9)); // rounding of a quotient
        CHECK(d.rate <= rate);
        CHECK(d.rate * d.time.back() > 100.0); // readings
    }
}

TEST_CASE("a released specimen dwells before the next stroke", "[diagnosis]") {
    experiment::Experiment e = strip();
    const auto nominalRefreshes = [&] {
        std::vector<double> out; // at zero, between strokes
        for (const CandidateRun& d : candidateRunsFor(e))
            for (std::size_t i = 2; i + 1 < d.time.size(); ++i)
                if (d.displacement[i] == 0.0) {
                    const bool again = d.displacement[i + 1] == 0.0;
                    CHECK((again || d.displacement[i - 1] == 0.0));
                    if (again)
                        out.push_back(d.time[i + 1] - d.time[i]);
                }
        return out;
    };
    const std::vector<double> usual = nominalRefreshes();
    REQUIRE(usual.size() == 6); // of two cycles one, of six cycles five
    for (const double s : usual)
        CHECK(s == Approx(experiment::unitsOfSpecimens(e).time)); // a natural second
    experiment::Run& run = e.runs.front();                        // one stroke more, after three seconds
    const double end = run.driveTime.back(), last = run.driveDisplacement.back();
    REQUIRE(last == 0.0);
    for (const auto& [time, displacement] : {std::pair{3.0, 0.0}, {5.0, 0.005}, {7.0, 0.0}}) {
        run.driveTime.push_back(end + time);
        run.driveDisplacement.push_back(displacement);
    }
    const std::vector<double> longer = nominalRefreshes();
    REQUIRE(longer.size() == 6);
    for (const double s : longer)
        CHECK(s == Approx(3.0));
}

TEST_CASE("effects on readings match the sensor model", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json");
    REQUIRE(loaded);
    const experiment::Experiment& e = *loaded;
    const ReplayModel model(e);
    std::vector<double> stated;
    for (const Scalar& s : model.nominal())
        stated.push_back(s.value);
    const Response plain = model.simulate(0, {stated, {}}, Fidelity::Coarse, nullptr);
    INFO(plain.failure);
    REQUIRE(plain.failure.empty());
    const double peak = plain.force.cwiseAbs().maxCoeff();
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const CandidateEffect& candidate = model.candidates()[c];
        if (candidate.label != "sensor_drift" && candidate.label != "sensor_gain")
            continue;
        INFO(candidate.label << " " << candidate.variant);
        const diagnosis::ParameterPoint with{stated, {{c, candidate.probes.front()}}};
        CHECK(model.simulated(0, with).terms.empty());
        Response quick = plain;
        model.read(0, with, quick);
        const Response full = model.simulate(0, with, Fidelity::Coarse, nullptr);
        // The sensor samples more often; the drift is linear to a thousandth.
        CHECK((quick.force - full.force).cwiseAbs().maxCoeff() < 1e-3 * peak);
        CHECK((full.force - plain.force).cwiseAbs().maxCoeff() > 1e-2 * peak);
    }
}

TEST_CASE("a learned moment with zero coefficients is linear", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json");
    REQUIRE(loaded);
    const ReplayModel model(*loaded);
    std::vector<double> stated;
    for (const Scalar& s : model.nominal())
        stated.push_back(s.value);
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const CandidateEffect& candidate = model.candidates()[c];
        if (candidate.label != "learned_moment")
            continue;
        std::vector<double> zero(candidate.parameters.size(), 0.0), soft(candidate.parameters.size(), -0.2);
        // A secant modulus lower by a fifth equals a bending modulus lower by a fifth.
        diagnosis::ParameterPoint softer{stated, {}};
        REQUIRE(model.nominal().front().name == "bending_modulus");
        softer.nominal.front() *= 0.8;
        CHECK(model.candidates()[c].curve.evaluate(soft, {0.5}).front() == Approx(-0.2));
        const Response a = model.simulate(0, {stated, {{c, soft}}}, Fidelity::Coarse, nullptr);
        const Response b = model.simulate(0, softer, Fidelity::Coarse, nullptr);
        const Response linear = model.simulate(0, {stated, {{c, zero}}}, Fidelity::Coarse, nullptr);
        const Response plain = model.simulate(0, {stated, {}}, Fidelity::Coarse, nullptr);
        INFO(a.failure);
        REQUIRE(a.failure.empty());
        CHECK((linear.force - plain.force).norm() <= 1e-6 * plain.force.norm());
        CHECK((a.force - b.force).norm() <= 1e-2 * (b.force - plain.force).norm()); // the material's own step control
    }
}

TEST_CASE("the discretisation correction of an arch leaves a fifth of a small error", "[diagnosis]") {
    const auto e = experiment::load(std::string(SC_TEST_DATA) + "/recordings/training/case_12/experiment.json");
    REQUIRE(e);
    const ReplayModel model(*e);
    const RecordedData data = recordedDataOf(*e);
    constexpr std::size_t kRun = 2; // slow, loading and unloading
    diagnosis::ParameterPoint at;
    for (const Scalar& s : model.nominal())
        at.nominal.push_back(s.value);
    const std::atomic<bool>* const never = nullptr;
    const Response fine = model.simulate(kRun, at, Fidelity::Fine, never),
                   finer = model.simulate(kRun, at, Fidelity::Finer, never);
    REQUIRE(fine.failure.empty());
    REQUIRE(finer.failure.empty());
    const double peak = data.peakForce();
    const ModelError errors = modelErrorOf(data.runs[kRun], estimateNoise(data), fine, finer, peak, {});

    replay::Parameters p = replay::nominal(*e);
    for (std::size_t i = 0; i < at.nominal.size(); ++i)
        if (model.nominal()[i].name == "series_compliance")
            p.seriesCompliance = at.nominal[i];
    const auto force = [&](int elements) {
        replay::Resolution r = replay::Resolution::fine();
        r.elements = elements;
        const std::vector<double> f = replay::simulate(*e, kRun, p, r).readings.force;
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size())));
    };
    const Eigen::VectorXd many = force(121), some = force(31);
    const Eigen::VectorXd exact = many + (many - force(61)) / 7.0;
    std::vector<double> without, with, of31; // share of the peak
    for (Eigen::Index k = 0; k < exact.size(); ++k)
        if (std::abs(exact[k]) > 0.05 * peak) {
            without.push_back(std::abs(fine.force[k] - exact[k]) / peak);
            of31.push_back(std::abs(some[k] - exact[k]) / peak);
            with.push_back(std::abs(fine.force[k] + errors.correction[k] - exact[k]) / peak);
        }
    REQUIRE(with.size() > 1000);
    const auto most = [](std::vector<double>& v) {
        std::nth_element(v.begin(), v.begin() + static_cast<long>(9 * v.size() / 10), v.end());
        return v[9 * v.size() / 10];
    };
    INFO("90 % of the rows within " << most(without) << ", corrected " << most(with));
    CHECK(most(of31) < 2e-5);                               // arcs without their neighbours err by 7e-4
    CHECK(most(without) < 2e-5 * std::pow(31.0 / 21.0, 3)); // third order
    CHECK(most(with) < 4e-6);
    // Free ends and the points of contact have errors of other orders than clamps.
    CHECK(most(with) < 0.2 * most(without));
}

TEST_CASE("a replay of a stored fit draws the curve of the diagnosis", "[diagnosis]") {
    const auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/experiment.json");
    REQUIRE(loaded);
    const experiment::Experiment& e = *loaded;
    const ReplayModel model(e);
    Diagnosis d;
    d.improved = true;
    for (const char* label : {"plasticity", "sensor_drift", "machine_compliance"}) {
        const auto& all = model.candidates();
        const auto at =
            std::find_if(all.begin(), all.end(), [&](const CandidateEffect& c) { return c.label == label; });
        FittedEffect f;
        f.label = label;
        for (const Scalar& s : model.nominal())
            f.point.nominal.push_back(s.value + s.step / 7.0);
        f.point.terms = {{static_cast<std::size_t>(at - all.begin()), at->probes.front()}};
        d.effects.push_back(f);
    }
    d.baseline.nominal = d.effects[0].point.nominal;
    const StoredFits fits = storedFitsOf(model, e, d);
    REQUIRE(fits.fits.size() == 4);
    CHECK(fits.fits[0].drawn);
    CHECK(fits.fits[3].label == kNothing);
    for (std::size_t i = 0; i < 4; ++i) {
        INFO(fits.fits[i].label);
        const ParameterPoint& point = i < 3 ? d.effects[i].point : d.baseline;
        // As a fit is drawn: the simulation that it shares with others, then what acts on the reading alone.
        Response drawn = model.simulate(0, model.simulated(0, point), Fidelity::Fine, nullptr);
        model.read(0, point, drawn);
        replay::Parameters p = replay::nominal(e);
        REQUIRE(setTo(fits.fits[i], e, p).empty());
        const Response repeated = responseOf(e, 0, replay::simulate(e, 0, p, replay::Resolution::fine()));
        const double peak = drawn.force.cwiseAbs().maxCoeff();
        CHECK(peak > 0.01);
        CHECK((drawn.force - repeated.force).cwiseAbs().maxCoeff() <= 1e-12 * peak);
    }
}
