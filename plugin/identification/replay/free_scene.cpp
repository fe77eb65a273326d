#include "plugin/identification/replay/free_scene.h"

#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/multibody.h"
#include "plugin/identification/replay/plane.h"
#include "plugin/identification/replay/scene_of_run.h"
#include "plugin/identification/replay/trace.h"
#include "plugin/identification/replay/track.h"
#include "supercircle/effects/backlash.h"
#include "supercircle/effects/effect.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using scene::Observation;
using Quantity = Observation::Quantity;
using experiment::Run;
using step::Vec2;

/// Longest step of the shortest time constant of springs, fine: the energy falls by 3e-8 a period. Half of it costs
/// twice the steps, twice as much 1e-6 a period.
constexpr double kOfShortest = 0.05;
/// The same behind a machine, where the shortest time is that of a load cell that follows: its phase errs by 1e-5 of a
/// turn. Half of it doubles the cost of a stiff load cell.
constexpr double kOfShortestDriven = 0.2;

/// All recorded channels, step by step.
class Recorder {
public:
    Recorder(const Experiment& e, const Multibody& multibody)
        : e_(e), linkage_(multibody), tracks_(1 + 2 * e.markers.size() + e.scene->further.size()) {
        const auto watch = [&](const Observation& o) {
            observed_.push_back({o, o.of == Observation::Of::Body ? multibody.find(o.target) : 0});
        };
        watch(e.scene->observation);
        for (const experiment::FurtherChannel& c : e.scene->further)
            watch(c.observation);
        for (const experiment::Marker& m : e.markers)
            carriers_.push_back(multibody.find(m.body));
    }

    void read() {
        time.push_back(linkage_.time());
        observe(0, observed_.front());
        for (std::size_t k = 1; k < observed_.size(); ++k)
            observe(further(k - 1), observed_[k]);
        for (std::size_t m = 0; m < e_.markers.size(); ++m) {
            const Multibody::Pose b = linkage_.pose(carriers_[m]);
            const double c = math::cos(b.angle), s = math::sin(b.angle);
            const Point& l = e_.markers[m].local;
            const Vec2 r(c * l.x - s * l.y, s * l.x + c * l.y);
            put(1 + 2 * m, b.origin.x() + r.x(), b.velocity.x() - b.spin * r.y());
            put(2 + 2 * m, b.origin.y() + r.y(), b.velocity.y() + b.spin * r.x());
        }
    }
    /// Track of channel `index` beside the first one.
    [[nodiscard]] std::size_t further(std::size_t index) const { return 1 + 2 * e_.markers.size() + index; }
    /// Values of a channel at increasing times; times after the last step are omitted.
    [[nodiscard]] std::vector<double> sampled(std::size_t channel, const std::vector<double>& times) const {
        std::vector<double> out;
        std::size_t row = 0;
        for (const double t : times) {
            if (time.size() < 2 || t > time.back() + 1e-9)
                break;
            while (row + 2 < time.size() && time[row + 1] < t)
                ++row;
            out.push_back(tracks_[channel].at(time, row, t));
        }
        return out;
    }
    [[nodiscard]] const std::vector<double>& values(std::size_t channel) const { return tracks_[channel].value; }
    std::vector<double> time;

private:
    struct Observed {
        Observation what;
        int body = 0;
    };

    /// A channel that is compared.
    void observe(std::size_t track, const Observed& o) {
        const Quantity q = o.what.quantity;
        if (q == Quantity::Force || q == Quantity::Travel) {
            tracks_[track].value.push_back(q == Quantity::Travel ? linkage_.travel() : linkage_.forces(o.body).machine);
            return;
        }
        const Multibody::Pose p = linkage_.pose(o.body);
        const Vec2 r = rotated({o.what.local.x, o.what.local.y}, p.angle);
        const Vec2 position = p.origin + r, velocity = p.velocity + crossSpin(p.spin, r);
        switch (q) {
        case Quantity::Angle:
            return put(track, p.angle, p.spin);
        case Quantity::X:
            return put(track, position.x(), velocity.x());
        case Quantity::Y:
            return put(track, position.y(), velocity.y());
        default:
            break;
        }
        const Multibody::Forces f = linkage_.forces(o.body);
        const Vec2 acceleration = f.acceleration + crossSpin(f.angularAcceleration, r) - p.spin * p.spin * r;
        switch (q) {
        case Quantity::Spin:
            return put(track, p.spin, f.angularAcceleration);
        case Quantity::Vx:
            return put(track, velocity.x(), acceleration.x());
        case Quantity::Vy:
            return put(track, velocity.y(), acceleration.y());
        case Quantity::AngularAcceleration:
            tracks_[track].value.push_back(f.angularAcceleration);
            return;
        default:
            tracks_[track].value.push_back(q == Quantity::Ax ? acceleration.x() : acceleration.y());
        }
    }
    void put(std::size_t channel, double value, double rate) {
        tracks_[channel].value.push_back(value);
        tracks_[channel].rate.push_back(rate);
    }
    const Experiment& e_;
    const Multibody& linkage_;
    std::vector<Track> tracks_;
    std::vector<Observed> observed_;
    std::vector<int> carriers_;
};

