#pragma once
// The fields of all saved structs (private to plugin/api). Structured bindings name every member, so that a member that
// is missing here is a compiler error ("decomposes into n elements"). A new field changes the format: raise the version
// in kStateKind (snapshot.cpp).

#include "plugin/api/snapshot_world.h"

#include <algorithm>
#include <optional>

namespace supercircle::archive {

template <class Ar>
void io(Ar& ar, Is<Point> auto& p) {
    auto& [x, y] = p;
    ar(x, y);
}

template <class Ar>
void io(Ar& ar, Is<ShellHandle> auto& h) {
    auto& [index, generation, world] = h;
    ar(index, generation, world);
}

template <class Ar, class Tag>
void io(Ar& ar, ConstraintHandle<Tag>& h) {
    ar(h.index, h.generation, h.world);
}
template <class Ar, class Tag>
void io(Ar& ar, const ConstraintHandle<Tag>& h) {
    ar(h.index, h.generation, h.world);
}

template <class Ar>
void io(Ar& ar, Is<TargetDef> auto& d) {
    auto& [position, angle, velocity, spin] = d;
    ar(position, angle, velocity, spin);
}

template <class Ar>
void io(Ar& ar, Is<JointDef> auto& d) {
    auto& [kind, shell, arcFraction, other, otherFraction, body, point, length, collideConnected] = d;
    ar(kind, shell, arcFraction, other, otherFraction, body, point, length, collideConnected);
}

template <class Ar>
void io(Ar& ar, Is<MouseJointDef> auto& d) {
    auto& [arcFraction, target, frequency, dampingRatio, maxForce] = d;
    ar(arcFraction, target, frequency, dampingRatio, maxForce);
}

template <class Ar>
void io(Ar& ar, Is<FilterDef> auto& d) {
    auto& [category, mask, group] = d;
    ar(category, mask, group);
}

template <class Ar>
void io(Ar& ar, Is<SleepSettings> auto& s) {
    auto& [automatic, drift, delay] = s;
    ar(automatic, drift, delay);
}

template <class Ar>
void io(Ar& ar, Is<RecoverySettings> auto& s) {
    auto& [policy, after] = s;
    ar(policy, after);
}

template <class Ar>
void io(Ar& ar, Is<MaterialDef> auto& d) {
    auto& [mu, youngModulus, density, naturalCurvature, dampingRatio] = d;
    ar(mu, youngModulus, density, naturalCurvature, dampingRatio);
}

template <class Ar>
void io(Ar& ar, Is<PointMassDef> auto& p) {
    auto& [arcFraction, mass, inertia] = p;
    ar(arcFraction, mass, inertia);
}

template <class Ar>
void io(Ar& ar, Is<ShellDef> auto& d) {
    auto& [position, angle, length, phiBar, radius, naturalCurvature, curvature, thickness, width, density,
           youngModulus, massAt, mu, dampingRatio, elements, tipRefinement, closed, velocity, spin, category, mask,
           group, frictionMaterial, userData, name] = d;
    ar(position, angle, length, phiBar, radius, naturalCurvature, curvature, thickness, width, density, youngModulus,
       massAt, mu, dampingRatio, elements, tipRefinement, closed, velocity, spin, category, mask, group,
       frictionMaterial, userData, name);
}

template <class Ar>
void io(Ar& ar, Is<EffectValue> auto& v) {
    auto& [name, number, choice] = v;
    ar(name, number, choice);
}

template <class Ar>
void io(Ar& ar, Is<EffectDef> auto& d) {
    auto& [key, parameters] = d;
    ar(key, parameters);
}

template <class Ar>
void io(Ar& ar, Is<EffectTarget> auto& t) {
    auto& [shell, all] = t;
    ar(shell, all);
}

// ---- class Shells ----

template <class Ar>
void io(Ar& ar, Is<EventSettings> auto& s) {
    auto& [impulseThreshold, snapEnergy, snapTime] = s;
    ar(impulseThreshold, snapEnergy, snapTime);
}

template <class Ar>
void io(Ar& ar, Is<ContactPair> auto& p) {
    auto& [a, b, body] = p;
    ar(a, b, body);
}

template <class Ar>
void io(Ar& ar, Is<ContactPoint> auto& t) {
    auto& [a, b, body, fractionA, fractionB, point, normal] = t;
    ar.unhashed(a.index, a.generation, b.index, b.generation); // of the saved world
    ar(body, fractionA, fractionB, point, normal);
}

template <class Ar>
void io(Ar& ar, Is<ContactPairState> auto& t) {
    auto& [pair, last] = t;
    ar(pair, last);
}

template <class Ar>
void io(Ar& ar, Is<SnapState> auto& s) {
    auto& [key, lowest, bucket, filled, time, energy, snapping, begun, energyBefore, minimum, minimumTime,
           kineticPeak] = s;
    ar(key, lowest, bucket, filled, time, energy, snapping, begun, energyBefore, minimum, minimumTime, kineticPeak);
}

template <class Ar>
void io(Ar& ar, Is<EventDetectorState> auto& w) {
    auto& [settings, pairs, snaps, quarantined, overlapping] = w;
    ar(settings, pairs, snaps, quarantined);
    ioIfAny(ar, overlapping);
}

template <class Ar>
void io(Ar& ar, Is<Slot> auto& s) {
    auto& [generation, key, highest, name, userData] = s;
    (void)highest; // belongs to the Shells that give handles out
    ar(generation, key, name, userData);
}

/// A Shells without its host.
struct State {
    std::vector<Slot> slots;
    double advanced = 0.0;
    step::World world;
    step::Settings settings;
    EventDetectorState detector;
    std::vector<effects::Setting> effectsOfNew;
};
/// The same where it lives.
template <class Ar>
void ioState(Ar& ar, auto& slots, auto& advanced, auto& world, auto& settings, auto& detector, auto& effectsOfNew) {
    ar.unhashed(slots, advanced);
    ar(world, settings, detector);
    ioIfAny(ar, effectsOfNew);
}

} // namespace supercircle::archive
