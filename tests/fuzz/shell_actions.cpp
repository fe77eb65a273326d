#include "tests/fuzz/shell_actions.h"

namespace supercircle::fuzz {

namespace {

constexpr std::size_t kMostHandles = 20;
constexpr int kOdd = 10; ///< of 256 numbers are extreme or not finite

/// An existing handle, or an invented one.
template <class H>
H pick(const std::vector<H>& made, ByteSource& bytes) {
    if (!made.empty() && bytes.chance(230))
        return made[bytes.below(static_cast<std::uint32_t>(made.size()))];
    return {bytes.below(10), bytes.below(10), bytes.below(5)};
}

template <class H>
bool keep(const Result<H>& made, std::vector<H>& list) {
    if (!made)
        return false;
    list.push_back(*made);
    if (list.size() > kMostHandles)
        list.erase(list.begin());
    return true;
}

bool ok(const Status& outcome) {
    return static_cast<bool>(outcome);
}

/// A target near the present one.
TargetDef nearby(const Result<TargetDef>& present, ByteSource& bytes) {
    TargetDef d = present ? *present : TargetDef{};
    const Point by = bytes.point(0.002, kOdd);
    d.position = {d.position.x + by.x, d.position.y + by.y};
    d.angle += bytes.number(-0.1, 0.1, kOdd);
    d.velocity = bytes.point(0.1, kOdd);
    d.spin = bytes.number(-1.0, 1.0, kOdd);
    return d;
}

} // namespace

ShellActions::CallResult ShellActions::act(Shells& shells, ByteSource& bytes, const Subjects& on) {
    switch (bytes.below(4)) {
    case 0:
        return constrain(shells, bytes, on);
    case 1:
        return setTargets(shells, bytes);
    case 2:
        return applyForces(shells, bytes, on);
    default:
        return changeProperties(shells, bytes, on);
    }
}

ShellActions::CallResult ShellActions::constrain(Shells& s, ByteSource& bytes, const Subjects& on) {
    const double place = bytes.number(0.0, 1.0, kOdd);
    switch (bytes.below(8)) {
    case 0:
        return {keep(s.create_hold(on.a, place, bytes.chance(128) ? HoldKind::Pin : HoldKind::Clamp), holds_),
                "create_hold"};
    case 1:
    case 2:
    case 3: {
        JointDef d;
        d.kind = static_cast<JointKind>(bytes.below(bytes.chance(10) ? 7 : 3));
        d.shell = on.a;
        d.arc_fraction = place;
        if (bytes.chance(100))
            d.other = on.b;
        d.other_fraction = bytes.number(0.0, 1.0, kOdd);
        if (bytes.chance(100))
            d.body = on.body;
        d.point = bytes.point(0.25, kOdd);
        d.length = bytes.chance(100) ? 0.0 : bytes.number(0.0, 0.5, kOdd);
        d.collide_connected = bytes.chance(128);
        return {keep(s.create_joint(d), joints_), "create_joint"};
    }
    case 4: {
        MouseJointDef d;
        d.arc_fraction = place;
        d.target = bytes.point(0.25, kOdd);
        d.frequency = bytes.number(0.1, 50.0, kOdd);
        d.damping_ratio = bytes.number(0.0, 2.0, kOdd);
        d.max_force = bytes.chance(128) ? 0.0 : bytes.number(0.0, 1.0, kOdd);
        return {keep(s.create_mouse_joint(on.a, d), mouseJoints_), "create_mouse_joint"};
    }
    case 5:
        return {ok(s.destroy(pick(holds_, bytes))), "destroy a hold"};
    case 6:
        return {ok(s.destroy(pick(joints_, bytes))), "destroy a joint"};
    default:
        return {ok(s.destroy(pick(mouseJoints_, bytes))), "destroy a mouse joint"};
    }
}

ShellActions::CallResult ShellActions::setTargets(Shells& s, ByteSource& bytes) {
    const HoldHandle hold = pick(holds_, bytes);
    const JointHandle joint = pick(joints_, bytes);
    const MouseJointHandle mouseJoint = pick(mouseJoints_, bytes);
    switch (bytes.below(7)) {
    case 0:
        return {ok(s.set_target(hold, nearby(s.target(hold), bytes))), "set_target of a hold"};
    case 1:
        return {ok(s.set_target(joint, nearby(s.target(joint), bytes))), "set_target of a joint"};
    case 2: {
        const double length = bytes.number(0.001, 0.3, kOdd);
        return {ok(s.set_max_length(joint, length, bytes.number(0.001, 1.0, kOdd))), "set_max_length"};
    }
    case 3:
        return {ok(s.set_target(mouseJoint, bytes.point(0.25, kOdd))), "set_target of a mouse joint"};
    case 4:
        return {static_cast<bool>(s.reaction(hold)) && s.valid(hold), "reaction of a hold"};
    case 5:
        return {static_cast<bool>(s.reaction(joint)) && static_cast<bool>(s.length(joint)) && s.valid(joint),
                "reaction and length of a joint"};
    default:
        return {static_cast<bool>(s.reaction(mouseJoint)) && s.valid(mouseJoint), "reaction of a mouse joint"};
    }
}

ShellActions::CallResult ShellActions::applyForces(Shells& s, ByteSource& bytes, const Subjects& on) {
    const double place = bytes.number(0.0, 1.0, kOdd);
    const Point force = bytes.point(0.05, kOdd);
    const double torque = bytes.number(-1e-4, 1e-4, kOdd);
    switch (bytes.below(8)) {
    case 0:
        return {ok(s.apply_force(on.a, place, force, torque)), "apply_force"};
    case 1:
        return {ok(s.apply_torque(on.a, place, torque)), "apply_torque"};
    case 2:
        return {ok(s.apply_impulse(on.a, place, bytes.point(1e-4, kOdd), bytes.number(-1e-6, 1e-6, kOdd))),
                "apply_impulse"};
    case 3:
        return {keep(s.create_force(on.a, place, force, torque), forces_), "create_force"};
    case 4:
        return {ok(s.set_force(pick(forces_, bytes), force, torque)), "set_force"};
    case 5:
        return {ok(s.destroy(pick(forces_, bytes))), "destroy a force"};
    case 6:
        return {ok(s.teleport(on.a, bytes.point(0.25, kOdd), bytes.number(-7.0, 7.0, kOdd))), "teleport"};
    default:
        return {ok(s.set_velocity(on.a, bytes.point(1.0, kOdd), bytes.number(-40.0, 40.0, kOdd))), "set_velocity"};
    }
}

ShellActions::CallResult ShellActions::changeProperties(Shells& s, ByteSource& bytes, const Subjects& on) {
    const FrictionMaterial a = static_cast<FrictionMaterial>(bytes.below(4)),
                           b = static_cast<FrictionMaterial>(bytes.below(4));
    switch (bytes.below(11)) {
    case 0:
    case 1: {
        MaterialDef d;
        if (bytes.chance(128))
            d.mu = bytes.number(0.0, 1.0, kOdd);
        if (bytes.chance(128))
            d.young_modulus = bytes.number(1e8, 3e9, kOdd);
        if (bytes.chance(128))
            d.density = bytes.number(500.0, 2000.0, kOdd);
        if (bytes.chance(60))
            d.natural_curvature =
                std::vector<double>(1 + bytes.below(12) * bytes.below(2), bytes.number(-100.0, 100.0));
        return {ok(s.set_material(on.a, d)), "set_material"};
    }
    case 2: {
        FilterDef d;
        d.category = static_cast<std::uint16_t>(1U << bytes.below(3));
        d.mask = static_cast<std::uint16_t>(bytes.chance(60) ? bytes.below(8) : 0xffff);
        d.group = static_cast<std::int16_t>(static_cast<int>(bytes.below(5)) - 2);
        return {ok(s.set_filter(on.a, d)), "set_filter"};
    }
    case 3:
        return {ok(s.set_friction(a, b, bytes.number(0.0, 1.0, kOdd))), "set_friction"};
    case 4:
        return {ok(s.reset_friction(a, b)), "reset_friction"};
    case 5:
        return {ok(s.set_friction_material(on.a, a)), "set_friction_material of a shell"};
    case 6:
        return {ok(s.set_friction_material(on.body, a)), "set_friction_material of a body"};
    case 7: {
        SleepSettings d;
        d.automatic = bytes.chance(128);
        d.drift = bytes.number(0.01, 10.0, kOdd);
        d.delay = bytes.number(0.0, 0.1, kOdd);
        return {ok(s.set_sleep(d)), "set_sleep"};
    }
    case 8:
        return {ok(s.sleep(on.a)) && static_cast<bool>(s.asleep(on.a)), "sleep"};
    case 9:
        return {ok(s.wake(on.a)) && static_cast<bool>(s.filter(on.a)), "wake"};
    default:
        return {ok(s.set_quality(static_cast<Quality>(bytes.below(bytes.chance(10) ? 5 : 2)))), "set_quality"};
    }
}

} // namespace supercircle::fuzz
