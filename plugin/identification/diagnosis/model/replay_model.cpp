// A reciprocal amplitude of 0 stands for an infinite stiffness; the catalogue takes infinity as "off", so nothing needs
// to be left out by hand.

#include "plugin/identification/diagnosis/replay_model.h"

#include "plugin/identification/diagnosis/next_experiment/designs.h"
#include "plugin/identification/diagnosis/store.h"
#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

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
/// and more, and a machine made for large forces not more than half a per cent of its way. Up to that it is not worth a
/// name; beyond, it is the effect machine_compliance.
Scalar ordinaryGive(const experiment::Experiment& e) {
    const Sizes sizes = sizesOf(e);
    const double most = std::min(5e-5, 0.005 * sizes.travel / sizes.force); // m/N
    const replay::Parameters nominal = replay::nominal(e);
    // A strip that is pressed lengthwise is too stiff for where it gives to be all the same: see touchCompliance.
    const bool touches = e.protocol == experiment::Protocol::StripOnRigidFloor;
    Scalar s;
    s.name = touches ? "touch_compliance" : "series_compliance";
    s.unit = "m/N";
    s.about = "give of an ordinary set-up";
    s.lower = touches ? nominal.touchCompliance : nominal.seriesCompliance;
    s.upper = s.lower + most;
    s.step = 0.5 * most;
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

/// A search may ask for values at which every step is tiny. The limit counts steps, not time: the same everywhere.
replay::Simulated simulateWithin(const experiment::Experiment& e, std::size_t run, const replay::Parameters& p,
                                 const replay::Resolution& resolution, const std::atomic<bool>* interrupt) {
    double way = 0.0, time = 0.0; // of the drive, m, s
    for (std::size_t i = 1; i < e.runs[run].driveTime.size(); ++i) {
        if (i < e.runs[run].driveDisplacement.size()) // free scenes have none
            way += std::abs(e.runs[run].driveDisplacement[i] - e.runs[run].driveDisplacement[i - 1]);
        time = e.runs[run].driveTime[i] - e.runs[run].driveTime.front();
    }
    const double longest = e.scene ? resolution.freeStep : resolution.dtMax;
    const double most = 15000.0 + 20.0 * (way / resolution.travelMax + time / longest);
    std::atomic<bool> enough{false};
    int steps = 0;
    double share = 0.0; // of the drive
    const auto count = [&](double done) {
        share = done;
        enough = ++steps > most || (interrupt != nullptr && interrupt->load());
    };
    replay::Simulated s = replay::simulate(e, run, p, resolution, {&enough, count});
    if (s.failure.empty() && s.stopped)
        s.failure = "too many steps (at t = " + std::to_string(e.runs[run].driveTime.front() + share * time) + " s)";
    return s;
}

/// Largest curvature change of the run that goes farthest, as described: where moments can be learned.
double largestBend(const experiment::Experiment& e, const std::atomic<bool>* interrupt) {
    std::size_t farthest = 0;
    double most = 0.0;
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        for (const double d : e.runs[r].driveDisplacement)
            if (d > most) {
                most = d;
                farthest = r;
            }
    if (e.runs.empty())
        return 0.0;
    return simulateWithin(e, farthest, replay::nominal(e), replay::Resolution::coarse(), interrupt).bendMost;
}

/// Of each run the first one that is simulated alike.
std::vector<std::size_t> twinsOf(const experiment::Experiment& e) {
    const auto alikeInAll = [](const experiment::Run& a, const experiment::Run& b) {
        return a.driveTime == b.driveTime && a.driveDisplacement == b.driveDisplacement && a.turned == b.turned &&
               a.readings.time == b.readings.time && a.samplingRate == b.samplingRate &&
               a.markers.time == b.markers.time && a.markersSamplingRate == b.markersSamplingRate;
    };
    std::vector<std::size_t> out;
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        std::size_t first = e.scene ? r : 0; // runs of free scenes have parameters of their own
        while (first < r && !alikeInAll(e.runs[first], e.runs[r]))
            ++first;
        out.push_back(first);
    }
    return out;
}

