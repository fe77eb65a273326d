// A reciprocal amplitude of 0 means an infinite stiffness, which the catalogue treats as "off".

#include "plugin/identification/diagnosis/replay_model.h"

#include "plugin/identification/diagnosis/model/batch_factors.h"
#include "plugin/identification/diagnosis/model/own_law.h"
#include "plugin/identification/diagnosis/model/stated_numbers.h"
#include "plugin/identification/diagnosis/next_experiment/candidate_runs.h"
#include "plugin/identification/diagnosis/simulation_cache.h"
#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/table/text.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace supercircle::diagnosis {

namespace {

bool alike(const experiment::Stated& a, const experiment::Stated& b) {
    return a.value == b.value && a.halfWidth == b.halfWidth;
}

/// Whether all specimens have the same description.
bool oneBatch(const experiment::Experiment& e) {
    for (const experiment::Specimen& s : e.specimens) {
        const experiment::Specimen& first = e.specimens.front();
        if (!alike(s.bendingModulus, first.bendingModulus) || !alike(s.naturalCurvature, first.naturalCurvature) ||
            !alike(s.thickness, first.thickness) || !alike(s.linearMass, first.linearMass))
            return false;
    }
    return true;
}

/// Compliance of an ordinary set-up, a nominal parameter: 20 kN/m or stiffer for the reference specimen, at most 0.5 %
/// of the travel at the largest force. Beyond that it is the effect machine_compliance.
Scalar ordinaryCompliance(const experiment::Experiment& e) {
    const ExperimentScales scales = scalesOf(e);
    const double most = std::min(5e-5 * replay::naturalUnits(e).of("m/N"), 0.005 * scales.travel / scales.force); // m/N
    const replay::Parameters nominal = replay::nominal(e);
    // A strip pressed lengthwise is so stiff that the place of the compliance does not matter: see touchCompliance.
    const bool touches = e.protocol == experiment::Protocol::StripOnRigidFloor;
    Scalar s;
    s.name = touches ? "touch_compliance" : "series_compliance";
    s.unit = "m/N";
    s.about = "compliance of an ordinary set-up";
    s.lower = touches ? nominal.touchCompliance : nominal.seriesCompliance;
    s.upper = s.lower + most;
    s.step = 0.5 * most;
    s.value = s.lower + s.step;
    return s;
}

/// Of a prior without ends: four standard deviations to either side, beyond which nothing is looked for.
void takePrior(const experiment::Stated& stated, Scalar& s) {
    constexpr double kFarthest = 4.0, kLeast = 1e-3; // standard deviations; of a positive value
    if (stated.prior == experiment::Prior::Interval)
        return;
    s.precision = experiment::Stated::kDeviations * experiment::Stated::kDeviations;
    if (stated.prior == experiment::Prior::LogNormal) {
        s.scale = Scale::Logarithm;
        s.step /= s.value;
        s.value = math::log(s.value);
    }
    const double most = kFarthest / experiment::Stated::kDeviations * s.step;
    s.lower = s.value - most;
    s.upper = s.value + most;
    if (s.scale == Scale::Linear && s.value > 0.0)
        s.lower = std::max(s.lower, kLeast * s.value);
}

/// Parameters with a stated interval. Specimens with different descriptions have parameters of their own.
std::vector<Scalar> nominalOf(const experiment::Experiment& e) {
    std::vector<Scalar> all;
    const bool apart = !oneBatch(e);
    for (const replay::ParameterInfo& info : replay::parameterList(e)) {
        const bool ofSpecimen = info.name == "bending_modulus" || info.name == "natural_curvature" ||
                                info.name == "thickness" || info.name == "linear_mass";
        const bool ofOne = info.name.find('.') != std::string::npos;
        if (info.stated.halfWidth <= 0.0 || (apart && ofSpecimen) || (!apart && ofOne && !e.scene))
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
        takePrior(info.stated, s);
        s.specimen = info.specimen;
        s.run = info.run;
        s.doubtful = !info.ofRecording;
        all.push_back(s);
    }
    if (!e.scene || (replay::get(replay::nominal(e), e, "series_compliance") && replay::comparesForce(e)))
        all.push_back(ordinaryCompliance(e));
    return all;
}

std::vector<double> filled(const std::vector<double>& v, std::size_t rows) {
    std::vector<double> out(v);
    out.resize(rows, std::numeric_limits<double>::quiet_NaN());
    return out;
}

/// Simulation with a limit on the number of steps: a search may ask for values that need tiny steps. Steps, not time,
/// are counted, so results are reproducible.
replay::Simulated simulateWithin(const experiment::Experiment& e, std::size_t run, const replay::Parameters& p,
                                 const replay::Resolution& resolution, const std::atomic<bool>* interrupt) {
    double way = 0.0, time = 0.0; // of the drive, m, s
    for (std::size_t i = 1; i < e.runs[run].driveTime.size(); ++i) {
        if (i < e.runs[run].driveDisplacement.size() && !experiment::drivesLoad(e)) // free scenes have none
            way += std::abs(e.runs[run].driveDisplacement[i] - e.runs[run].driveDisplacement[i - 1]);
        time = e.runs[run].driveTime[i] - e.runs[run].driveTime.front();
    }
    const replay::Resolution actual = resolution.in(replay::naturalUnits(e));
    const double longest = experiment::isFree(e) || experiment::isMechanism(e) ? actual.freeStep : actual.dtMax;
    const double most = 15000.0 + 20.0 * (way / actual.travelMax + time / longest);
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

} // namespace

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
    return simulateWithin(e, farthest, replay::nominal(e), replay::Resolution::coarse(), interrupt)
        .largestCurvatureChange;
}