std::vector<double> timesFromZero(const Run& run, double rate) {
    std::vector<double> times;
    for (std::size_t i = 0; rate > 0.0 && static_cast<double>(i) / rate < run.driveTime.back() - 1e-9; ++i)
        times.push_back(static_cast<double>(i) / rate);
    return times;
}

void readOut(const Experiment& e, const Run& run, const Parameters& p, const effects::SensorModel& model,
             const Recorder& recorder, Simulated& out) {
    experiment::Readings& r = out.readings;
    r.time = run.readings.time.empty() ? timesFromZero(run, run.samplingRate) : run.readings.time;
    r.force = recorder.sampled(0, r.time);
    r.time.resize(r.force.size());
    out.trace.time = recorder.time;
    out.trace.force = recorder.values(0);
    for (experiment::Readings* rows : {&r, &out.trace}) {
        rows->displacement.clear();
        for (const double t : rows->time)
            rows->displacement.push_back(experiment::commanded(run, t));
    }
    effects::SensorChain rows(model), steps(model);
    for (std::size_t k = 0; k < r.time.size(); ++k)
        r.force[k] = p.readingZero + (model.on() ? rows.read(r.time[k], r.force[k]) : r.force[k]);
    for (std::size_t k = 0; k < out.trace.time.size(); ++k) {
        double& v = out.trace.force[k];
        v = p.readingZero + (model.on() ? steps.read(out.trace.time[k], v) : v);
    }
    for (std::size_t k = 0; k < e.scene->further.size(); ++k) {
        r.further.push_back(recorder.sampled(recorder.further(k), r.time));
        readBy(effects::sensorOf(p.effects, e.scene->further[k].observe), r.time, p.furtherZero[k], r.further.back());
    }
    out.markers.time = run.markers.time.empty() ? timesFromZero(run, run.markersSamplingRate) : run.markers.time;
    for (std::size_t m = 0; m < e.markers.size(); ++m) {
        out.markers.x.push_back(recorder.sampled(1 + 2 * m, out.markers.time));
        out.markers.y.push_back(recorder.sampled(2 + 2 * m, out.markers.time));
    }
    if (!out.markers.x.empty())
        out.markers.time.resize(out.markers.x.front().size());
}

} // namespace

FreeScales freeScales(const Experiment& e) {
    FreeScales out;
    out.turns = false;
    std::string why;
    const auto scene = e.scene && !e.runs.empty() ? sceneOf(e, 0, nominal(e), why) : std::nullopt;
    const Multibody multibody(scene ? scene->rigid : step::RigidWorldDefinition{}, {});
    if (!scene || !multibody.failure().empty())
        return out;
    const Multibody::Elongations moved = multibody.elongations();
    out.shaped = multibody.reach() > 0.0;
    out.twist = moved.angle;
    out.way = moved.length;
    for (const experiment::Run& run : e.runs)
        for (const double d : run.driveDisplacement)
            out.way = std::max(out.way, std::abs(d));
    out.length = out.shaped ? multibody.reach() : out.way > 0.0 ? out.way : out.length;
    for (const step::JointDefinition& j : scene->rigid.joints) {
        const bool turning = j.kind == step::JointKind::Revolute;
        out.turns = out.turns || turning;
        out.slides = out.slides || (j.kind == step::JointKind::Prismatic && j.friction.sticking <= 0.0);
        (turning ? out.turningSprings : out.springs) =
            (turning ? out.turningSprings : out.springs) || j.spring.stiffness != 0.0;
    }
    double released = 0.0; // rad/s
    for (const step::BodyDefinition& b : scene->rigid.bodies)
        if (b.type == step::BodyType::Dynamic)
            released = std::max({released, std::abs(b.angularVelocity), b.linearVelocity.norm() / out.length});
    const double duration = e.runs.front().driveTime.back(),
                 byGravity = std::max(std::sqrt(math::hypot(e.gravity.x, e.gravity.y) / out.length),
                                      e.scene->driven ? 0.0 : multibody.stiffness());
    constexpr double kTurns = 10.0; // of a body at rest without gravity, in a run
    out.spin = byGravity > 0.0 ? byGravity : released > 0.0 ? released : 2.0 * M_PI * kTurns / duration;
    out.fastest = std::max(out.spin, released);
    out.torque = std::max(0.5 * multibody.mass() * out.spin * out.spin * out.length * out.length,
                          std::max(moved.torque, moved.force * out.length));
    out.force = out.torque / out.length;
    return out;
}