Eigen::VectorXd vectorOf(const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// x of marker 0 over `rows` times, its y, x of marker 1, ...; not a number where a simulation ended before.
Eigen::VectorXd stacked(const experiment::MarkerTracks& tracks, std::size_t markers, std::size_t rows) {
    Eigen::VectorXd out(static_cast<Eigen::Index>(2 * markers * rows));
    for (std::size_t m = 0; m < markers; ++m) {
        const bool there = m < tracks.x.size();
        const auto at = static_cast<Eigen::Index>(2 * m * rows), n = static_cast<Eigen::Index>(rows);
        out.segment(at, n) = vectorOf(filled(there ? tracks.x[m] : std::vector<double>{}, rows));
        out.segment(at + n, n) = vectorOf(filled(there ? tracks.y[m] : std::vector<double>{}, rows));
    }
    return out;
}

} // namespace

ReplayModel::ReplayModel(const experiment::Experiment& e, const std::vector<std::string>& without,
                         const std::atomic<bool>* interrupt)
    : experiment_(e), nominal_(nominalOf(e)), menu_(menuFor(e, without, largestBend(e, interrupt))),
      twins_(twinsOf(e)) {
    const Sizes s = sizesOf(e);
    travel_ = s.travel;
    duration_ = s.duration;
}

Point ReplayModel::simulated(const Point& point) const {
    Point out = point;
    out.terms.clear();
    for (const Term& t : point.terms)
        if (menu_.recipes[t.candidate].reading == Reading::None)
            out.terms.push_back(t);
    return out;
}

void ReplayModel::read(std::size_t run, const Point& point, Response& response) const {
    const std::vector<double>& time = experiment_.runs[run].readings.time;
    if (response.force.size() != static_cast<Eigen::Index>(time.size()))
        return;
    for (const bool gain : {true, false}) // the chain multiplies first
        for (const Term& t : point.terms)
            if (const Reading r = menu_.recipes[t.candidate].reading;
                r != Reading::None && (r == Reading::Gain) == gain)
                addReading(t, run, time, response.force);
}

void ReplayModel::addReading(const Term& term, std::size_t run, const std::vector<double>& time,
                             Eigen::VectorXd& force) const {
    const Recipe& recipe = menu_.recipes[term.candidate];
    const experiment::Run& recorded = experiment_.runs[run];
    // What is added shows in the zero too, which is the mean of the first stretch.
    const auto add = [&](Eigen::VectorXd& to, const std::vector<double>& at, const auto& value) {
        double zero = 0.0, count = 0.0;
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double v = value(k);
            to[static_cast<Eigen::Index>(k)] += v;
            if (at[k] < at.front() + experiment_.sensors.forceZeroWindow) {
                zero += v;
                count += 1.0;
            }
        }
        if (count > 0.0)
            to.array() -= zero / count;
    };
    if (recipe.reading == Reading::Gain || recipe.reading == Reading::Drift) {
        effects::Setting setting = recipe.base;
        for (std::size_t i = 0; i < term.values.size(); ++i)
            setting.values[recipe.parameterAt[i]] =
                outer(menu_.candidates[term.candidate].parameters[i].scale, term.values[i]);
        const effects::SensorModel sensor = effects::modelFor({setting}, "all").sensor;
        force *= 1.0 + sensor.gain;
        if (recipe.reading == Reading::Drift)
            add(force, time, [&](std::size_t k) {
                const double age = std::max(0.0, time[k] - recorded.driveTime.front());
                return sensor.driftRate * age - sensor.drift * std::expm1(-age / sensor.driftTime);
            });
        return;
    }
    const Curve& curve = menu_.candidates[term.candidate].curve;
    double direction = 1.0;
    add(force, time, [&](std::size_t k) {
        std::size_t i = 1;
        while (i + 1 < recorded.driveTime.size() && time[k] > recorded.driveTime[i])
            ++i;
        const double t0 = recorded.driveTime[i - 1], d0 = recorded.driveDisplacement[i - 1];
        const double way = recorded.driveDisplacement[i] - d0, span = recorded.driveTime[i] - t0;
        const double d = d0 + way * std::clamp((time[k] - t0) / span, 0.0, 1.0);
        direction = way != 0.0 ? std::copysign(1.0, way) : direction;
        const double at =
            recipe.reading == Reading::ByTime ? (time[k] - recorded.driveTime.front()) / duration_ : d / travel_;
        const double value = curve.scale * curve.evaluate(term.values, {at}).front();
        return recipe.reading == Reading::ByDirection ? direction * value : value;
    });
}