namespace {

/// Index of the first run with the same simulation, for each run.
std::vector<std::size_t> replicatesOf(const experiment::Experiment& e) {
    const auto alikeInAll = [](const experiment::Run& a, const experiment::Run& b) {
        return a.driveTime == b.driveTime && a.driveDisplacement == b.driveDisplacement &&
               a.specimenReversed == b.specimenReversed && a.readings.time == b.readings.time &&
               a.samplingRate == b.samplingRate && a.markers.time == b.markers.time &&
               a.markersSamplingRate == b.markersSamplingRate;
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

/// x of marker 0 over `rows` times, its y, x of marker 1, ...; not a number after the end of a simulation.
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

Response responseOf(const experiment::Experiment& e, std::size_t run, const replay::Simulated& s) {
    Response out;
    out.failure = s.failure;
    const experiment::Run& recorded = e.runs[run];
    out.force = experiment::channel(e).perUnit * vectorOf(filled(s.readings.force, recorded.readings.time.size()));
    out.jumps = vectorOf(replay::jumpTimes(s));
    const std::size_t frames = recorded.markers.time.size();
    out.markers = stacked(s.markers, frames > 0 ? e.markers.size() : 0, frames);
    const std::size_t channels = recorded.readings.further.size();
    out.further.resize(static_cast<Eigen::Index>(channels) * out.force.size());
    for (std::size_t c = 0; c < channels; ++c)
        out.further.segment(static_cast<Eigen::Index>(c) * out.force.size(), out.force.size()) =
            experiment::furtherChannels(e)[c].channel.perUnit *
            vectorOf(filled(c < s.readings.further.size() ? s.readings.further[c] : std::vector<double>{},
                            recorded.readings.time.size()));
    return out;
}

ReplayModel::ReplayModel(const experiment::Experiment& e, const std::vector<std::string>& without,
                         const std::atomic<bool>* interrupt)
    : experiment_(e), nominal_(nominalOf(e)), largestBend_(largestBend(e, interrupt)),
      candidateEffects_(candidateEffectsFor(e, without, largestBend_)), replicates_(replicatesOf(e)) {
    const ExperimentScales s = scalesOf(e);
    travel_ = s.travel;
    duration_ = s.duration;
    batch_ = batchFactorsOf(e, interrupt);
    for (std::size_t k = 0; k < batch_.size(); ++k)
        for (const Scalar& deviation : deviationsOf(e, batch_[k], static_cast<int>(k)))
            nominal_.push_back(deviation);
    addStatedNumbers(nominal_, candidateEffects_);
}

std::string ReplayModel::add(const StartedLaw& law) {
    return addOwnLaw(candidateEffects_, experiment_, law, ownLawRange(scalesOf(experiment_), largestBend_));
}

ParameterPoint ReplayModel::simulated(std::size_t run, const ParameterPoint& point) const {
    ParameterPoint out = point;
    for (std::size_t i = 0; i < nominal_.size() && i < out.nominal.size(); ++i)
        if (nominal_[i].specimen >= 0 && nominal_[i].specimen != experiment_.runs[run].specimen)
            out.nominal[i] = nominal_[i].value;
    out.terms.clear();
    for (const Term& t : point.terms)
        if (candidateEffects_.mappings[t.candidate].readingEffect == ReadingEffect::None)
            out.terms.push_back(t);
    return out;
}

void ReplayModel::read(std::size_t run, const ParameterPoint& point, Response& response) const {
    const std::vector<double>& time = experiment_.runs[run].readings.time;
    if (response.force.size() != static_cast<Eigen::Index>(time.size()))
        return;
    for (const bool gain : {true, false}) // gain before offset, as in the sensor
        for (const Term& t : point.terms)
            if (const ReadingEffect r = candidateEffects_.mappings[t.candidate].readingEffect;
                r != ReadingEffect::None && (r == ReadingEffect::Gain) == gain)
                addReading(t, run, time, response);
}

void ReplayModel::addReading(const Term& term, std::size_t run, const std::vector<double>& time,
                             Response& response) const {
    const EffectMapping& mapping = candidateEffects_.mappings[term.candidate];
    const experiment::Run& recorded = experiment_.runs[run];
    const auto& further = experiment::furtherChannels(experiment_);
    std::size_t channel = 0; // beside the first one, which is their number
    while (channel < further.size() && further[channel].observe != mapping.base.channel)
        ++channel;
    const bool first = channel == further.size();
    const auto rows = static_cast<Eigen::Index>(time.size());
    const Eigen::Index from = static_cast<Eigen::Index>(channel) * rows;
    if (!first && response.further.size() < from + rows)
        return;
    const double perUnit = (first ? experiment::channel(experiment_) : further[channel].channel).perUnit;
    const double window = first ? experiment_.sensors.forceZeroWindow : 0.0;
    Eigen::Map<Eigen::VectorXd> force(first ? response.force.data() : response.further.data() + from, rows);
    // An added reading shifts the zero too, the mean of the first interval.
    const auto add = [&](Eigen::Ref<Eigen::VectorXd> to, const std::vector<double>& at, const auto& value) {
        double zero = 0.0, count = 0.0;
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double v = value(k);
            to[static_cast<Eigen::Index>(k)] += v;
            if (at[k] < at.front() + window) {
                zero += v;
                count += 1.0;
            }
        }
        if (count > 0.0)
            to.array() -= zero / count;
    };
    if (mapping.readingEffect == ReadingEffect::Gain || mapping.readingEffect == ReadingEffect::Drift) {
        const auto setting = settingAt(mapping, candidateEffects_.candidates[term.candidate], term.values);
        const effects::SensorModel sensor = effects::sensorOf({*setting}, setting->channel);
        force *= 1.0 + sensor.gain;
        if (mapping.readingEffect == ReadingEffect::Drift)
            add(force, time, [&](std::size_t k) {
                const double age = std::max(0.0, time[k] - recorded.driveTime.front());
                return perUnit * (sensor.driftRate * age - sensor.drift * math::expm1(-age / sensor.driftTime));
            });
        return;
    }
    const LearnedCurve& curve = candidateEffects_.candidates[term.candidate].curve;
    double direction = 1.0;
    add(force, time, [&](std::size_t k) {
        std::size_t i = 1;
        while (i + 1 < recorded.driveTime.size() && time[k] > recorded.driveTime[i])
            ++i;
        const double t0 = recorded.driveTime[i - 1], d0 = recorded.driveDisplacement[i - 1];
        const double way = recorded.driveDisplacement[i] - d0, span = recorded.driveTime[i] - t0;
        const double d = d0 + way * std::clamp((time[k] - t0) / span, 0.0, 1.0);
        direction = way != 0.0 ? std::copysign(1.0, way) : direction;
        const double at = mapping.readingEffect == ReadingEffect::ByTime
                              ? (time[k] - recorded.driveTime.front()) / duration_
                              : d / travel_;
        const double value = curve.scale * curve.evaluate(term.values, {at}).front();
        return mapping.readingEffect == ReadingEffect::ByDirection ? direction * value : value;
    });
}

std::string ReplayModel::setNominal(replay::Parameters& p, std::size_t index, double value) const {
    const Scalar& s = nominal_[index];
    if (s.batch < 0)
        return replay::set(p, experiment_, s.name, toPhysical(s.scale, value));
    if (value == 0.0) // then it follows the common value
        return {};
    const std::string& common = batch_[static_cast<std::size_t>(s.batch)].name; // set before its deviations
    return replay::set(p, experiment_, s.name, replay::get(p, experiment_, common).value_or(0.0) + value);
}

std::string ReplayModel::parametersAt(const ParameterPoint& point, replay::Parameters& p) const {
    p = replay::nominal(experiment_);
    std::vector<double> numbers = point.nominal;
    for (const Term& t : point.terms)
        if (const CandidateEffect& c = candidateEffects_.candidates[t.candidate]; c.isNumber())
            numbers[static_cast<std::size_t>(c.number)] += t.values.front() - c.parameters.front().value;
    for (std::size_t i = 0; i < nominal_.size() && i < numbers.size(); ++i)
        if (std::string why = setNominal(p, i, numbers[i]); !why.empty())
            return why;
    p.effects = fixed_;
    for (const Term& t : point.terms) {
        if (candidateEffects_.candidates[t.candidate].isNumber())
            continue;
        const EffectMapping& mapping = candidateEffects_.mappings[t.candidate];
        if (mapping.readingEffect != ReadingEffect::None && mapping.parameterAt.empty())
            continue; // a learned one has no setting
        const auto setting = settingAt(mapping, candidateEffects_.candidates[t.candidate], t.values);
        if (!setting)
            return setting.error();
        if (!effects::isOff(*setting))
            p.effects.push_back(*setting);
    }
    return replay::checkEffects(p, experiment_);
}

std::string ReplayModel::withoutParameters(const ParameterPoint& point) const {
    for (const Term& t : point.terms)
        if (const EffectMapping& m = candidateEffects_.mappings[t.candidate];
            m.readingEffect != ReadingEffect::None && m.parameterAt.empty())
            return "a law of the reading that was learned from these runs is no effect of a replay";
    return {};
}

std::vector<CandidateRun> ReplayModel::candidateRuns() const {
    return candidateRunsFor(experiment_);
}

CandidateRunResponse ReplayModel::simulateCandidateRun(std::size_t index, const ParameterPoint& point,
                                                       const std::atomic<bool>* interrupt) const {
    CandidateRunResponse out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const experiment::Experiment e = withCandidateRun(experiment_, index, p);
    const replay::Simulated s = simulateWithin(e, 0, p, replay::Resolution::coarse(), interrupt);
    out.failure = s.failure;
    out.time = vectorOf(s.readings.time);
    out.force = experiment::channel(e).perUnit * vectorOf(s.readings.force);
    out.further.resize(static_cast<Eigen::Index>(s.readings.further.size()) * out.force.size());
    for (std::size_t c = 0; c < s.readings.further.size(); ++c)
        out.further.segment(static_cast<Eigen::Index>(c) * out.force.size(), out.force.size()) =
            experiment::furtherChannels(e)[c].channel.perUnit *
            vectorOf(filled(s.readings.further[c], s.readings.force.size()));
    out.markerTime = vectorOf(s.markers.time);
    out.markers = stacked(s.markers, s.markers.time.empty() ? 0 : e.markers.size(), s.markers.time.size());
    out.jumps = vectorOf(replay::jumpTimes(s));
    return out;
}

Response ReplayModel::simulate(std::size_t run, const ParameterPoint& point, Fidelity fidelity,
                               const std::atomic<bool>* interrupt) const {
    Response out;
    replay::Parameters p;
    if (out.failure = parametersAt(point, p); !out.failure.empty())
        return out;
    const replay::Resolution resolution = fidelity == Fidelity::Fine    ? replay::Resolution::fine()
                                          : fidelity == Fidelity::Finer ? replay::Resolution::finer()
                                                                        : replay::Resolution::coarse();
    return responseOf(experiment_, run, simulateWithin(experiment_, run, p, resolution, interrupt));
}

std::string ReplayModel::identity() const {
    std::error_code lost; // a deleted file keeps its name
    std::filesystem::path file = std::filesystem::absolute(experiment_.file, lost);
    file = lost ? file : std::filesystem::weakly_canonical(file, lost);
    std::string id = (lost ? experiment_.file : file.string()) + "\n" + simulatorStamp() + "\n";
    id += experiment_.text + '\n'; // the whole description
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
        add(s.precision);
    }
    for (const experiment::Run& run : experiment_.runs) {
        id += '\n' + run.file;
        for (const std::vector<double>* column :
             {&run.readings.time, &run.driveTime, &run.driveDisplacement, &run.markers.time}) {
            id += '\n';
            std::for_each(column->begin(), column->end(), add);
        }
    }
    for (const CandidateEffect& c : candidateEffects_.candidates) {
        id += '\n' + c.label + '/' + c.variant;
        for (const Scalar& s : c.parameters)
            id += ' ' + s.name + std::to_string(static_cast<int>(s.scale));
    }
    for (const EffectMapping& r : candidateEffects_.mappings)
        for (const double v : r.base.values)
            add(std::isfinite(v) ? v : -1.0);
    return id;
}

} // namespace supercircle::diagnosis