namespace {

/// All that freeScales() reads of an experiment.
struct ScaleInputs {
    std::string text, file;
    bool driven = false;
    std::vector<std::pair<std::string, double>> values;
    double gravityX = 0.0, gravityY = 0.0, way = 0.0, duration = 0.0;
    bool operator==(const ScaleInputs&) const = default;
};

ScaleInputs scaleInputs(const Experiment& e) {
    ScaleInputs in{e.scene->text, e.scene->file, e.scene->driven, {}, e.gravity.x, e.gravity.y, 0.0, 0.0};
    for (const experiment::SceneParameter& s : e.scene->parameters)
        in.values.emplace_back(s.name, s.stated.value);
    if (e.runs.empty())
        return in;
    if (const int specimen = e.runs.front().specimen; specimen >= 0)
        for (const experiment::SceneParameter& s : e.scene->specimens[static_cast<std::size_t>(specimen)].parameters)
            in.values.emplace_back(s.name, s.stated.value);
    for (const experiment::SceneParameter& s : e.runs.front().parameters)
        in.values.emplace_back(s.name, s.stated.value);
    for (const Run& run : e.runs)
        for (const double d : run.driveDisplacement)
            in.way = std::max(in.way, std::abs(d));
    in.duration = e.runs.front().driveTime.back();
    return in;
}

experiment::NaturalUnits unitsOfScene(const Experiment& e) {
    const FreeScales own = freeScales(e), reference;
    experiment::NaturalUnits u;
    u.length = own.length / reference.length;
    u.time = u.settling = reference.fastest / own.fastest;
    u.force = own.torque / reference.torque / u.length;
    return u;
}

} // namespace

experiment::NaturalUnits naturalUnits(const Experiment& e) {
    if (!experiment::isMechanism(e))
        return experiment::unitsOfSpecimens(e);
    // Every simulation of a diagnosis asks for them: the last scene of a thread is parsed once.
    thread_local std::optional<std::pair<ScaleInputs, experiment::NaturalUnits>> last;
    if (ScaleInputs in = scaleInputs(e); !last || !(last->first == in))
        last.emplace(std::move(in), unitsOfScene(e));
    return last->second;
}

Simulated simulateFree(const Experiment& e, std::size_t index, const Parameters& p, const Resolution& resolution,
                       const Options& options) {
    Simulated out;
    const Run& run = e.runs[index];
    if (out.failure = checkEffects(p, e); !out.failure.empty())
        return out;
    auto scene = sceneOf(e, index, p, out.failure);
    if (!scene)
        return out;
    const effects::Model extra = effects::modelFor(p.effects, "all");
    scene->rigid.gravity = Vec2(p.gravity.x, p.gravity.y) + extra.gravity;
    Multibody multibody(scene->rigid, extra.bodies, extra.contact.friction);
    if (out.failure = multibody.failure(); !out.failure.empty())
        return out;
    std::vector<const Observation*> observed = {&e.scene->observation};
    for (const experiment::FurtherChannel& c : e.scene->further)
        observed.push_back(&c.observation);
    for (const Observation* o : observed)
        if (o->of == Observation::Of::Body && multibody.find(o->target) < 0) {
            out.failure = "there is no body \"" + o->target + "\"";
            return out;
        }
    if (e.scene->driven) {
        const effects::DriveMotion drive =
            effects::motionBehindBacklash({run.driveTime, run.driveDisplacement}, extra.apparatus.backlash);
        multibody.drive(multibody.find(scene->protocol->body),
                        Vec2(scene->protocol->direction.x, scene->protocol->direction.y), drive.time,
                        drive.displacement);
    }
    Recorder recorder(e, multibody);
    recorder.read();
    const double end = run.driveTime.back();
    const experiment::NaturalUnits units = naturalUnits(e);
    const double step = resolution.in(units).freeStep;
    const double ofShortest =
        (e.scene->driven ? kOfShortestDriven : kOfShortest) * resolution.freeStep / Resolution{}.freeStep;
    const double open = 1e-5 * units.length; // m, joint gap per step that means too long steps
    while (multibody.time() < end && out.failure.empty() && !out.stopped) {
        multibody.advance(
            std::min({step, ofShortest * multibody.shortestTime(), end + 1e-6 * units.time - multibody.time()}));
        recorder.read();
        if (!(multibody.jointGap() < open) || !std::isfinite(multibody.energy()))
            out.failure = "the joints separated at t = " + std::to_string(multibody.time()) + " s";
        if (options.progress)
            options.progress(std::min(1.0, multibody.time() / end));
        out.stopped = options.interrupt != nullptr && options.interrupt->load();
    }
    out.steps = multibody.steps();
    readOut(e, run, p, extra.sensor, recorder, out);
    return out;
}

} // namespace supercircle::replay
