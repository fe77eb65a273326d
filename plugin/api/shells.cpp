#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/api/frame_report.h"

#include "plugin/api/from_definition.h"
#include "plugin/api/limits.h"
#include "plugin/api/quality.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/sleep.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

namespace supercircle {

namespace {

constexpr double kMostSteps = 4096.0; ///< of the longest size in one frame
constexpr double kShortest = 1e-12;   ///< s: velocities are differences of positions over it

} // namespace

/// It only distinguishes handles; no result depends on it.
std::uint32_t Shells::Impl::nextWorldId() {
    static std::atomic<std::uint32_t> last{0};
    return ++last;
}

int Shells::Impl::find(ShellHandle h) const {
    if (h.null() || h.world != worldId || h.index >= slots.size() || slots[h.index].generation != h.generation ||
        slots[h.index].key == 0)
        return -1;
    const int index = step::rodIndex(world, slots[h.index].key);
    SC_ASSERT(index >= 0, "a slot in use names a rod of the world");
    return index;
}

ShellHandle Shells::Impl::handleOf(std::uint32_t key) const {
    for (std::uint32_t i = 0; i < slots.size(); ++i)
        if (slots[i].key == key)
            return {i, slots[i].generation, worldId};
    return {};
}

ShellHandle Shells::Impl::assignSlot(std::uint32_t key, std::string name, std::uint64_t userData) {
    SC_ASSERT(key != 0, "a rod has a key");
    SC_ASSERT(handleOf(key).null(), "a rod has one slot");
    std::uint32_t i = 0;
    while (i < slots.size() && slots[i].key != 0)
        ++i;
    if (i == slots.size())
        slots.emplace_back();
    SC_ASSERT(slots[i].generation <= slots[i].highest, "no generation is given out twice");
    slots[i].generation = ++slots[i].highest;
    slots[i].key = key;
    slots[i].name = std::move(name);
    slots[i].userData = userData;
    return {i, slots[i].generation, worldId};
}

std::shared_ptr<Shells::Impl> Shells::Impl::movedFrom() {
    // Never destroyed, because static objects may be used until the very end; not owned, so that moving cannot fail.
    static Impl* const nothing = [] {
        auto* made = new Impl;
        made->gone = true;
        return made;
    }();
    return {std::shared_ptr<Impl>(), nothing};
}

Shells::Shells(std::shared_ptr<step::Port> port) : impl_(std::make_shared<Impl>()) {
    (void)Impl::movedFrom(); // made where an allocation may fail
    impl_->port = std::move(port);
    impl_->stepper.settings() = settingsFor(Quality::Laboratory, impl_->stepper.settings());
    if (impl_->port)
        impl_->world.gravity = impl_->port->gravity();
}
Shells::~Shells() = default;
Shells::Shells(Shells&& other) noexcept : impl_(std::exchange(other.impl_, Impl::movedFrom())) {}
Shells& Shells::operator=(Shells&& other) noexcept {
    impl_ = std::exchange(other.impl_, Impl::movedFrom());
    return *this;
}

Result<ShellHandle> Shells::create(const ShellDef& definition) {
    return impl_->change([&] {
        const Result<RodFromDefinition> rod = fromDefinition(definition);
        if (!rod)
            return Result<ShellHandle>::failure(rod.error());
        step::World& w = impl_->world;
        step::Rod& added = w.rods[step::addRod(w, rod->definition, rod->q, rod->v, definition.mu)];
        added.category = definition.category;
        added.mask = definition.mask;
        added.group = definition.group;
        added.material = definition.friction_material;
        added.width = definition.width;
        added.dampingRatio = definition.damping_ratio;
        step::setEffectSettings(w, w.rods.size() - 1, impl_->effectsOfNew);
        const ShellHandle made = impl_->assignSlot(added.key, definition.name, definition.user_data);
        impl_->recorder.record(Call::Create, definition, made);
        return Result<ShellHandle>(made);
    });
}

Status Shells::destroy(ShellHandle shell) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        step::removeRod(impl_->world, static_cast<std::size_t>(i));
        impl_->slots[shell.index].key = 0;
        impl_->recorder.record(Call::Destroy, shell);
        return done();
    });
}

