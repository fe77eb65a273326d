#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/misfit.h"
#include "plugin/identification/diagnosis/next_experiment/designs.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/load.h"

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

TEST_CASE("inner and outer numbers of a fit belong together", "[diagnosis]") {
    for (const Scale scale : {Scale::Linear, Scale::Reciprocal, Scale::ReciprocalSquare, Scale::Logarithm})
        for (const double v : {0.02, 1.0, 350.0})
            CHECK(outer(scale, inner(scale, v)) == Approx(v).epsilon(1e-14));
    CHECK(std::isinf(outer(Scale::Reciprocal, 0.0)));
    CHECK(std::isinf(outer(Scale::ReciprocalSquare, 0.0)));
}

TEST_CASE("every effect of the catalogue is a candidate, absent where its amplitudes are", "[diagnosis]") {
    const experiment::Experiment e = strip();
    const Menu menu = menuFor(e);
    std::set<std::string> labels;
    REQUIRE(menu.candidates.size() == menu.recipes.size());
    for (std::size_t i = 0; i < menu.candidates.size(); ++i) {
        const Candidate& c = menu.candidates[i];
        if (c.learned) // no part of the catalogue
            continue;
        labels.insert(c.label);
        INFO(c.label << " " << c.form);
        effects::Setting setting = menu.recipes[i].base;
        for (std::size_t k = 0; k < c.parameters.size(); ++k)
            setting.values[menu.recipes[i].parameterAt[k]] = outer(c.parameters[k].scale, c.parameters[k].value);
        CHECK(effects::isOff(setting));
        CHECK_FALSE(c.probes.empty());
        for (const std::vector<double>& probe : c.probes) {
            REQUIRE(probe.size() == c.parameters.size());
            for (std::size_t k = 0; k < probe.size(); ++k) {
                CHECK(probe[k] >= c.parameters[k].lower);
                CHECK(probe[k] <= c.parameters[k].upper);
                setting.values[menu.recipes[i].parameterAt[k]] = outer(c.parameters[k].scale, probe[k]);
            }
            CHECK_FALSE(effects::isOff(setting));
            CHECK(effects::validate({setting}).empty());
        }
    }
    const auto candidate = std::find_if(menu.candidates.begin(), menu.candidates.end(),
                                        [](const Candidate& c) { return c.label == "local_damage"; });
    REQUIRE(candidate->products.size() == 1); // depth and width of a bell; its area is sqrt(2 pi)
    CHECK(candidate->parameters[candidate->products[0].amplitude].name == "curvature_change_1_m");
    CHECK(candidate->parameters[candidate->products[0].extent].name == "gauss_width_m");
    CHECK(candidate->products[0].factor == Approx(2.5066282746));
    for (const effects::Effect& effect : effects::catalog())
        CHECK(labels.count(effect.name) == (replay::acts(e, effect.key) ? 1 : 0));
    CHECK(menuFor(e, {"plasticity"}).candidates.size() < menu.candidates.size());
}

TEST_CASE("kept runs belong to an experiment, however the path to it is written", "[diagnosis]") {
    experiment::Experiment e = strip(), same = e, other = e;
    e.file = "experiments/a/experiment.json";
    same.file = (std::filesystem::current_path() / "experiments/b/../a/experiment.json").string();
    other.file = "experiments/b/experiment.json";
    CHECK(ReplayModel(e).identity() == ReplayModel(same).identity());
    CHECK(ReplayModel(e).identity() != ReplayModel(other).identity());
    same.text = R"({"markers": [{"arc_fraction": 0.4}]})"; // a correction: the old tracks are of another place
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
    same = e;
    same.runs[0].readings.time = {0.0, 0.05}; // filtered otherwise: as many rows may stand elsewhere
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
    same = e;
    same.runs[0].markers.time = {0.0, 0.1};
    CHECK(ReplayModel(e).identity() != ReplayModel(same).identity());
}

