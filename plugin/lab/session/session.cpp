#include "plugin/lab/session/session.h"

#include "plugin/scene/player/dropper.h"
#include "supercircle/contact/crossing.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

namespace supercircle::lab {

namespace {

using rod::Vec2;

/// Ids of the bodies that own the outlines, ascending: the order of the recorded bodies.
std::vector<step::BodyId> bodiesOf(const std::vector<step::BodyOutline>& outlines) {
    std::vector<step::BodyId> ids;
    for (const step::BodyOutline& o : outlines)
        ids.push_back(o.body);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

/// m; the absolute settings are for shells of this radius and scale with it: vibration periods grow with the size.
constexpr double kPaperRadius = 0.0192;
/// R, crosshead travel within which an abrupt snap is over and a smooth one is not.
constexpr double kReleaseWindow = 0.05;
/// s, longest step while the crosshead does not move.
constexpr double kFreeFrame = 4e-3;

/// Radius of the smallest shell over that of the paper's. A flat shell counts as three quarters of a circle.
double sizeRatioOf(const scene::Scene& scene) {
    double smallest = std::numeric_limits<double>::infinity();
    const auto take = [&](const ShellDef& d) {
        const double length = d.length > 0.0 ? d.length : 2.0 * M_PI * d.phi_bar * d.radius;
        const double radius = d.radius <= length ? d.radius : length / (1.5 * M_PI);
        if (radius > 0.0)
            smallest = std::min(smallest, radius);
    };
    for (const ShellDef& d : scene.shells)
        take(d);
    if (scene.drop)
        take(scene.drop->shell);
    return std::isfinite(smallest) ? smallest / kPaperRadius : 1.0;
}

} // namespace

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Session::Session(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const RunOptions& options)
    : scene_(scene), host_(std::move(host)), options_(options), shells_(host_), random_(options.seed),
      energyRelease_(kReleaseWindow * scene.report.R), wallStart_(wallSeconds()), cpuStart_(cpuSeconds()) {
    lastCheckpoint_ = wallStart_;
    repeatable_ = whyNoCheckpoint(scene).empty();
    accuracy_ = options.accuracy.value_or(scene.numerics.accuracy);
    step::Settings& s = shells_.stepper().settings();
    sizeRatio_ = sizeRatioOf(scene);
    s.dtMin = scene.numerics.dt_min > 0.0 ? scene.numerics.dt_min : 1e-6 * sizeRatio_;
    if (scene.numerics.dt_max > 0.0)
        s.dtMin = std::min(s.dtMin, scene.numerics.dt_max);
    fixedDt_ = options.fixedDt > 0.0 ? options.fixedDt : scene.numerics.fixed_dt;
    s.contact.tolerance = scene.numerics.tolerance;
    s.secondOrder = secondOrder_ = !scene.numerics.quasi_static.value_or(scene.protocol.has_value());
    double thickness = scene.drop ? scene.drop->shell.thickness : std::numeric_limits<double>::infinity();
    for (const ShellDef& d : scene.shells)
        thickness = std::min(thickness, d.thickness);
    setStepLimits(0.0);
    if (std::isfinite(thickness) && thickness > 0.0)
        s.localError =
            (scene.numerics.position_tolerance > 0.0 ? scene.numerics.position_tolerance : 5e-6 * sizeRatio_) /
            thickness;
    localError_ = s.localError;
    motionLimit_ = s.motionLimit;
    s.threads = options.threads;
    shells_.stepper().loop = options.loop;
    s.crossingCheck = options.crossingCheck;
    shells_.stepper().onSolve = options.onSolve;
    shells_.stepper().watchStages(options.onStage);
    out_.scene = scene.name;
    out_.about = scene.about;
    out_.R = scene.report.R;
    out_.B = scene.report.B;
    if (out_.B <= 0.0 && !scene.shells.empty())
        out_.B = bending_modulus(scene.shells.front());
    if (out_.B <= 0.0 && scene.drop)
        out_.B = bending_modulus(scene.drop->shell);
    const effects::Model common = effects::modelFor(scene.effects, "all");
    apparatus_ = common.apparatus;
    sensor_ = effects::SensorChain(common.sensor);
    sensorOn_ = common.sensor.on();
    for (const scene::Parameter& p : scene.parameters)
        out_.parameters.emplace_back(p.name, p.value);
    out_.series.names = {"time_s",
                         "displacement_m",
                         "force_N",
                         "work_in_J",
                         "elastic_J",
                         "gravity_J",
                         "kinetic_J",
                         "friction_J",
                         "impact_J",
                         "numerical_dissipation_J",
                         "position_correction_J",
                         "effects_J",
                         "residual_J",
                         "dt_s",
                         "contact_residual"};
    out_.series.columns.resize(out_.series.names.size());
}

/// The longest step is a length of crosshead travel, so the cost of a quasi-static test does not depend on its speed.
/// It is R / 500, or less on a short branch, because a loading branch is to have at least 500 samples. The step-size
/// controller provides the accuracy.
void Session::setStepLimits(double speed, double branch) {
    step::Settings& s = shells_.stepper().settings();
    s.fixedDt = fixedDt_;
    s.dtMax = scene_.numerics.dt_max;
    const double travel = std::min(scene_.report.R, 0.8 * branch) / 500.0;
    if (s.dtMax <= 0.0)
        s.dtMax =
            sizeRatio_ * (speed == 0.0 ? kFreeFrame : std::clamp(travel / (sizeRatio_ * std::abs(speed)), 1e-3, 1.0));
    frame_ = s.fixedDt > 0.0 ? s.fixedDt : s.dtMax;
}

void Session::addEffects(std::size_t rod, const std::string& shell) {
    step::setEffectSettings(shells_.world(), rod, effects::settingsFor(scene_.effects, shell));
}

std::string Session::populate() {
    std::vector<std::pair<std::string, ShellHandle>> named;
    for (const ShellDef& d : scene_.shells) {
        const auto made = shells_.create(d);
        if (!made)
            return "shell \"" + d.name + "\": " + made.error();
        named.emplace_back(d.name, *made);
        addEffects(shells_.size() - 1, d.name);
        addShellInfo(shells_.size() - 1);
    }
    for (const HoldDef& h : scene_.holds) {
        const auto it = std::find_if(named.begin(), named.end(), [&](const auto& n) { return n.first == h.shell; });
        if (it == named.end())
            return "hold: there is no shell called \"" + h.shell + "\"";
        const auto made = shells_.create_hold(it->second, h.arc_fraction, h.kind, h.base);
        if (!made)
            return "hold on \"" + h.shell + "\": " + made.error();
    }
    for (step::Rod& rod : shells_.world().rods)
        for (step::Hold& hold : rod.holds)
            hold.turnStiffness = hold.clamped ? effects::turnStiffness(apparatus_) : 0.0;
    for (const scene::PointLoad& load : scene_.loads) {
        const auto it = std::find_if(named.begin(), named.end(), [&](const auto& n) { return n.first == load.shell; });
        if (it == named.end())
            return "load: there is no shell called \"" + load.shell + "\"";
        const auto made = shells_.create_force(it->second, load.arc_fraction, load.force, load.moment);
        if (!made)
            return "load on \"" + load.shell + "\": " + made.error();
        if (load.released)
            released_.push_back(*made);
    }
    if (scene_.protocol && !scene_.protocol->body.empty() && !shells_.attach_to_crosshead(scene_.protocol->body))
        return "protocol: there is no body called \"" + scene_.protocol->body + "\"";
    step::World& w = shells_.world();
    shells_.stepper().readHost(w, *host_, frame_);
    describeOutlines();
    std::vector<contact::RodCurve> curves(w.rods.size());
    std::vector<contact::Outline> outlines;
    for (std::size_t i = 0; i < w.rods.size(); ++i)
        step::toCurve(w.rods[i], w.rods[i].kin, curves[i]);
    for (const step::BodyOutline& o : w.outlines)
        for (const step::Body& b : w.bodies)
            if (b.id == o.body) {
                outlines.push_back(step::placed(o, b.state.centre, b.state.angle));
                outlines.back().key = static_cast<std::uint32_t>(outlines.size() - 1);
            }
    std::vector<contact::Crossing> crossings;
    contact::findCrossings(curves, outlines, crossings);
    contact::Detector detector;
    std::vector<contact::Candidate> near;
    detector.detect(curves, outlines, {0.0}, near);
    const auto shellName = [&](int i) {
        const std::string& n = scene_.shells[static_cast<std::size_t>(i)].name;
        return n.empty() ? "shell " + std::to_string(i) : "shell \"" + n + "\"";
    };
    if (!crossings.empty())
        return shellName(crossings.front().rodA) + " crosses " +
               (crossings.front().rodB >= 0 ? shellName(crossings.front().rodB) : std::string("a rigid body")) +
               " at the start; move it away";
    for (const contact::Candidate& c : near)
        if (c.gap < -0.01 * curves[static_cast<std::size_t>(c.a.rod)].halfThickness) {
            char overlap[32];
            std::snprintf(overlap, sizeof overlap, "%.4g mm", -1e3 * c.gap);
            return shellName(c.a.rod) + " overlaps " +
                   (c.b.rod >= 0 ? shellName(c.b.rod) : std::string("a rigid body")) + " by " + overlap +
                   " at the start; start from a touching or free state";
        }
    return {};
}

void Session::describeOutlines() {
    std::vector<step::BodyOutline> all;
    host_->everything(all);
    const std::vector<step::BodyId> ids = bodiesOf(all);
    for (const step::BodyOutline& o : all) {
        record::OutlineInfo info;
        using Kind = contact::OutlineKind;
        info.kind = o.local.kind == Kind::Circle    ? record::OutlineInfo::Kind::Circle
                    : o.local.kind == Kind::Polygon ? record::OutlineInfo::Kind::Polygon
                                                    : record::OutlineInfo::Kind::Polyline;
        for (const Vec2& p : o.local.points)
            info.points.push_back({p.x(), p.y()});
        info.radius = o.local.radius;
        for (const step::Body& b : shells_.world().bodies)
            info.driven = info.driven || (b.id == o.body && b.driven);
        info.body = static_cast<std::int32_t>(std::lower_bound(ids.begin(), ids.end(), o.body) - ids.begin());
        out_.outlines.push_back(std::move(info));
    }
}

void Session::addShellInfo(std::size_t rod) {
    const rod::RodModel& m = shells_.world().rods[rod].model;
    record::ShellInfo info;
    info.name = "shell " + std::to_string(rod + 1);
    info.length = m.definition().length;
    info.thickness = m.definition().thickness;
    info.bending_modulus = m.definition().bendingModulus;
    info.closed = m.definition().closed;
    for (int i = 0; i < m.elements(); ++i)
        info.element_length.push_back(m.elementLength(i));
    info.natural_curvature = m.definition().naturalCurvature;
    out_.shells.push_back(std::move(info));
}

double Session::pileTop() const {
    return player::pileTop(shells_.world());
}

double Session::crossheadBottom() const {
    const step::World& w = shells_.world();
    double bottom = std::numeric_limits<double>::infinity();
    std::vector<step::BodyOutline> all;
    host_->everything(all);
    for (const step::Body& b : w.bodies)
        if (b.driven)
            for (const step::BodyOutline& o : all)
                if (o.body == b.id)
                    for (const Vec2& p : step::placed(o, b.state.centre, b.state.angle).points)
                        bottom = std::min(bottom, p.y() - o.local.radius);
    return bottom;
}

double Session::force() const {
    if (!scene_.protocol)
        return 0.0;
    const Point f = shells_.crosshead_force();
    return -(f.x * scene_.protocol->direction.x + f.y * scene_.protocol->direction.y);
}

/// What the drive shows: travel of the crosshead, compliance of the frame, and backlash.
double Session::travel() const {
    if (!scene_.protocol)
        return 0.0;
    const Vec2 t = shells_.world().crossheadTravel;
    const double crosshead = t.x() * scene_.protocol->direction.x + t.y() * scene_.protocol->direction.y - zeroTravel_;
    if (!apparatus_.on())
        return crosshead;
    const double f = force();
    return crosshead + apparatus_.compliance * f + apparatus_.bedding * std::max(largestForce_, f) -
           (reversed_ ? apparatus_.backlash : 0.0) +
           (apparatus_.slack > 0.0 ? 0.5 * apparatus_.slack * f / math::hypot(f, apparatus_.slackForce) : 0.0);
}

/// False: the run is interrupted.
bool Session::beginFrame() {
    keepCheckpoint();
    if (!interrupted())
        return true;
    status_ = RunStatus::Interrupted;
    message_ = "interrupted";
    return false;
}

bool Session::frame(double dt, const std::function<bool()>& stop) {
    if (!beginFrame())
        return false;
    return endFrame(shells_.pre_step(dt, [&] {
        record();
        return stopsAtOnce() || (stop && stop());
    }));
}

/// Lets the host follow; false: the run is over.
bool Session::endFrame(const FrameReport& r) {
    std::string failure = r.failure;
    if (r.advanced > 0.0) {
        host_->step(r.advanced);
        if (const Status stepped = shells_.post_step(); !stepped && failure.empty())
            failure = stepped.error();
    }
    if (!failure.empty()) {
        status_ = RunStatus::Failed;
        message_ = failure + " (at t = " + std::to_string(shells_.time()) + " s)";
        return false;
    }
    // A game continues without a quarantined shell and with shells that cross each other, an experiment cannot.
    const bool cross = shells_.world().counters.crossings > 0 || !shells_.world().overlaps.empty();
    if (cross || shells_.world().counters.quarantined > 0) {
        status_ = RunStatus::Failed;
        message_ = std::string(
                       cross ? "shells would cross even at the smallest step"
                             : "an element of a shell curled up to more than a circle, or its numbers were not finite, "
                               "and the shell was taken out of the motion") +
                   " (at t = " + std::to_string(shells_.time()) +
                   " s); look for shells put into each other or driven too fast";
        return false;
    }
    return true;
}

void Session::keepFrame(bool always) {
    const step::World& w = shells_.world();
    if (!options_.keepFrames || (!always && w.time < nextFrameTime_))
        return;
    nextFrameTime_ = w.time + std::max(scene_.report.sample_dt, 1e-4);
    record::Frame f;
    f.time = w.time;
    f.displacement = inProtocol_ ? travel() : 0.0;
    f.force = inProtocol_ ? force() : 0.0;
    f.phase = phase_;
    for (const step::Rod& r : w.rods) {
        record::ShellPose p;
        p.start = {r.kin.node(0).x(), r.kin.node(0).y()};
        p.angle = r.kin.arcs().front().angle;
        for (const rod::Arc& a : r.kin.arcs())
            p.curvature.push_back(static_cast<float>(a.curvature));
        p.bending_energy = rod::bendingEnergy(r.model, r.q);
        f.shells.push_back(std::move(p));
    }
    std::vector<step::BodyOutline> all;
    host_->everything(all);
    const std::vector<step::BodyId> ids = bodiesOf(all);
    for (const step::BodyId id : ids) {
        step::BodyState s = host_->stateOf(id);
        for (const step::Body& b : w.bodies)
            if (b.id == id)
                s = b.state;
        f.bodies.push_back({s.centre.x(), s.centre.y(), s.angle});
    }
    step::Stepper& stepper = shells_.stepper();
    const Eigen::VectorXd& r = stepper.lastImpulses();
    const auto& candidates = stepper.lastCandidates();
    const double dt = stepper.lastDt();
    for (std::size_t i = 0; dt > 0.0 && i < candidates.size() && 2 * i + 1 < static_cast<std::size_t>(r.size()); ++i) {
        const double rn = r[static_cast<Eigen::Index>(2 * i)], rt = r[static_cast<Eigen::Index>(2 * i + 1)];
        if (rn <= 0.0)
            continue;
        const Vec2 n = candidates[i].normal, force = (n * rn + rod::perp(n) * rt) / dt;
        const bool slips = std::abs(rt) >= stepper.lastProblem().contacts[i].mu * rn * (1.0 - 1e-9);
        f.contacts.push_back({candidates[i].pointA.x(), candidates[i].pointA.y(), force.x(), force.y(), slips});
    }
    out_.frames.push_back(std::move(f));
}

void Session::reportProgress(double fraction) {
    if (options_.progress)
        options_.progress({phase_, std::clamp(fraction, 0.0, 1.0), shells_.time(), inProtocol_ ? force() : 0.0,
                           inProtocol_ ? travel() : 0.0});
}

bool Session::settle(double speed, double longest) {
    if (begins())
        at_.start = shells_.time();
    while (shells_.time() - at_.start < longest) {
        if (!frame(frame_, {}))
            return false;
        if (player::fastest(shells_.world()) < speed && shells_.time() - at_.start > 0.05)
            break;
    }
    return true;
}

/// Lets the shells come to rest with vibration damped, then takes the released loads away and starts the clock.
void Session::settleAtStart() {
    constexpr double kLongest = 2.0; // s, for a radius of 19.2 mm: a thousand periods
    phase_ = "settle";
    step::Settings& settings = shells_.stepper().settings();
    settings.secondOrder = false;
    nextSampleTime_ = nextFrameTime_ = std::numeric_limits<double>::infinity();
    const bool rests = step::comeToRest(shells_.world(), effects::ViscousMoments::Gone,
                                        [&] { return settle(0.0, kLongest * sizeRatio_); });
    settings.secondOrder = secondOrder_;
    if (!rests)
        return;
    for (const ForceHandle force : released_)
        shells_.destroy(force).or_fail();
    step::World& w = shells_.world();
    for (std::size_t i = 0; i < w.rods.size(); ++i)
        step::placeRod(w, i, w.rods[i].q, Eigen::VectorXd::Zero(w.rods[i].model.dofs()));
    w.time = nextSampleTime_ = nextFrameTime_ = 0.0;
}

/// Drops `count` shells side by side, in rows above the pile. Empty, or why it cannot.
std::string Session::dropBatch(int count) {
    const std::size_t before = shells_.size();
    std::vector<ShellHandle> made;
    if (const Status dropped = player::dropBatch(shells_, *scene_.drop, count, random_, made); !dropped)
        return dropped.error();
    for (std::size_t i = before; i < shells_.size(); ++i) {
        addEffects(i, {});
        addShellInfo(i);
    }
    keepFrame(true);
    return {};
}

void Session::drop() {
    const scene::Drop& d = *scene_.drop;
    // A random start needs no accurate trajectory: steps may be coarser while the shells fall.
    step::Settings& settings = shells_.stepper().settings();
    settings.localError = std::max(localError_, 0.3);
    settings.motionLimit = 2.0 * motionLimit_;
    if (d.adaptive) {
        settings.fixedDt = 0.0;
        frame_ = settings.dtMax;
    }
    while (status_ == RunStatus::Done && (resumes_ || at_.dropped < d.count)) {
        if (!resumes_) {
            const int count = std::min(d.batch_size, d.count - at_.dropped);
            phase_ = "drop " + std::to_string(at_.dropped + 1);
            if (const std::string error = dropBatch(count); !error.empty()) {
                status_ = RunStatus::BadScene;
                message_ = "drop: " + error;
                return;
            }
            reportProgress(0.3 * at_.dropped / d.count);
            at_.dropped += count;
        }
        if (at_.dropped < d.count)
            settle(d.settle_speed, d.settle_time);
        else
            settle(d.final_settle_speed, d.final_settle_time);
    }
    settings.localError = localError_;
    settings.motionLimit = motionLimit_;
    setStepLimits(0.0);
}

} // namespace supercircle::lab