std::size_t Shells::size() const {
    return impl_->world.rods.size();
}
bool Shells::valid(ShellHandle shell) const {
    return impl_->find(shell) >= 0;
}

Status Shells::attach_to_crosshead(const std::string& body_name) {
    return impl_->change([&] {
        const step::BodyId id = impl_->port ? impl_->port->find(body_name) : 0;
        if (id == 0)
            return refused("there is no body called '" + body_name + "'");
        step::wakeAll(impl_->world);
        impl_->world.crossheadBodies.push_back(id);
        impl_->recorder.record(Call::AttachToCrosshead, body_name);
        return done();
    });
}

Status Shells::set_crosshead_velocity(Point velocity) {
    return impl_->change([&] {
        if (!(math::hypot(velocity.x, velocity.y) < 1e5))
            return refused("the crosshead's velocity must be finite and below 1e5 m/s");
        if (impl_->world.crossheadVelocity != vec(velocity))
            step::wakeAll(impl_->world);
        impl_->world.crossheadVelocity = vec(velocity);
        impl_->recorder.record(Call::SetCrossheadVelocity, velocity);
        return done();
    });
}

Point Shells::crosshead_force() const {
    const rod::Vec2 f = impl_->world.crossheadForce();
    return {f.x(), f.y()};
}

namespace {

/// Detects events in the steps of a frame, and calls the user's observer.
class FrameWatch : public step::FrameObserver {
public:
    FrameWatch(EventDetector& detector, const step::Stepper& stepper, EventDetector::HandleOf handleOf,
               std::function<bool()> observer)
        : detector_(detector), stepper_(stepper), handleOf_(std::move(handleOf)), observer_(std::move(observer)) {}

    /// An observer may ask about any shell.
    [[nodiscard]] bool wantsWholeWorld() const override { return static_cast<bool>(observer_); }
    void beginIslands() override { detector_.keep(); }
    void beginAgain() override { detector_.forget(); }
    void begin(const step::World& stepped) override { detector_.recordStart(stepped); }
    bool afterStep(const step::World& stepped) override {
        ++steps;
        detector_.afterStep(stepped, stepper_, handleOf_);
        const bool stop = observer_ && observer_();
        detector_.recordStart(stepped);
        return stop;
    }

    std::uint64_t steps = 0;

private:
    EventDetector& detector_;
    const step::Stepper& stepper_;
    EventDetector::HandleOf handleOf_;
    std::function<bool()> observer_; ///< does not throw
};

/// No call changes the shells meanwhile; reset however the call ends.
class SteppingLock {
public:
    explicit SteppingLock(bool& flag) : flag_(flag) { flag_ = true; }
    ~SteppingLock() { flag_ = false; }
    SteppingLock(const SteppingLock&) = delete;
    SteppingLock& operator=(const SteppingLock&) = delete;

private:
    bool& flag_;
};

} // namespace

