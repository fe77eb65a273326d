#include "tests/fuzz/hands.h"

namespace supercircle::fuzz {

namespace {

constexpr std::size_t kMostRemembered = 20;
constexpr int kOdd = 10; ///< of 256 numbers are no sensible ones

/// One of those made, or one that never was.
template <class H>
H pick(const std::vector<H>& made, Tape& tape) {
    if (!made.empty() && tape.chance(230))
        return made[tape.below(static_cast<std::uint32_t>(made.size()))];
    return {tape.below(10), tape.below(10), tape.below(5)};
}

template <class H>
bool keep(const Result<H>& made, std::vector<H>& list) {
    if (!made)
        return false;
    list.push_back(*made);
    if (list.size() > kMostRemembered)
        list.erase(list.begin());
    return true;
}

bool ok(const Outcome& outcome) {
    return static_cast<bool>(outcome);
}

/// A drive target a little away from the present one.
DriveDef nearby(const Result<DriveDef>& present, Tape& tape) {
    DriveDef d = present ? *present : DriveDef{};
    const Point by = tape.point(0.002, kOdd);
    d.position = {d.position.x + by.x, d.position.y + by.y};
    d.angle += tape.number(-0.1, 0.1, kOdd);
    d.velocity = tape.point(0.1, kOdd);
    d.spin = tape.number(-1.0, 1.0, kOdd);
    return d;
}

} // namespace

Hands::Made Hands::act(Shells& shells, Tape& tape, const Subjects& on) {
    switch (tape.below(4)) {
    case 0:
        return tie(shells, tape, on);
    case 1:
        return move(shells, tape);
    case 2:
        return push(shells, tape, on);
    default:
        return change(shells, tape, on);
    }
}

Hands::Made Hands::tie(Shells& s, Tape& tape, const Subjects& on) {
    const double place = tape.number(0.0, 1.0, kOdd);
    switch (tape.below(8)) {
    case 0:
        return {keep(s.hold(on.a, place, tape.chance(128) ? HoldKind::Pin : HoldKind::Clamp), holds_), "hold"};
    case 1:
    case 2:
    case 3: {
        JointDef d;
        d.kind = static_cast<JointKind>(tape.below(tape.chance(10) ? 7 : 3));
        d.shell = on.a;
        d.arc_fraction = place;
        if (tape.chance(100))
            d.other = on.b;
        d.other_fraction = tape.number(0.0, 1.0, kOdd);
        if (tape.chance(100))
            d.body = on.body;
        d.point = tape.point(0.25, kOdd);
        d.length = tape.chance(100) ? 0.0 : tape.number(0.0, 0.5, kOdd);
        d.collide_connected = tape.chance(128);
        return {keep(s.join(d), joints_), "join"};
    }
    case 4: {
        GrabDef d;
        d.arc_fraction = place;
        d.target = tape.point(0.25, kOdd);
        d.frequency = tape.number(0.1, 50.0, kOdd);
        d.damping_ratio = tape.number(0.0, 2.0, kOdd);
        d.max_force = tape.chance(128) ? 0.0 : tape.number(0.0, 1.0, kOdd);
        return {keep(s.grab(on.a, d), grabs_), "grab"};
    }
    case 5:
        return {ok(s.release(pick(holds_, tape))), "release a hold"};
    case 6:
        return {ok(s.release(pick(joints_, tape))), "release a joint"};
    default:
        return {ok(s.release(pick(grabs_, tape))), "release a grab"};
    }
}

Hands::Made Hands::move(Shells& s, Tape& tape) {
    const HoldHandle hold = pick(holds_, tape);
    const JointHandle joint = pick(joints_, tape);
    const GrabHandle grab = pick(grabs_, tape);
    switch (tape.below(7)) {
    case 0:
        return {ok(s.drive(hold, nearby(s.target(hold), tape))), "drive a hold"};
    case 1:
        return {ok(s.drive(joint, nearby(s.target(joint), tape))), "drive a joint"};
    case 2: {
        const double length = tape.number(0.001, 0.3, kOdd);
        return {ok(s.reel(joint, length, tape.number(0.001, 1.0, kOdd))), "reel"};
    }
    case 3:
        return {ok(s.move(grab, tape.point(0.25, kOdd))), "move"};
    case 4:
        return {static_cast<bool>(s.reaction(hold)) && s.valid(hold), "reaction of a hold"};
    case 5:
        return {static_cast<bool>(s.reaction(joint)) && static_cast<bool>(s.length(joint)) && s.valid(joint),
                "reaction and length of a joint"};
    default:
        return {static_cast<bool>(s.reaction(grab)) && s.valid(grab), "reaction of a grab"};
    }
}

Hands::Made Hands::push(Shells& s, Tape& tape, const Subjects& on) {
    const double place = tape.number(0.0, 1.0, kOdd);
    const Point force = tape.point(0.05, kOdd);
    const double torque = tape.number(-1e-4, 1e-4, kOdd);
    switch (tape.below(8)) {
    case 0:
        return {ok(s.apply_force(on.a, place, force, torque)), "apply_force"};
    case 1:
        return {ok(s.apply_torque(on.a, place, torque)), "apply_torque"};
    case 2:
        return {ok(s.apply_impulse(on.a, place, tape.point(1e-4, kOdd), tape.number(-1e-6, 1e-6, kOdd))),
                "apply_impulse"};
    case 3:
        return {keep(s.add_force(on.a, place, force, torque), forces_), "add_force"};
    case 4:
        return {ok(s.set_force(pick(forces_, tape), force, torque)), "set_force"};
    case 5:
        return {ok(s.release(pick(forces_, tape))), "release a force"};
    case 6:
        return {ok(s.teleport(on.a, tape.point(0.25, kOdd), tape.number(-7.0, 7.0, kOdd))), "teleport"};
    default:
        return {ok(s.set_velocity(on.a, tape.point(1.0, kOdd), tape.number(-40.0, 40.0, kOdd))), "set_velocity"};
    }
}

Hands::Made Hands::change(Shells& s, Tape& tape, const Subjects& on) {
    const MaterialId a = static_cast<MaterialId>(tape.below(4)), b = static_cast<MaterialId>(tape.below(4));
    switch (tape.below(11)) {
    case 0:
    case 1: {
        MaterialDef d;
        if (tape.chance(128))
            d.mu = tape.number(0.0, 1.0, kOdd);
        if (tape.chance(128))
            d.young_modulus = tape.number(1e8, 3e9, kOdd);
        if (tape.chance(128))
            d.density = tape.number(500.0, 2000.0, kOdd);
        if (tape.chance(60))
            d.natural_curvature = std::vector<double>(1 + tape.below(12) * tape.below(2), tape.number(-100.0, 100.0));
        return {ok(s.set_material(on.a, d)), "set_material"};
    }
    case 2: {
        FilterDef d;
        d.category = static_cast<std::uint16_t>(1U << tape.below(3));
        d.mask = static_cast<std::uint16_t>(tape.chance(60) ? tape.below(8) : 0xffff);
        d.group = static_cast<std::int16_t>(static_cast<int>(tape.below(5)) - 2);
        return {ok(s.set_filter(on.a, d)), "set_filter"};
    }
    case 3:
        return {ok(s.set_friction(a, b, tape.number(0.0, 1.0, kOdd))), "set_friction"};
    case 4:
        return {ok(s.reset_friction(a, b)), "reset_friction"};
    case 5:
        return {ok(s.set_surface(on.a, a)), "set_surface of a shell"};
    case 6:
        return {ok(s.set_surface(on.body, a)), "set_surface of a body"};
    case 7: {
        SleepSettings d;
        d.automatic = tape.chance(128);
        d.drift = tape.number(0.01, 10.0, kOdd);
        d.delay = tape.number(0.0, 0.1, kOdd);
        return {ok(s.set_sleep(d)), "set_sleep"};
    }
    case 8:
        return {ok(s.sleep(on.a)) && static_cast<bool>(s.asleep(on.a)), "sleep"};
    case 9:
        return {ok(s.wake(on.a)) && static_cast<bool>(s.filter(on.a)), "wake"};
    default:
        return {ok(s.set_quality(static_cast<Quality>(tape.below(tape.chance(10) ? 5 : 2)))), "set_quality"};
    }
}

} // namespace supercircle::fuzz