std::string ReplayModel::parametersAt(const Point& point, replay::Parameters& p) const {
    p = replay::nominal(experiment_);
    for (std::size_t i = 0; i < nominal_.size() && i < point.nominal.size(); ++i)
        if (std::string why = replay::set(p, experiment_, nominal_[i].name, point.nominal[i]); !why.empty())
            return why;
    for (const Term& t : point.terms) {
        const Recipe& recipe = menu_.recipes[t.candidate];
        if (recipe.reading != Reading::None && recipe.parameterAt.empty())
            continue; // a learned one has no setting
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

std::vector<Design> ReplayModel::designs() const {
    return designsFor(experiment_);
}

DesignResponse ReplayModel::simulateDesign(std::size_t index, const Point& point,
                                           const std::atomic<bool>* interrupt) const {
    DesignResponse out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const experiment::Experiment e = designed(experiment_, index);
    const replay::Simulated s = simulateWithin(e, 0, p, replay::Resolution::coarse(), interrupt);
    out.failure = s.failure;
    out.time = vectorOf(s.readings.time);
    out.force = vectorOf(s.readings.force);
    out.markerTime = vectorOf(s.markers.time);
    out.markers = stacked(s.markers, s.markers.time.empty() ? 0 : e.markers.size(), s.markers.time.size());
    out.jumps = vectorOf(replay::jumpTimes(s));
    return out;
}

Response ReplayModel::simulate(std::size_t run, const Point& point, Fineness fineness,
                               const std::atomic<bool>* interrupt) const {
    Response out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const replay::Resolution resolution = fineness == Fineness::Fine    ? replay::Resolution::full()
                                          : fineness == Fineness::Finer ? replay::Resolution::finer()
                                                                        : replay::Resolution::coarse();
    const replay::Simulated s = simulateWithin(experiment_, run, p, resolution, interrupt);
    out.failure = s.failure;
    const experiment::Run& recorded = experiment_.runs[run];
    out.force =
        experiment::channel(experiment_).perUnit * vectorOf(filled(s.readings.force, recorded.readings.time.size()));
    out.jumps = vectorOf(replay::jumpTimes(s));
    const std::size_t seen = recorded.markers.time.size();
    out.markers = stacked(s.markers, seen > 0 ? experiment_.markers.size() : 0, seen);
    return out;
}

std::string ReplayModel::identity() const {
    std::error_code lost; // a file that is gone keeps the name it was read by
    std::filesystem::path file = std::filesystem::absolute(experiment_.file, lost);
    file = lost ? file : std::filesystem::weakly_canonical(file, lost);
    std::string id = (lost ? experiment_.file : file.string()) + "\n" + simulatorStamp() + "\n";
    id += experiment_.text + '\n'; // geometry, clamps, markers' places: all that is declared
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
        id += '\n' + run.file;
        for (const std::vector<double>* column :
             {&run.readings.time, &run.driveTime, &run.driveDisplacement, &run.markers.time}) {
            id += '\n';
            std::for_each(column->begin(), column->end(), add);
        }
    }
    for (const Candidate& c : menu_.candidates) {
        id += '\n' + c.label + '/' + c.form;
        for (const Scalar& s : c.parameters)
            id += ' ' + s.name;
    }
    for (const Recipe& r : menu_.recipes)
        for (const double v : r.base.values)
            add(std::isfinite(v) ? v : -1.0);
    return id;
}

} // namespace supercircle::diagnosis
