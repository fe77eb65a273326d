// A reciprocal amplitude of 0 stands for an infinite stiffness; the catalogue takes infinity as "off", so nothing needs
// to be left out by hand.

#include "plugin/diagnosis/replay_model.h"

#include "plugin/diagnosis/designs.h"
#include "plugin/record/text.h"
#include "plugin/replay/parameters.h"
#include "plugin/replay/simulate.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

bool alike(const experiment::Stated& a, const experiment::Stated& b) {
    return a.value == b.value && a.halfWidth == b.halfWidth;
}

/// Whether all specimens are of one batch: described alike in everything.
bool oneBatch(const experiment::Experiment& e) {
    for (const experiment::Specimen& s : e.specimens) {
        const experiment::Specimen& first = e.specimens.front();
        if (!alike(s.bendingModulus, first.bendingModulus) || !alike(s.naturalCurvature, first.naturalCurvature) ||
            !alike(s.thickness, first.thickness) || !alike(s.linearMass, first.linearMass))
            return false;
    }
    return true;
}

/// Every set-up gives a little, and no description says so: frames, clamps and contacts of this size together 20 kN/m
/// and more. Up to that it is not worth a name; beyond, it is the effect machine_compliance.
Scalar ordinaryGive(const experiment::Experiment& e) {
    constexpr double kMost = 5e-5; // m/N
    Scalar s;
    s.name = "series_compliance";
    s.unit = "m/N";
    s.about = "give of an ordinary set-up";
    s.lower = replay::nominal(e).seriesCompliance;
    s.upper = s.lower + kMost;
    s.step = 0.5 * kMost;
    s.value = s.lower + s.step;
    return s;
}

/// Parameters with a stated interval; those of specimens that are described differently on their own.
std::vector<Scalar> nominalOf(const experiment::Experiment& e) {
    std::vector<Scalar> all;
    const bool apart = !oneBatch(e);
    for (const replay::ParameterInfo& info : replay::parameterList(e)) {
        const bool ofSpecimen = info.name == "bending_modulus" || info.name == "natural_curvature" ||
                                info.name == "thickness" || info.name == "linear_mass";
        const bool ofOne = info.name.find('.') != std::string::npos;
        if (info.stated.halfWidth <= 0.0 || (apart && ofSpecimen) || (!apart && ofOne))
            continue;
        Scalar s;
        s.name = info.name;
        s.unit = info.unit;
        s.about = info.about;
        s.value = info.stated.value;
        s.lower = info.stated.lower();
        s.upper = info.stated.upper();
        if (s.name == "friction")
            s.lower = std::max(0.0, s.lower);
        s.step = info.stated.halfWidth;
        all.push_back(s);
    }
    if (!e.scene)
        all.push_back(ordinaryGive(e));
    return all;
}

std::vector<double> filled(const std::vector<double>& v, std::size_t rows) {
    std::vector<double> out(v);
    out.resize(rows, std::numeric_limits<double>::quiet_NaN());
    return out;
}

Eigen::VectorXd vectorOf(const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

} // namespace

ReplayModel::ReplayModel(const experiment::Experiment& e, const std::vector<std::string>& without)
    : experiment_(e), nominal_(nominalOf(e)), menu_(menuFor(e, without)) {}

std::string ReplayModel::parametersAt(const Point& point, replay::Parameters& p) const {
    p = replay::nominal(experiment_);
    for (std::size_t i = 0; i < nominal_.size() && i < point.nominal.size(); ++i)
        if (std::string why = replay::set(p, experiment_, nominal_[i].name, point.nominal[i]); !why.empty())
            return why;
    for (const Term& t : point.terms) {
        const Recipe& recipe = menu_.recipes[t.candidate];
        effects::Setting setting = recipe.base;
        for (std::size_t i = 0; i < t.values.size(); ++i) {
            const Scalar& s = menu_.candidates[t.candidate].parameters[i];
            setting.values[recipe.parameterAt[i]] = outer(s.scale, t.values[i]);
        }
        if (!effects::isOff(setting))
            p.effects.push_back(setting);
    }
    return replay::checkEffects(p, experiment_);
}

namespace {

/// A search may ask for values at which every step is tiny. The limit counts steps, not time: the same everywhere.
replay::Simulated simulateWithin(const experiment::Experiment& e, std::size_t run, const replay::Parameters& p,
                                 const replay::Resolution& resolution, const std::atomic<bool>* interrupt) {
    constexpr int kMostSteps = 15000;
    std::atomic<bool> enough{false};
    int steps = 0;
    const auto count = [&](double) { enough = ++steps > kMostSteps || (interrupt != nullptr && interrupt->load()); };
    replay::Simulated s = replay::simulate(e, run, p, resolution, {&enough, count});
    if (s.failure.empty() && s.stopped)
        s.failure = "too many steps";
    return s;
}

} // namespace

std::vector<Design> ReplayModel::designs() const {
    return designsFor(experiment_);
}

DesignResponse ReplayModel::simulateDesign(std::size_t index, const Point& point,
                                           const std::atomic<bool>* interrupt) const {
    DesignResponse out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const replay::Simulated s =
        simulateWithin(designed(experiment_, index), 0, p, replay::Resolution::coarse(), interrupt);
    out.failure = s.failure;
    out.time = vectorOf(s.readings.time);
    out.force = vectorOf(s.readings.force);
    return out;
}

Response ReplayModel::simulate(std::size_t run, const Point& point, Fineness fineness,
                               const std::atomic<bool>* interrupt) const {
    Response out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const replay::Resolution resolution =
        fineness == Fineness::Fine ? replay::Resolution::full() : replay::Resolution::coarse();
    const replay::Simulated s = simulateWithin(experiment_, run, p, resolution, interrupt);
    out.failure = s.failure;
    const experiment::Run& recorded = experiment_.runs[run];
    out.force =
        experiment::channel(experiment_).perUnit * vectorOf(filled(s.readings.force, recorded.readings.time.size()));
    const std::size_t seen = recorded.markers.time.size();
    const std::size_t markers = seen > 0 ? experiment_.markers.size() : 0;
    out.markers.resize(static_cast<Eigen::Index>(2 * markers * seen));
    for (std::size_t m = 0; m < markers; ++m) {
        const bool there = m < s.markers.x.size();
        const auto at = static_cast<Eigen::Index>(2 * m * seen), n = static_cast<Eigen::Index>(seen);
        out.markers.segment(at, n) = vectorOf(filled(there ? s.markers.x[m] : std::vector<double>{}, seen));
        out.markers.segment(at + n, n) = vectorOf(filled(there ? s.markers.y[m] : std::vector<double>{}, seen));
    }
    return out;
}

std::string ReplayModel::identity() const {
    std::string id = experiment_.file + "\n";
    if (experiment_.scene)
        id += experiment_.scene->text + "\n";
    const auto add = [&](double v) {
        record::appendNumber(id, v);
        id += ' ';
    };
    for (const Scalar& s : nominal_) {
        id += s.name + ' ';
        add(s.value);
        add(s.step);
    }
    for (const experiment::Run& run : experiment_.runs) {
        id += '\n' + run.file + ' ';
        add(static_cast<double>(run.readings.time.size()));
        for (const double v : run.driveTime)
            add(v);
        for (const double v : run.driveDisplacement)
            add(v);
    }
    for (const Candidate& c : menu_.candidates) {
        id += '\n' + c.label + '/' + c.form;
        for (const Scalar& s : c.parameters)
            id += ' ' + s.name;
    }
    return id;
}

} // namespace supercircle::diagnosis
