#pragma once
// The fields of the saved world (private to plugin/api); see snapshot_fields.h.

#include "plugin/api/limits.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_archive.h"
#include "plugin/api/snapshot_counts.h"
#include "plugin/api/snapshot_effects.h"

#include <algorithm>
#include <cmath>

namespace supercircle::archive {

template <class Ar>
void io(Ar& ar, Is<rod::PointMass> auto& p) {
    auto& [s, mass, inertia] = p;
    ar(s, mass, inertia);
}

template <class Ar>
void io(Ar& ar, Is<rod::RodDefinition> auto& d) {
    auto& [length, thickness, linearMass, bendingModulus, naturalCurvature, closed, elementLength, pointMasses] = d;
    ar(length, thickness, linearMass, bendingModulus, naturalCurvature, closed, elementLength, pointMasses);
}

template <class Ar>
void io(Ar& ar, Is<rod::RodModel> auto& model) {
    if constexpr (Ar::kLoads) {
        rod::RodDefinition d;
        ar(d);
        if (!ar.fault().empty())
            return;
        if (const std::string why =
                d.naturalCurvature.size() <= limits::kMostElements ? rod::validate(d) : "too many elements";
            !why.empty())
            ar.fail("a shell in it is impossible: " + why);
        else
            model = rod::RodModel(std::move(d));
    } else {
        ar(model.definition());
    }
}

template <class Ar>
void io(Ar& ar, Is<step::Path> auto& p) {
    auto& [active, start, end, from, to, fromVelocity, toVelocity, fromAngle, toAngle, fromSpin, toSpin] = p;
    ar(active, start, end, from, to, fromVelocity, toVelocity, fromAngle, toAngle, fromSpin, toSpin);
}

template <class Ar>
void io(Ar& ar, Is<step::Target> auto& t) {
    auto& [point, angle, velocity, spin, path, pending] = t;
    ar(point, angle, velocity, spin, path, pending);
}

template <class Ar>
void io(Ar& ar, Is<step::Hold> auto& h) {
    auto& [s, clamped, onCrosshead, target, reaction, reactionTorque, maxForce, turnStiffness, key, stop] = h;
    auto& [time, body, since, driven, byHold, byHoldBefore] = stop;
    ar(s, clamped, onCrosshead, target.point, target.angle, target.velocity, target.spin, reaction, reactionTorque,
       target.path, target.pending, key);
    ioUnless(ar, !(maxForce > 0), maxForce);
    ioUnless(ar, !(turnStiffness > 0), turnStiffness);
    ar.unhashed(time, body, since, driven, byHold, byHoldBefore); // found anew in every frame, but for the events
}

template <class Ar>
void io(Ar& ar, Is<step::AppliedForce> auto& f) {
    auto& [s, force, torque, once, key] = f;
    ar(s, force, torque, once, key);
}

template <class Ar>
void io(Ar& ar, Is<step::MouseJoint> auto& g) {
    auto& [s, target, stiffness, damping, maxForce, force, key] = g;
    ar(s, target, stiffness, damping, maxForce, force, key);
}

template <class Ar>
void io(Ar& ar, Is<step::Link> auto& l) {
    auto& [key, kind, end, collide, rodA, sA, rodB, sB, body, local, target, angle, length, goal, reel, force, torque,
           maxForce, broken] = l;
    (void)broken; // within a frame only
    ar(key, kind, end, collide, rodA, sA, rodB, sB, body, local, target, angle, length, goal, reel, force, torque);
    ioUnless(ar, !(maxForce > 0), maxForce);
}

template <class Ar>
void io(Ar& ar, Is<step::PairFriction> auto& f) {
    auto& [a, b, mu] = f;
    ar(a, b, mu);
}

template <class Ar>
void io(Ar& ar, Is<step::BodyMaterial> auto& m) {
    auto& [body, material] = m;
    ar(body, material);
}

template <class Ar>
void io(Ar& ar, Is<step::StoppedBody> auto& s) {
    auto& [body, velocity, spin, until, hostVelocity, hostSpin] = s;
    ar(body, velocity, spin, until, hostVelocity, hostSpin);
}

template <class Ar>
void io(Ar& ar, Is<step::SurfaceSpeed> auto& s) {
    auto& [body, fixture, speed] = s;
    ar(body, fixture, speed);
}

template <class Ar>
void io(Ar& ar, Is<step::VetoedPair> auto& v) {
    auto& [rod, body, outline] = v;
    ar(rod, body, outline);
}

template <class Ar>
void io(Ar& ar, Is<contact::Push> auto& p) {
    auto& [sA, sB, direction] = p;
    ar(sA, sB, direction);
}

template <class Ar>
void io(Ar& ar, Is<step::Overlap> auto& o) {
    auto& [rodA, rodB, body, outline, contact, free, pushes, way, blocked, from, tried] = o;
    ar(rodA, rodB, body, outline, contact, free, pushes, way, blocked, from, tried);
}

template <class Ar>
void io(Ar& ar, Is<step::PieceId> auto& p) {
    auto& [body, outline] = p;
    ar(body, outline);
}

template <class Ar>
void io(Ar& ar, Is<step::Rod> auto& r) {
    auto& [model, q, v, lastAccepted, u, holds, mu, key, category, mask, quarantined, speed, kin, gauss, forces,
           mouseJoints, width, material, group, island, stillTime, stillReference, effects, dtNext, cuts,
           quarantineReason, quarantinedAt, dampingRatio, dampingTime, dampingOf, freeStep, leastBending, vibration,
           passing] = r;
    ar(model, q, v, lastAccepted, u, holds, mu, key, category, mask, quarantined, speed, forces, mouseJoints, width,
       material, group, island, stillTime, stillReference, dtNext);
    ioUnless(ar, !(cuts > 0), cuts);
    ioUnless(ar, passing.empty(), passing);
    ioEffects(ar, model, effects);
    ar.unhashed(quarantineReason, quarantinedAt);
    ioUnless(ar, dampingRatio < 0.0, dampingRatio);
    ioUnless(ar, !(dampingTime > 0.0), dampingTime);
    ar.unhashed(dampingOf, leastBending);
    if (freeStep > 0.0 || vibration > 0.0)
        ar(freeStep, vibration);
    else
        ar.unhashed(freeStep, vibration);
    if constexpr (Ar::kLoads) { // kin and gauss are functions of q
        const auto n = model.dofs();
        if (q.size() != n || v.size() != n || lastAccepted.size() != n ||
            static_cast<int>(u.size()) != model.massPoints() || !q.allFinite() || !lastAccepted.allFinite()) {
            ar.fail("a shell in it has the wrong number of coordinates, or some that are not finite");
            q.setZero(n);
        }
        const double length = model.definition().length;
        const auto outside = [length](const auto& c) { return !(c.s >= 0.0 && c.s <= length); };
        if (std::any_of(holds.begin(), holds.end(), outside) || std::any_of(forces.begin(), forces.end(), outside) ||
            std::any_of(mouseJoints.begin(), mouseJoints.end(), outside))
            ar.fail("a hold, force or mouse joint in it lies outside its shell");
        if (std::any_of(holds.begin(), holds.end(), [](const step::Hold& h) {
                return !(h.turnStiffness >= 0.0 && std::isfinite(h.turnStiffness));
            }))
            ar.fail("a clamp in it has a stiffness that is no number or negative");
        kin.evaluate(model, q);
        rod::evaluateGauss(model, kin, gauss);
    }
}

inline void io(Loader& ar, std::vector<step::Rod>& rods) {
    rod::RodDefinition least;
    least.naturalCurvature = {0.0};
    rods.clear();
    for (std::size_t left = ar.count(); left > 0 && ar.fault().empty(); --left) {
        rods.push_back(
            step::Rod{rod::RodModel(least), {}, {}, {}, {}, {}, 0.0, 0, 1, 0xffff, false, 0.0, {}, {}, {}, {}});
        ar(rods.back());
    }
}

template <class Ar>
void io(Ar& ar, Is<step::BodyState> auto& b) {
    auto& [centre, angle, velocity, spin, mass, inertia, gravityScale, linearDamping, angularDamping, awake, enabled,
           moving, maySleep] = b;
    ar(centre, angle, velocity, spin, mass, inertia, gravityScale, linearDamping, angularDamping, awake, enabled,
       moving);
    ar.unhashed(maySleep); // read in every frame
}

template <class Ar>
void io(Ar& ar, Is<step::HostAcceleration> auto& p) {
    auto& [linear, angular, expectedLinear, expectedAngular, lastFrame, frame] = p;
    ar(linear, angular, expectedLinear, expectedAngular);
    ar.unhashed(lastFrame, frame);
}

template <class Ar>
void io(Ar& ar, Is<step::HostCoupling> auto& h) {
    auto& [coupled, coupledTime, travel, turn, hostImpulse, hostTurnImpulse, handed, handedSpin, drift, driftSpin,
           unexplained, all, known, seen] = h;
    ar(coupled, coupledTime, travel, turn, hostImpulse, hostTurnImpulse, handed, handedSpin, drift, driftSpin,
       unexplained, all, known, seen);
}

template <class Ar>
void io(Ar& ar, Is<step::HostContact> auto& c) {
    auto& [a, b, armA, armB, normal, friction, tangentSpeed, restitutionVelocity, normalForce, tangentForce, key, point,
           sumNormal, sumTangent, hostNormal, hostTangent, impulseKnown, impulseUnknown, clearance] = c;
    ar(a, b, armA, armB, normal, friction, tangentSpeed, restitutionVelocity, normalForce, tangentForce, point,
       sumNormal, sumTangent, hostNormal, hostTangent, impulseKnown, impulseUnknown, clearance);
    ar.unhashed(key); // an address in the host
}

template <class Ar>
void io(Ar& ar, Is<step::HostRow> auto& r) {
    auto& [a, b, kind, axisA, axisB, turnA, turnB, speed, strength, force, damping, clearance, last, key, sum, host,
           impulseKnown, saturated] = r;
    ar(a, b, kind, axisA, axisB, turnA, turnB, speed, strength, force, damping, clearance, last, sum, host,
       impulseKnown, saturated);
    ar.unhashed(key);
}

template <class Ar>
void io(Ar& ar, Is<step::HostConstraints> auto& c) {
    auto& [contacts, rows, farthest, mostTurn] = c;
    ar(contacts, rows, farthest, mostTurn);
}

template <class Ar>
void io(Ar& ar, Is<step::Body> auto& b) {
    auto& [id, state, driven, dynamic, impulse, angularImpulse, force, thicknessNear, hostCoupling, island, woken,
           stillTime, stillCentre, stillAngle] = b;
    ar(id, state, driven, dynamic, impulse, angularImpulse, force, hostCoupling);
    ar.unhashed(thicknessNear);
    if (island != 0 || woken || stillTime > 0.0)
        ar(island, woken, stillTime, stillCentre, stillAngle);
    else
        ar.unhashed(island, woken, stillTime, stillCentre, stillAngle); // bodies that never sleep keep their hash
}

template <class Ar>
void io(Ar& ar, Is<contact::VertexSeam> auto& v) {
    auto& [role, c1, c2] = v;
    ar(role, c1, c2);
}

template <class Ar>
void io(Ar& ar, Is<contact::HiddenSpan> auto& s) {
    auto& [face, from, to] = s;
    ar(face, from, to);
}

template <class Ar>
void io(Ar& ar, Is<contact::OutlineSeams> auto& s) {
    auto& [vertices, hidden] = s;
    ar(vertices, hidden);
}

template <class Ar>
void io(Ar& ar, Is<contact::Outline> auto& o) {
    auto& [kind, points, radius, joinedStart, joinedEnd, neighbourStart, neighbourEnd, body, key, motion, category,
           mask, group, seams] = o;
    ar(kind, points, radius, joinedStart, joinedEnd, neighbourStart, neighbourEnd, body, key, motion, category, mask,
       group);
    ar.unhashed(seams); // found anew in every frame
}

template <class Ar>
void io(Ar& ar, Is<step::BodyOutline> auto& o) {
    auto& [local, body, friction, fixture] = o;
    ar(local, body, friction);
    ar.unhashed(fixture); // follows from the piece
}

template <class Ar>
void io(Ar& ar, Is<step::ContactImpulse> auto& c) {
    auto& [id, normal, tangent, tangentialDeflection] = c;
    ar(id, normal, tangent, tangentialDeflection);
}

template <class Ar>
void io(Ar& ar, Is<contact::RodPoint> auto& p) {
    auto& [rod, element, s] = p;
    ar(rod, element, s);
}

template <class Ar>
void io(Ar& ar, Is<contact::Candidate> auto& c) {
    auto& [a, b, outline, normal, pointA, pointB, gap, id] = c;
    ar(a, b, outline, normal, pointA, pointB, gap, id);
}

template <class Ar>
void io(Ar& ar, Is<coulomb::SolverOptions> auto& o) {
    auto& [method, tolerance, absoluteImpulse, maxSweeps, firstSweeps, maxPivots, giveUpEarly, maxWork] = o;
    (void)giveUpEarly; // of one solve
    (void)maxWork;
    ar(method, tolerance, absoluteImpulse, maxSweeps, firstSweeps, maxPivots);
}

template <class Ar>
void io(Ar& ar, Is<step::Settings> auto& s) {
    auto& [length, dtMax, dtMin, fixedDt, localError, motionLimit, margin, relinearise, rejectPenetration, recovery,
           maxIterations, contact, threads, acceptUnconverged, sweepAbove, cappedSweeps, cull, frameWork, giveUpEarly,
           autoSleep, sleepDrift, sleepAfter, crush, recoverAfter, dampingRatio, secondOrder, freeError, freeLeast,
           freeSteps, secondOrderRods, secondOrderParts, crossingCheck] = s;
    (void)threads; // of this computer
    (void)length;  // the thickness, in every quality
    ar(dtMax, dtMin, fixedDt, localError, motionLimit, margin, relinearise, rejectPenetration, recovery, maxIterations,
       contact, acceptUnconverged, sweepAbove, cappedSweeps, cull, frameWork, autoSleep, sleepDrift, sleepAfter,
       crossingCheck);
    ioUnless(ar, std::isinf(recoverAfter), recoverAfter);
    ioUnless(ar, !(dampingRatio > 0.0), dampingRatio);
    if (secondOrder)
        ar(secondOrder, freeError, freeLeast, freeSteps, secondOrderRods, secondOrderParts);
    else
        ar.unhashed(secondOrder, freeError, freeLeast, freeSteps, secondOrderRods, secondOrderParts);
    if (giveUpEarly || crush != step::CrushPolicy::Wait)
        ar(giveUpEarly, crush);
    else
        ar.unhashed(giveUpEarly, crush); // settings of the laboratory keep their hash
    if constexpr (Ar::kLoads) {          // steps without length would never end
        constexpr double shortest = 1e-9;
        if (!(dtMin >= shortest && dtMax >= dtMin && (fixedDt <= 0.0 || fixedDt >= shortest) && localError > 1e-3 &&
              motionLimit > 1e-3))
            ar.fail("its settings make steps without length");
        if (!(freeError > 0.0 && freeLeast >= 0.0 && freeSteps >= 1 && freeSteps <= 1 << 20))
            ar.fail("its settings make free motion without end");
        if (crush > step::CrushPolicy::Freeze)
            ar.fail("its policy for crushed shells is unknown");
    }
}

/// A list that most states do not use: empty, it does not count in the hash.
template <class Ar>
void ioIfAny(Ar& ar, auto& list) {
    ioUnless(ar, list.empty(), list);
}

template <class Ar>
void io(Ar& ar, Is<step::World> auto& w) {
    auto& [time, gravity, rods, bodies, outlines, constraints, impulses, crossheadVelocity, crossheadTravel,
           crossheadBodies, energyBalance, counters, candidates, range, dt, dtNext, nextKey, links, nextPart,
           pairFriction, bodyMaterials, sleepingImpulses, nextIsland, effectsGone, surfaceSpeeds, vetoes, stopped,
           overlaps] = w;
    ar(time, gravity, rods, bodies, outlines, constraints, impulses, crossheadVelocity, crossheadTravel,
       crossheadBodies, energyBalance);
    ar.unhashed(counters);
    ar.unhashed(nextPart); // handles only
    ar(candidates, range, dt, dtNext, nextKey, links, pairFriction, bodyMaterials, sleepingImpulses, nextIsland,
       effectsGone);
    ioIfAny(ar, surfaceSpeeds);
    ioIfAny(ar, vetoes);
    ioIfAny(ar, stopped);
    ioIfAny(ar, overlaps);
}

} // namespace supercircle::archive