FrameReport Shells::pre_step(double dt, const std::function<bool()>& observer) {
    FrameReport report;
    const std::shared_ptr<Impl> kept = impl_; // the observer may move this object
    Impl& m = *kept;
    if (m.gone || m.stepping) {
        report.failure = m.gone ? kMovedFrom : kWorldLocked;
        return report;
    }
    if (dt == 0.0) {
        m.advanced = 0.0;
        m.detector.events = {};
        m.recorder.record(Call::PreStep, dt);
        m.recorder.record(Call::FrameEnd, std::uint64_t{0}, false, false);
        return report;
    }
    if (!(dt >= kShortest) || !std::isfinite(dt)) {
        report.bad_input = true;
        report.failure = "dt: a frame lasts 0 s (a pause), or 1e-12 s at least";
        m.advanced = 0.0;
        return report;
    }
    if (const double longest = kMostSteps * m.stepper.settings().dtMax; dt > longest) {
        report.bad_input = true;
        report.failure = "dt: a frame lasts " + std::to_string(longest) + " s at most; take several";
        m.advanced = 0.0;
        return report;
    }
    const FrameStart before(m.world);
    const double start = m.world.time;
    std::uint64_t inner = 0; // steps
    std::string thrown;
    const Status ended = Impl::withoutExceptions([&] {
        const SteppingLock lock(m.stepping);
        m.recordStart();
        m.detector.begin(m.world);
        // An observer that throws ends the frame regularly: the host still gets the impulses of this frame.
        const auto guarded = [&] {
            const auto stop = Impl::withoutExceptions([&] { return Result<bool>(observer()); });
            if (!stop)
                thrown = stop.error();
            return !stop || *stop;
        };
        FrameWatch watch( // by reference: std::function would allocate for a copy
            m.detector, m.stepper, [&m](std::uint32_t key) { return m.handleOf(key); },
            observer ? std::function<bool()>(std::cref(guarded)) : nullptr);
        const step::FrameResult out = m.stepper.advance(m.world, dt, m.port.get(), watch);
        inner = watch.steps;
        for (const std::uint32_t key : out.carried)
            m.forgetStart(key);
        report.stopped = out.stopped;
        report.budget_exhausted = out.budgetExhausted;
        report.work = out.work;
        report.energy_gained = out.gained;
        report.refused = out.refused;
        if (m.port)
            report.note = m.port->takeNote();
        report.failure = out.failure.empty() ? thrown : out.failure;
        const auto handleOf = [&m](std::uint32_t key) { return m.handleOf(key); };
        m.detector.end(m.world, handleOf);
        m.tell(out);
        for (const step::Rod& r : m.world.rods)
            if (r.quarantined)
                report.quarantined.push_back(quarantineOf(r, handleOf));
        return done();
    });
    if (!ended)
        report.failure = ended.error();
    m.recorder.record(Call::PreStep, dt); // both here: a log taken by the observer has no unfinished frame
    m.recorder.record(Call::FrameEnd, inner, report.stopped, static_cast<bool>(observer));
    report.advanced = m.world.time - start;
    m.advanced = report.advanced;
    SC_ASSERT(m.world.counters.steps >= before.counters.steps &&
                  m.world.counters.unconverged >= before.counters.unconverged,
              "counts only grow");
    complete(report, m.world, m.stepper.settings(), before, dt, m.detector.events);
    return report;
}

/// Events that the stepper finds itself.
void Shells::Impl::tell(const step::FrameResult& frame) {
    for (const step::Crushed& c : frame.crushed) {
        const ShellHandle shell = handleOf(c.rod);
        const HoldHandle hold = c.hold != 0 ? HoldHandle{c.rod, c.hold, worldId} : HoldHandle{};
        detector.events.crushed.push_back({c.time, shell, c.body, hold});
    }
    for (const step::Broken& b : frame.broken) {
        const ShellHandle shell = handleOf(b.rod);
        BrokeEvent event{b.time, shell, {}, {}, point(b.force)};
        if (b.link)
            event.joint = {0, b.key, worldId};
        else
            event.hold = {b.rod, b.key, worldId};
        detector.events.broke.push_back(event);
    }
}

std::uint32_t Shells::id() const {
    return impl_->worldId;
}

Status Shells::post_step() {
    return impl_->change([&] {
        impl_->recorder.record(Call::PostStep);
        const std::shared_ptr<Impl> kept = impl_; // the host may be the user's, and move this object
        const SteppingLock lock(kept->stepping);  // the pair filter may be asked
        if (impl_->port)
            impl_->stepper.learnFromHost(impl_->world, *impl_->port, impl_->advanced);
        impl_->advanced = 0.0; // the host step counts once
        return done();
    });
}

namespace {

ShellPose poseOf(const rod::RodModel& model, const rod::Kinematics& kin, const Eigen::VectorXd& q) {
    ShellPose p;
    p.start = point(kin.node(0));
    p.angle = kin.arcs().front().angle;
    for (const rod::Arc& a : kin.arcs())
        p.curvature.push_back(a.curvature);
    p.bending_energy = rod::bendingEnergy(model, q);
    return p;
}

} // namespace

Result<ShellPose> Shells::pose(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<ShellPose>::failure(kNoSuchShell);
    const step::Rod& rod = impl_->rod(i);
    return poseOf(rod.model, rod.kin, rod.q);
}