TEST_CASE("nominal parameters are the stated intervals and an ordinary give", "[diagnosis]") {
    experiment::Experiment e = strip();
    const bool lengthwise = GENERATE(false, true); // then what gives is at the touch
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

TEST_CASE("a repeat is the same simulation, read otherwise", "[diagnosis]") {
    const auto loaded = experiment::load(SC_TEST_DATA "/recordings/baseline/case_101/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    e.runs.resize(1);
    e.runs.push_back(e.runs.front()); // a repeat
    e.runs.push_back(e.runs.front()); // another way
    for (double& d : e.runs.back().driveDisplacement)
        d *= 0.9;
    e.runs[1].readings.force[5] += 1.0;
    const ReplayModel model(e);
    CHECK(model.twin(0) == 0);
    CHECK(model.twin(1) == 0);
    CHECK(model.twin(2) == 2);
    Store store;
    Evaluator evaluator(model, e.runs.size(), {}, store);
    diagnosis::Point stated;
    for (const Scalar& s : model.nominal())
        stated.nominal.push_back(s.value);
    const auto read = evaluator.everywhere({stated}, Fineness::Coarse).front();
    CHECK(evaluator.asked() == 2);
    REQUIRE(read[0].failure.empty());
    CHECK(read[0].force == read[1].force);
    CHECK(read[0].force != read[2].force);
}

TEST_CASE("designs are runs that start at rest and never go back in time", "[diagnosis]") {
    const experiment::Experiment e = strip();
    const auto designs = designsFor(e);
    REQUIRE(designs.size() >= 4);
    for (std::size_t i = 0; i < designs.size(); ++i) {
        const experiment::Experiment one = designed(e, i);
        REQUIRE(one.runs.size() == 1);
        const experiment::Run& run = one.runs.front();
        INFO(designs[i].what);
        CHECK(run.driveDisplacement.front() == 0.0);
        for (std::size_t k = 1; k < run.driveTime.size(); ++k)
            CHECK(run.driveTime[k] > run.driveTime[k - 1]);
    }
}

TEST_CASE("a run with the specimen turned is a run of its own", "[diagnosis]") {
    experiment::Experiment e = strip();
    e.runs.push_back(e.runs.front());
    e.runs.back().turned = true;
    CHECK(ReplayModel(e).twin(1) == 1);
    const Data data = dataOf(e);
    CHECK(data.firstOf(1) == 1);   // no repeat of the first
    CHECK(data.repeatsOf(0) == 2); // but simulated with the same errors
    const auto designs = designsFor(e);
    const auto turned = std::find_if(designs.begin(), designs.end(), [](const Design& d) { return d.turned; });
    REQUIRE(turned != designs.end());
    CHECK(turned->what == "a run with the specimen turned end for end");
    CHECK(designed(e, static_cast<std::size_t>(turned - designs.begin())).runs.front().turned);
    CHECK(std::count_if(designs.begin(), designs.end(), [](const Design& d) { return d.turned; }) == 1);
}

TEST_CASE("markers are proposed where there are none, and read in every further run where there are", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    const std::size_t recorded = e.markers.size();
    REQUIRE(recorded > 0);
    const auto filmed = [](const Design& d) { return !d.markers.empty(); };
    const auto stated = [](const Model& model) {
        diagnosis::Point p;
        for (const Scalar& s : model.nominal())
            p.nominal.push_back(s.value);
        return p;
    };
    std::vector<Design> designs = designsFor(e);
    CHECK(std::none_of(designs.begin(), designs.end(), filmed));
    CHECK(std::all_of(designs.begin(), designs.end(), [](const Design& d) { return d.markerRate > 0.0; }));
    const ReplayModel seen(e);
    const DesignResponse read = seen.simulateDesign(0, stated(seen), nullptr);
    REQUIRE(read.failure.empty());
    CHECK(read.markerTime.size() > 20);
    CHECK(read.markers.size() == 2 * static_cast<Eigen::Index>(recorded) * read.markerTime.size());

    e.markers.clear();
    for (experiment::Run& run : e.runs) {
        run.markers = {};
        run.markersFile.clear();
        run.markersSamplingRate = 0.0;
    }
    designs = designsFor(e);
    const auto camera = std::find_if(designs.begin(), designs.end(), filmed);
    REQUIRE(camera != designs.end());
    CHECK(camera->what == "a run that is filmed, with 6 markers on the specimen");
    CHECK(std::count_if(designs.begin(), designs.end(), [](const Design& d) { return d.markerRate > 0.0; }) == 1);
    const ReplayModel blind(e);
    const auto index = static_cast<std::size_t>(camera - designs.begin());
    const DesignResponse frames = blind.simulateDesign(index, stated(blind), nullptr);
    REQUIRE(frames.failure.empty());
    CHECK(frames.markers.size() == 12 * frames.markerTime.size());
    CHECK(blind.simulateDesign(0, stated(blind), nullptr).markers.size() == 0);
}

TEST_CASE("no run that is proposed is faster or read more often than what was recorded", "[diagnosis]") {
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
    const std::vector<Design> designs = designsFor(*loaded);
    REQUIRE(designs.size() >= 6);
    for (const Design& d : designs) {
        INFO(d.what);
        CHECK(fastest(d.time, d.displacement) <= recorded * (1.0 + 1e-9)); // rounding of a quotient
        CHECK(d.rate <= rate);
        CHECK(d.rate * d.time.back() > 100.0); // readings
    }
}

TEST_CASE("a specimen that is let go rests before the next stroke", "[diagnosis]") {
    experiment::Experiment e = strip();
    const auto rests = [&] {
        std::vector<double> out; // at zero, between strokes
        for (const Design& d : designsFor(e))
            for (std::size_t i = 2; i + 1 < d.time.size(); ++i)
                if (d.displacement[i] == 0.0) {
                    const bool again = d.displacement[i + 1] == 0.0;
                    CHECK((again || d.displacement[i - 1] == 0.0));
                    if (again)
                        out.push_back(d.time[i + 1] - d.time[i]);
                }
        return out;
    };
    const std::vector<double> usual = rests();
    REQUIRE(usual.size() == 6); // of two cycles one, of six cycles five
    for (const double s : usual)
        CHECK(s == Approx(1.0));
    experiment::Run& run = e.runs.front(); // one stroke more, after three seconds
    const double end = run.driveTime.back(), last = run.driveDisplacement.back();
    REQUIRE(last == 0.0);
    for (const auto& [time, displacement] : {std::pair{3.0, 0.0}, {5.0, 0.005}, {7.0, 0.0}}) {
        run.driveTime.push_back(end + time);
        run.driveDisplacement.push_back(displacement);
    }
    const std::vector<double> longer = rests();
    REQUIRE(longer.size() == 6);
    for (const double s : longer)
        CHECK(s == Approx(3.0));
}

TEST_CASE("what acts on readings only is added to them as the sensor would", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json");
    REQUIRE(loaded);
    const experiment::Experiment& e = *loaded;
    const ReplayModel model(e);
    std::vector<double> stated;
    for (const Scalar& s : model.nominal())
        stated.push_back(s.value);
    const Response plain = model.simulate(0, {stated, {}}, Fineness::Coarse, nullptr);
    INFO(plain.failure);
    REQUIRE(plain.failure.empty());
    const double peak = plain.force.cwiseAbs().maxCoeff();
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const Candidate& candidate = model.candidates()[c];
        if (candidate.label != "sensor_drift" && candidate.label != "sensor_gain")
            continue;
        INFO(candidate.label << " " << candidate.form);
        const diagnosis::Point with{stated, {{c, candidate.probes.front()}}};
        CHECK(model.simulated(with).terms.empty());
        Response quick = plain;
        model.read(0, with, quick);
        const Response full = model.simulate(0, with, Fineness::Coarse, nullptr);
        // The sensor reads between the samples too, where the drift bends by far less than a thousandth.
        CHECK((quick.force - full.force).cwiseAbs().maxCoeff() < 1e-3 * peak);
        CHECK((full.force - plain.force).cwiseAbs().maxCoeff() > 1e-2 * peak);
    }
}

TEST_CASE("a learned moment with coefficients of zero is linear, and bends the curve otherwise", "[diagnosis]") {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json");
    REQUIRE(loaded);
    const ReplayModel model(*loaded);
    std::vector<double> stated;
    for (const Scalar& s : model.nominal())
        stated.push_back(s.value);
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const Candidate& candidate = model.candidates()[c];
        if (candidate.label != "learned_moment")
            continue;
        std::vector<double> zero(candidate.parameters.size(), 0.0), soft(candidate.parameters.size(), -0.2);
        // A modulus lower by a fifth at every curvature is a bending modulus lower by a fifth.
        diagnosis::Point softer{stated, {}};
        REQUIRE(model.nominal().front().name == "bending_modulus");
        softer.nominal.front() *= 0.8;
        CHECK(model.candidates()[c].curve.evaluate(soft, {0.5}).front() == Approx(-0.2));
        const Response a = model.simulate(0, {stated, {{c, soft}}}, Fineness::Coarse, nullptr);
        const Response b = model.simulate(0, softer, Fineness::Coarse, nullptr);
        const Response linear = model.simulate(0, {stated, {{c, zero}}}, Fineness::Coarse, nullptr);
        const Response plain = model.simulate(0, {stated, {}}, Fineness::Coarse, nullptr);
        INFO(a.failure);
        REQUIRE(a.failure.empty());
        CHECK((linear.force - plain.force).norm() <= 1e-6 * plain.force.norm());
        CHECK((a.force - b.force).norm() <= 1e-2 * (b.force - plain.force).norm()); // the material's own step control
    }
}

