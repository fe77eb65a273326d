#include "plugin/identification/replay/free_scene.h"

#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/multibody.h"
#include "plugin/scene/loader/loader.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using experiment::Quantity;
using experiment::Run;
using step::Vec2;

/// A channel over time with its rate. Cubic interpolation is accurate to the fourth power of the step.
struct Track {
    std::vector<double> value, rate;

    [[nodiscard]] double at(const std::vector<double>& time, std::size_t row, double t) const {
        const double h = time[row + 1] - time[row], s = (t - time[row]) / h, r = 1.0 - s;
        return r * r * (1.0 + 2.0 * s) * value[row] + s * s * (1.0 + 2.0 * r) * value[row + 1] +
               h * (r * r * s * rate[row] - s * s * r * rate[row + 1]);
    }
};

/// The scene of a run; empty, with the reason in `why`, for invalid values.
std::optional<scene::Scene> sceneOf(const Experiment& e, std::size_t run, const Parameters& p, std::string& why) {
    std::vector<scene::Override> overrides;
    for (const SceneValue& v : p.scene)
        if (v.run < 0 || static_cast<std::size_t>(v.run) == run)
            overrides.push_back({v.name, v.value});
    std::vector<scene::Problem> problems;
    auto scene = scene::loadText(e.scene->text, e.scene->file, overrides, problems);
    for (const scene::Problem& problem : problems)
        if (why.empty() && problem.severity == scene::Problem::Severity::Error)
            why = problem.toString();
    return scene ? std::optional(*std::move(scene)) : std::nullopt;
}

/// All recorded channels, step by step.
class Recorder {
public:
    Recorder(const Experiment& e, const Multibody& multibody)
        : e_(e), linkage_(multibody), tracks_(1 + 2 * e.markers.size()), body_(multibody.find(e.scene->body)) {
        for (const experiment::Marker& m : e.markers)
            carriers_.push_back(multibody.find(m.body));
    }

    void read() {
        time.push_back(linkage_.time());
        const Multibody::Pose p = linkage_.pose(body_);
        const Quantity q = e_.scene->quantity;
        put(0,
            q == Quantity::Angle ? p.angle
            : q == Quantity::X   ? p.origin.x()
                                 : p.origin.y(),
            q == Quantity::Angle ? p.spin
            : q == Quantity::X   ? p.velocity.x()
                                 : p.velocity.y());
        for (std::size_t m = 0; m < e_.markers.size(); ++m) {
            const Multibody::Pose b = linkage_.pose(carriers_[m]);
            const double c = math::cos(b.angle), s = math::sin(b.angle);
            const Point& l = e_.markers[m].local;
            const Vec2 r(c * l.x - s * l.y, s * l.x + c * l.y);
            put(1 + 2 * m, b.origin.x() + r.x(), b.velocity.x() - b.spin * r.y());
            put(2 + 2 * m, b.origin.y() + r.y(), b.velocity.y() + b.spin * r.x());
        }
    }
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
    void put(std::size_t channel, double value, double rate) {
        tracks_[channel].value.push_back(value);
        tracks_[channel].rate.push_back(rate);
    }
    const Experiment& e_;
    const Multibody& linkage_;
    std::vector<Track> tracks_;
    int body_;
    std::vector<int> carriers_;
};

std::vector<double> evenTimes(const Run& run, double rate) {
    std::vector<double> times;
    for (std::size_t i = 0; rate > 0.0 && static_cast<double>(i) / rate < run.driveTime.back() - 1e-9; ++i)
        times.push_back(static_cast<double>(i) / rate);
    return times;
}

void readOut(const Experiment& e, const Run& run, const Parameters& p, const effects::SensorModel& model,
             const Recorder& recorder, Simulated& out) {
    experiment::Readings& r = out.readings;
    r.time = run.readings.time.empty() ? evenTimes(run, run.samplingRate) : run.readings.time;
    r.force = recorder.sampled(0, r.time);
    r.time.resize(r.force.size());
    r.displacement.assign(r.time.size(), 0.0);
    out.trace.time = recorder.time;
    out.trace.force = recorder.values(0);
    out.trace.displacement.assign(recorder.time.size(), 0.0);
    effects::SensorChain rows(model), steps(model);
    for (std::size_t k = 0; k < r.time.size(); ++k)
        r.force[k] = p.readingZero + (model.on() ? rows.read(r.time[k], r.force[k]) : r.force[k]);
    for (std::size_t k = 0; k < out.trace.time.size(); ++k) {
        double& v = out.trace.force[k];
        v = p.readingZero + (model.on() ? steps.read(out.trace.time[k], v) : v);
    }
    out.markers.time = run.markers.time.empty() ? evenTimes(run, run.markersSamplingRate) : run.markers.time;
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
    std::string why;
    const auto scene = e.scene && !e.runs.empty() ? sceneOf(e, 0, nominal(e), why) : std::nullopt;
    const Multibody multibody(scene ? scene->rigid : step::RigidWorldDefinition{}, {});
    if (!scene || !multibody.failure().empty())
        return out;
    out.length = multibody.reach();
    const double g = std::max(1e-3, scene->rigid.gravity.norm());
    out.torque = 0.5 * multibody.mass() * g * out.length;
    out.spin = std::sqrt(g / out.length);
    return out;
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
    Multibody multibody(scene->rigid, extra.bodies);
    if (out.failure = multibody.failure(); !out.failure.empty())
        return out;
    if (multibody.find(e.scene->body) < 0) {
        out.failure = "there is no body \"" + e.scene->body + "\"";
        return out;
    }
    Recorder recorder(e, multibody);
    recorder.read();
    const double end = run.driveTime.back();
    constexpr double kOpen = 1e-5; // m, joint gap per step that means too long steps
    while (multibody.time() < end && out.failure.empty() && !out.stopped) {
        multibody.advance(std::min(resolution.freeStep, end + 1e-6 - multibody.time()));
        recorder.read();
        if (!(multibody.jointGap() < kOpen) || !std::isfinite(multibody.energy()))
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
