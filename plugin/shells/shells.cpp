#include "plugin/include/supercircle/shells.hpp"

#include "plugin/shells/from_definition.h"
#include "plugin/shells/shells_impl.h"

#include <cmath>

namespace supercircle {

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
    std::uint32_t slot = 0;
    while (slot < impl_->slots.size() && impl_->slots[slot].key != 0)
        ++slot;
    if (slot == impl_->slots.size())
        impl_->slots.emplace_back();
    impl_->slots[slot].generation++;
    impl_->slots[slot].key = w.rods[index].key;
    return ShellHandle{slot, impl_->slots[slot].generation, impl_->tag};
}

bool Shells::destroy(ShellHandle shell) {
    const int i = impl_->find(shell);
    if (i < 0)
        return false;
    step::removeRod(impl_->world, static_cast<std::size_t>(i));
    impl_->world.range.clear();
    impl_->slots[shell.index].key = 0;
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
    return static_cast<int>(rod.holds.size()) - 1;
}

bool Shells::carry(const std::string& body_name) {
    const step::BodyId id = impl_->port ? impl_->port->find(body_name) : 0;
    if (id == 0)
        return false;
    impl_->world.machineBodies.push_back(id);
    return true;
}

void Shells::set_machine_velocity(Point velocity) {
    impl_->world.machineVelocity = {velocity.x, velocity.y};
}

Point Shells::machine_force() const {
    const rod::Vec2 f = impl_->world.machineForce();
    return {f.x(), f.y()};
}

FrameReport Shells::pre_step(double dt, const std::function<bool()>& observer) {
    FrameReport report;
    const step::Counters before = impl_->world.counters;
    try {
        const step::FrameOutcome out = impl_->stepper.advance(
            impl_->world, dt, impl_->port.get(), [&](const step::World&) { return observer && observer(); });
        report.advanced = out.advanced;
        report.stopped = out.stopped;
        report.failure = out.failure;
    } catch (const std::exception& e) { // the host program never dies of us
        report.failure = e.what();
    }
    impl_->advanced = report.advanced;
    report.steps = impl_->world.counters.steps - before.steps;
    report.unconverged = impl_->world.counters.unconverged - before.unconverged;
    return report;
}

void Shells::post_step() {
    if (impl_->port)
        step::Stepper::learnFromHost(impl_->world, *impl_->port, impl_->advanced);
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