TEST_CASE("what too few arcs do to an arch's force is known a hundred times better than it is large", "[diagnosis]") {
    const auto e = experiment::load(std::string(SC_TEST_DATA) + "/recordings/training/case_12/experiment.json");
    REQUIRE(e);
    const ReplayModel model(*e);
    const Data data = dataOf(*e);
    constexpr std::size_t kRun = 2; // slow, there and back
    diagnosis::Point at;
    for (const Scalar& s : model.nominal())
        at.nominal.push_back(s.value);
    const std::atomic<bool>* const never = nullptr;
    const Response fine = model.simulate(kRun, at, Fineness::Fine, never),
                   finer = model.simulate(kRun, at, Fineness::Finer, never);
    REQUIRE(fine.failure.empty());
    REQUIRE(finer.failure.empty());
    const double peak = data.peakForce();
    const RowErrors errors = rowErrors(data.runs[kRun], estimateNoise(data), fine, finer, peak, {});

    replay::Parameters p = replay::nominal(*e);
    for (std::size_t i = 0; i < at.nominal.size(); ++i)
        if (model.nominal()[i].name == "series_compliance")
            p.seriesCompliance = at.nominal[i];
    const auto force = [&](int elements) {
        replay::Resolution r = replay::Resolution::full();
        r.elements = elements;
        const std::vector<double> f = replay::simulate(*e, kRun, p, r).readings.force;
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(f.data(), static_cast<Eigen::Index>(f.size())));
    };
    const Eigen::VectorXd many = force(121);
    const Eigen::VectorXd exact = many + (many - force(61)) / 3.0;
    std::vector<double> without, with; // share of the peak
    for (Eigen::Index k = 0; k < exact.size(); ++k)
        if (std::abs(exact[k]) > 0.05 * peak) {
            without.push_back(std::abs(fine.force[k] - exact[k]) / peak);
            with.push_back(std::abs(fine.force[k] + errors.correction[k] - exact[k]) / peak);
        }
    REQUIRE(with.size() > 1000);
    const auto most = [](std::vector<double>& v) {
        std::nth_element(v.begin(), v.begin() + static_cast<long>(9 * v.size() / 10), v.end());
        return v[9 * v.size() / 10];
    };
    INFO("90 % of the rows within " << most(without) << ", corrected " << most(with));
    CHECK(most(without) > 5e-4); // else there is nothing to correct
    // The next order is (1/31)^2 of the first, some thousandth, times a number of order one or a few.
    CHECK(most(with) < 0.01 * most(without));
}
