#pragma once
// Names of version 0.1. They work in 0.2 with a warning that names the successor, and go in 0.3 (decision 0142).
// shells.hpp includes this file. docs/reference/renamed.md lists all changes, also those without an old name.

#include "definitions.hpp"
#include "draw.hpp"
#include "events.hpp"
#include "handle.hpp"
#include "mechanics.hpp"
#include "queries.hpp"

#include <limits>
#include <string>

namespace supercircle {

struct EnergyBalance;

using Outcome [[deprecated("use Status")]] = Status;
template <class Kind>
using PartHandle [[deprecated("use ConstraintHandle")]] = ConstraintHandle<Kind>;
using GrabHandle [[deprecated("use MouseJointHandle")]] = MouseJointHandle;
using GrabDef [[deprecated("use MouseJointDef")]] = MouseJointDef;
using DriveDef [[deprecated("use TargetDef")]] = TargetDef;
using MaterialId [[deprecated("use FrictionMaterial")]] = FrictionMaterial;
using NearestPoint [[deprecated("use ClosestPoint")]] = ClosestPoint;
using ShellMeasures [[deprecated("use ShellState")]] = ShellState;
using Touch [[deprecated("use ContactPoint")]] = ContactPoint;
using EnergyBooks [[deprecated("use EnergyBalance")]] = EnergyBalance;

[[deprecated("use kWorldLocked")]] inline const char* const kStepping = kWorldLocked;

[[deprecated("use bending_modulus")]] inline double bendingModulus(const ShellDef& d) {
    return bending_modulus(d);
}
[[deprecated("use scaled_shell")]] inline ShellDef scaledShell(double radius, double mass, double phi_bar = 0.75,
                                                               double stiffness = 1.0) {
    return scaled_shell(radius, mass, phi_bar, stiffness);
}
[[deprecated("use strain_colour")]] inline Colour strainColour(double strain, double full) {
    return strain_colour(strain, full);
}

/// The members of Shells that have new names; a base class of Shells.
template <class Self>
class OldNames {
public:
    [[deprecated("use create_hold")]] auto hold(ShellHandle shell, double arc_fraction, HoldKind kind,
                                                bool on_machine = false) {
        return self().create_hold(shell, arc_fraction, kind, on_machine ? HoldBase::Moving : HoldBase::Fixed);
    }
    [[deprecated("use create_clamp")]] auto clamp(ShellHandle shell, double arc_fraction) {
        return self().create_clamp(shell, arc_fraction);
    }
    [[deprecated("use create_pin")]] auto pin(ShellHandle shell, double arc_fraction) {
        return self().create_pin(shell, arc_fraction);
    }
    [[deprecated("use set_target")]] auto drive(HoldHandle hold, const TargetDef& to) {
        return self().set_target(hold, to);
    }
    [[deprecated("use set_target")]] auto drive(JointHandle joint, const TargetDef& to) {
        return self().set_target(joint, to);
    }
    [[deprecated("use destroy")]] auto release(HoldHandle handle) { return self().destroy(handle); }
    [[deprecated("use destroy")]] auto release(JointHandle handle) { return self().destroy(handle); }
    [[deprecated("use destroy")]] auto release(MouseJointHandle handle) { return self().destroy(handle); }
    [[deprecated("use destroy")]] auto release(ForceHandle handle) { return self().destroy(handle); }
    [[deprecated("use create_joint")]] auto join(const JointDef& definition) { return self().create_joint(definition); }
    [[deprecated("use set_max_length")]] auto reel(JointHandle joint, double length, double rate) {
        return self().set_max_length(joint, length, rate);
    }
    [[deprecated("use create_mouse_joint")]] auto grab(ShellHandle shell, const MouseJointDef& definition) {
        return self().create_mouse_joint(shell, definition);
    }
    [[deprecated("use set_target")]] auto move(MouseJointHandle grab, Point target) {
        return self().set_target(grab, target);
    }
    [[deprecated("use create_force")]] auto add_force(ShellHandle shell, double arc_fraction, Point force,
                                                      double torque = 0.0) {
        return self().create_force(shell, arc_fraction, force, torque);
    }
    [[deprecated("use set_friction_material")]] auto set_surface(ShellHandle shell, FrictionMaterial material) {
        return self().set_friction_material(shell, material);
    }
    [[deprecated("use set_friction_material")]] auto set_surface(BodyId body, FrictionMaterial material) {
        return self().set_friction_material(body, material);
    }
    [[deprecated("use attach_to_crosshead")]] auto carry(const std::string& body_name) {
        return self().attach_to_crosshead(body_name);
    }
    [[deprecated("use set_crosshead_velocity")]] auto set_machine_velocity(Point velocity) {
        return self().set_crosshead_velocity(velocity);
    }
    [[nodiscard, deprecated("use crosshead_force")]] auto machine_force() const { return self().crosshead_force(); }
    [[nodiscard, deprecated("use energy_balance")]] auto books() const { return self().energy_balance(); }
    [[nodiscard, deprecated("use shells")]] auto list() const { return self().shells(); }
    [[nodiscard, deprecated("use closest_point")]] auto nearest(ShellHandle shell, Point point) const {
        return self().closest_point(shell, point);
    }
    [[nodiscard, deprecated("use closest_point")]] auto
    nearest(Point point, double farthest = std::numeric_limits<double>::infinity(), QueryMask mask = 0xffff) const {
        return self().closest_point(point, farthest, mask);
    }
    [[nodiscard, deprecated("use state")]] auto measure(ShellHandle shell) const { return self().state(shell); }

private:
    [[nodiscard]] Self& self() { return static_cast<Self&>(*this); }
    [[nodiscard]] const Self& self() const { return static_cast<const Self&>(*this); }
};

} // namespace supercircle
