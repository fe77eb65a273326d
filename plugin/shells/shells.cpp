#include "plugin/include/supercircle/shells.hpp"

#include "plugin/shells/from_definition.h"
#include "plugin/shells/shells_impl.h"
#include "plugin/shells/snapshot_fields.h"

#include <atomic>
#include <cmath>
#include <utility>

namespace supercircle {

namespace {

/// Steps of the longest size in one frame; a frame that needs more is a slip of the pen, not a frame.
constexpr double kMostSteps = 4096.0;

/// A number per Shells of this process; it only tells handles apart and touches no result.
std::uint32_t nextTag() {
    static std::atomic<std::uint32_t> last{0};
    return ++last;
}

} // namespace

Shells::Impl::Impl() : tag(nextTag()) {}

int Shells::Impl::find(ShellHandle h) const {
    if (h.null() || h.world != tag || h.index >= slots.size() || slots[h.index].generation != h.generation ||
        slots[h.index].key == 0)
        return -1;
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (world.rods[i].key == slots[h.index].key)
            return static_cast<int>(i);
    return -1;
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
    RodFromDefinition rod;
    if (std::string why = fromDefinition(definition, rod); !why.empty())
        return Result<ShellHandle>::failure(std::move(why));
    step::World& w = impl_->world;
    const std::size_t index = step::addRod(w, rod.definition, rod.q, rod.v, definition.mu);
    w.rods[index].category = definition.category;
    w.rods[index].mask = definition.mask;
    w.range.clear();
    const ShellHandle made = impl_->adopt(w.rods[index].key, definition.name, definition.user_data);
    impl_->recorder.record(Call::Create, impl_->inner, definition, made);
    return made;
}

bool Shells::destroy(ShellHandle shell) {
    const int i = impl_->find(shell);
    if (i < 0)
        return false;
    step::removeRod(impl_->world, static_cast<std::size_t>(i));
    impl_->world.range.clear();
    impl_->slots[shell.index].key = 0;
    impl_->recorder.record(Call::Destroy, impl_->inner, shell);
    return true;
}

std::size_t Shells::size() const {
    return impl_->world.rods.size();
}
bool Shells::valid(ShellHandle shell) const {
    return impl_->find(shell) >= 0;
}

Result<int> Shells::hold(ShellHandle shell, double arc_fraction, HoldKind kind, bool on_machine) {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<int>::failure("no such shell (stale or foreign handle)");
    if (!(arc_fraction >= 0.0 && arc_fraction <= 1.0))
        return Result<int>::failure("arc_fraction must lie between 0 and 1");
    step::Rod& rod = impl_->world.rods[static_cast<std::size_t>(i)];
    step::Hold h;
    h.s = arc_fraction * rod.model.definition().length;
    h.clamped = kind == HoldKind::Clamp;
    h.onMachine = on_machine;
    const rod::Place at = rod::locate(rod.model, h.s);
    h.target = rod.kin.point(at);
    h.targetAngle = rod.kin.angle(at);
    rod.holds.push_back(h);
    impl_->recorder.record(Call::Hold, impl_->inner, shell, arc_fraction, kind, on_machine);
    return static_cast<int>(rod.holds.size()) - 1;
}

bool Shells::carry(const std::string& body_name) {
    const step::BodyId id = impl_->port ? impl_->port->find(body_name) : 0;
    if (id == 0)
        return false;
    impl_->world.machineBodies.push_back(id);
    impl_->recorder.record(Call::Carry, impl_->inner, body_name);
    return true;
}

void Shells::set_machine_velocity(Point velocity) {
    if (!std::isfinite(velocity.x) || !std::isfinite(velocity.y))
        return; // would spoil every body and hold on the machine
    impl_->world.machineVelocity = {velocity.x, velocity.y};
    impl_->recorder.record(Call::MachineVelocity, impl_->inner, velocity);
}

Point Shells::machine_force() const {
    const rod::Vec2 f = impl_->world.machineForce();
    return {f.x(), f.y()};
}

FrameReport Shells::pre_step(double dt, const std::function<bool()>& observer) {
    FrameReport report;
    Impl& m = *impl_; // stays where it is, even if the observer moves this object
    if (m.inside) {
        report.failure = "pre_step: not from within its own observer";
        return report;
    }
    if (!m.hostFault.empty()) {
        report.failure = "post_step: " + std::exchange(m.hostFault, {});
        return report;
    }
    if (const double longest = kMostSteps * m.stepper.settings().dtMax; dt > longest && std::isfinite(dt)) {
        report.failure = "pre_step: a frame may last " + std::to_string(longest) + " s at most; take several";
        m.advanced = 0.0;
        return report;
    }
    const step::Counters before = m.world.counters;
    const auto handleOf = [&m](std::uint32_t key) { return m.handleOf(key); };
    m.inside = true;
    m.recorder.record(Call::PreStep, 0, dt);
    try {
        m.watch.begin(m.world);
        const step::FrameOutcome out = m.stepper.advance(m.world, dt, m.port.get(), [&](const step::World& world) {
            ++m.inner;
            m.watch.afterStep(world, m.stepper, handleOf);
            const bool stop = observer && observer();
            m.watch.remember(world);
            return stop;
        });
        report.advanced = out.advanced;
        report.stopped = out.stopped;
        report.failure = out.failure;
        m.watch.end(m.world, handleOf);
    } catch (const std::exception& e) { // the host program never dies of us
        report.failure = e.what();
    } catch (...) {
        report.failure = "the observer or the host threw something that is not a std::exception";
    }
    m.recorder.record(Call::FrameEnd, 0, m.inner, report.stopped);
    m.inside = false;
    m.inner = 0;
    m.advanced = report.advanced;
    report.steps = m.world.counters.steps - before.steps;
    report.unconverged = m.world.counters.unconverged - before.unconverged;
    return report;
}

void Shells::post_step() {
    if (impl_->inside)
        return;
    impl_->recorder.record(Call::PostStep, 0);
    try {
        if (impl_->port)
            step::Stepper::learnFromHost(impl_->world, *impl_->port, impl_->advanced);
    } catch (const std::exception& e) {
        impl_->hostFault = e.what(); // told by the next pre_step
    } catch (...) {
        impl_->hostFault = "the host threw something that is not a std::exception";
    }
    impl_->advanced = 0.0; // learnt once
}

Result<ShellPose> Shells::pose(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<ShellPose>::failure("no such shell (stale or foreign handle)");
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
