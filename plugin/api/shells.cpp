#include "plugin/api/include/supercircle/shells.hpp"

#include "plugin/api/from_definition.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/sleep.h"

#include <atomic>
#include <cmath>
#include <functional>

namespace supercircle {

namespace {

/// Steps of the longest size in one frame; a frame that needs more is a slip of the pen, not a frame.
constexpr double kMostSteps = 4096.0;
constexpr double kShortest = 1e-12; ///< s: velocities are differences of places over it

} // namespace

/// It only tells handles apart and touches no result.
std::uint32_t Shells::Impl::nextTag() {
    static std::atomic<std::uint32_t> last{0};
    return ++last;
}

int Shells::Impl::find(ShellHandle h) const {
    if (h.null() || h.world != tag || h.index >= slots.size() || slots[h.index].generation != h.generation ||
        slots[h.index].key == 0)
        return -1;
    return step::rodIndex(world, slots[h.index].key);
}

ShellHandle Shells::Impl::handleOf(std::uint32_t key) const {
    for (std::uint32_t i = 0; i < slots.size(); ++i)
        if (slots[i].key == key)
            return {i, slots[i].generation, tag};
    return {};
}

ShellHandle Shells::Impl::adopt(std::uint32_t key, std::string name, std::uint64_t userData) {
    std::uint32_t i = 0;
    while (i < slots.size() && slots[i].key != 0)
        ++i;
    if (i == slots.size())
        slots.emplace_back();
    slots[i].generation = ++slots[i].highest;
    slots[i].key = key;
    slots[i].name = std::move(name);
    slots[i].userData = userData;
    return {i, slots[i].generation, tag};
}

Shells::Shells(std::shared_ptr<step::Port> port) : impl_(std::make_unique<Impl>()) {
    impl_->port = std::move(port);
    if (impl_->port)
        impl_->world.gravity = impl_->port->gravity();
}
Shells::~Shells() = default;
Shells::Shells(Shells&&) noexcept = default;
Shells& Shells::operator=(Shells&&) noexcept = default;

Result<ShellHandle> Shells::create(const ShellDef& definition) {
    return impl_->change([&] {
        RodFromDefinition rod;
        if (std::string why = fromDefinition(definition, rod); !why.empty())
            return Result<ShellHandle>::failure(std::move(why));
        step::World& w = impl_->world;
        step::Rod& added = w.rods[step::addRod(w, rod.definition, rod.q, rod.v, definition.mu)];
        added.category = definition.category;
        added.mask = definition.mask;
        added.group = definition.group;
        added.material = definition.material;
        added.width = definition.width;
        const ShellHandle made = impl_->adopt(added.key, definition.name, definition.user_data);
        impl_->recorder.record(Call::Create, definition, made);
        return Result<ShellHandle>(made);
    });
}

Outcome Shells::destroy(ShellHandle shell) {
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

Outcome Shells::carry(const std::string& body_name) {
    return impl_->change([&] {
        const step::BodyId id = impl_->port ? impl_->port->find(body_name) : 0;
        if (id == 0)
            return refused("the host has no body called '" + body_name + "'");
        step::wakeAll(impl_->world);
        impl_->world.machineBodies.push_back(id);
        impl_->recorder.record(Call::Carry, body_name);
        return done();
    });
}

Outcome Shells::set_machine_velocity(Point velocity) {
    return impl_->change([&] {
        if (!(std::hypot(velocity.x, velocity.y) < 1e5))
            return refused("the machine's velocity must be finite and below 1e5 m/s");
        if (impl_->world.machineVelocity != vec(velocity))
            step::wakeAll(impl_->world);
        impl_->world.machineVelocity = vec(velocity);
        impl_->recorder.record(Call::MachineVelocity, velocity);
        return done();
    });
}

Point Shells::machine_force() const {
    const rod::Vec2 f = impl_->world.machineForce();
    return {f.x(), f.y()};
}

FrameReport Shells::pre_step(double dt, const std::function<bool()>& observer) {
    FrameReport report;
    Impl& m = *impl_; // stays where it is, even if the observer moves this object
    if (m.inside) {
        report.failure = kStepping;
        return report;
    }
    if (!(dt >= kShortest) || !std::isfinite(dt)) {
        report.failure = "pre_step: the frame must be a positive number of seconds, 1e-12 at least";
        m.advanced = 0.0;
        return report;
    }
    if (const double longest = kMostSteps * m.stepper.settings().dtMax; dt > longest) {
        report.failure = "pre_step: a frame may last " + std::to_string(longest) + " s at most; take several";
        m.advanced = 0.0;
        return report;
    }
    struct Inside { // until the call is over, however it ends
        bool& flag;
        explicit Inside(bool& f) : flag(f) { flag = true; }
        ~Inside() { flag = false; }
    };
    const step::Counters before = m.world.counters;
    const double start = m.world.time;
    std::uint64_t inner = 0; // steps
    std::string thrown;
    const auto handleOf = [&m](std::uint32_t key) { return m.handleOf(key); };
    const Outcome ended = Impl::caught([&] {
        const Inside inside(m.inside);
        m.watch.begin(m.world);
        const auto observe = [&](const step::World& world) {
            ++inner;
            m.watch.afterStep(world, m.stepper, handleOf);
            // An observer that throws stops the frame in order: else the host would never get this frame's impulses.
            const auto stop = Impl::caught([&] { return Result<bool>(observer && observer()); });
            m.watch.remember(world);
            if (!stop)
                thrown = stop.error();
            return !stop || *stop;
        };
        const step::FrameResult out = // by reference: it is too large for a function to hold without the heap
            m.stepper.advance(m.world, dt, m.port.get(), std::cref(observe));
        report.stopped = out.stopped;
        report.late = out.late;
        report.failure = out.failure.empty() ? thrown : out.failure;
        m.watch.end(m.world, handleOf);
        return done();
    });
    if (!ended)
        report.failure = ended.error();
    m.recorder.record(Call::PreStep, dt); // both here: a log taken by the observer has no frame without an end
    m.recorder.record(Call::FrameEnd, inner, report.stopped);
    report.advanced = m.world.time - start;
    m.advanced = report.advanced;
    report.steps = m.world.counters.steps - before.steps;
    report.unconverged = m.world.counters.unconverged - before.unconverged;
    return report;
}

std::uint32_t Shells::id() const {
    return impl_->tag;
}

Outcome Shells::post_step() {
    return impl_->change([&] {
        impl_->recorder.record(Call::PostStep);
        if (impl_->port)
            impl_->stepper.learnFromHost(impl_->world, *impl_->port, impl_->advanced);
        impl_->advanced = 0.0; // learnt once
        return done();
    });
}

Result<ShellPose> Shells::pose(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<ShellPose>::failure(kNoSuchShell);
    const step::Rod& rod = impl_->world.rods[static_cast<std::size_t>(i)];
    ShellPose p;
    p.start = {rod.kin.node(0).x(), rod.kin.node(0).y()};
    p.angle = rod.kin.arcs().front().angle;
    for (const rod::Arc& a : rod.kin.arcs())
        p.curvature.push_back(a.curvature);
    p.bending_energy = rod::bendingEnergy(rod.model, rod.q);
    return p;
}

EnergyBooks Shells::books() const {
    const step::Ledger& l = impl_->world.ledger;
    return {l.kinetic, l.bending,   l.gravity, l.added,   l.work,     l.friction,
            l.impact,  l.numerical, l.pushOut, l.effects, l.toBodies, l.residual()};
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