Result<ShellPose> Shells::pose(ShellHandle shell, double alpha) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<ShellPose>::failure(kNoSuchShell);
    if (std::isnan(alpha))
        return Result<ShellPose>::failure("alpha must be a number: 0 is the start of the last frame, 1 its end");
    const step::Rod& rod = impl_->rod(i);
    const Eigen::VectorXd q = impl_->between(rod, alpha);
    rod::Kinematics kin;
    kin.evaluate(rod.model, q);
    return poseOf(rod.model, kin, q);
}

void Shells::Impl::recordStart() {
    startPoses.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        startPoses[i].key = world.rods[i].key;
        startPoses[i].q = world.rods[i].q;
    }
}

void Shells::Impl::forgetStart(std::uint32_t key) {
    std::erase_if(startPoses, [key](const StartPose& p) { return p.key == key; });
}

/// Coordinates are interpolated, not points: lengths stay.
Eigen::VectorXd Shells::Impl::between(const step::Rod& rod, double alpha) const {
    const auto at =
        std::find_if(startPoses.begin(), startPoses.end(), [&](const StartPose& p) { return p.key == rod.key; });
    if (at == startPoses.end() || at->q.size() != rod.q.size() || alpha >= 1.0)
        return rod.q;
    const double share = std::max(alpha, 0.0);
    return (1.0 - share) * at->q + share * rod.q;
}

Status Shells::shift_origin(Point new_origin) {
    return impl_->change([&] {
        if (!limits::position(new_origin))
            return refused("the new origin must be finite and within 1e12 m");
        Impl& m = *impl_;
        const step::Vec2 by = vec(new_origin);
        struct Seen {
            bool state = false, last = false; ///< the body was where the world or its coupling have it
        };
        std::vector<Seen> seen(m.world.bodies.size());
        step::BodyState now;
        for (std::size_t i = 0; i < seen.size(); ++i)
            if (const step::Body& b = m.world.bodies[i]; m.port && m.port->state(b.id, now))
                seen[i] = {now.centre == b.state.centre, now.centre == b.hostCoupling.seen.centre};
        if (m.port)
            if (std::string why = m.port->shiftOrigin(by); !why.empty())
                return refused(std::move(why));
        step::shiftOrigin(m.world, by);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            step::Body& b = m.world.bodies[i];
            if (!m.port || !m.port->state(b.id, now))
                continue;
            if (seen[i].state) // the host rounds: nobody has moved the body
                b.state.centre = now.centre;
            if (seen[i].last)
                b.hostCoupling.seen.centre = now.centre;
        }
        for (ContactPairState& t : m.detector.state.pairs) {
            t.last.point.x -= new_origin.x;
            t.last.point.y -= new_origin.y;
        }
        for (Impl::StartPose& p : m.startPoses)
            if (const int i = step::rodIndex(m.world, p.key); i >= 0)
                p.q.segment<2>(m.rod(i).model.dofX()) -= by;
        m.recorder.record(Call::ShiftOrigin, new_origin);
        return done();
    });
}

EnergyBalance Shells::energy_balance() const {
    const step::EnergyBalance& l = impl_->world.energyBalance;
    EnergyBalance e;
    e.kinetic = l.kinetic;
    e.bending = l.bending;
    e.gravity = l.gravity;
    e.added = l.added;
    e.work = l.work;
    e.friction = l.friction;
    e.impact = l.impact;
    e.numerical = l.numerical;
    e.position_correction = l.positionCorrection;
    e.injected = l.injected.sum();
    e.effects = l.effects;
    e.damping = l.damping;
    e.to_bodies = l.toBodies;
    e.residual = l.residual();
    return e;
}

double Shells::time() const {
    return impl_->world.time;
}
step::World& Shells::world() {
    return impl_->world;
}
const step::World& Shells::world() const {
    return impl_->world;
}
step::Stepper& Shells::stepper() {
    return impl_->stepper;
}
std::shared_ptr<step::Port> Shells::host() const {
    return impl_->port;
}

} // namespace supercircle
