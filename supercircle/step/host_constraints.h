#pragma once
// What the host's own solver does to its bodies - touching contacts and joints - as rows the shells' contact problem
// can take in. Why they are needed there is said in host_coupling.h.

#include "supercircle/rod/arc.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace supercircle::step {

using rod::Vec2;
/// Names a body of the host across steps. Hosts reuse addresses, so an id is never a pointer; 0 is nobody.
using BodyId = std::uint64_t;

/// One point of a touching contact between two host bodies. Force on `b` along `normal` and perp(normal), the opposite
/// on `a`.
struct HostContact {
    BodyId a = 0; ///< either may be static or kinematic, not both
    BodyId b = 0;
    Vec2 armA = Vec2::Zero();         ///< from a's centre of mass to the point, m
    Vec2 armB = Vec2::Zero();         ///< from b's, m
    Vec2 normal = Vec2::UnitY();      ///< from a to b
    double friction = 0.0;            ///< 1
    double tangentSpeed = 0.0;        ///< tangent velocity of b's surface over a's that friction strives for, m/s
    double restitutionVelocity = 0.0; ///< separation velocity the host's restitution asks for in the coming step, m/s
    double normalForce = 0.0;         ///< mean of the host's last step, then of ours, N
    double tangentForce = 0.0;        ///< N
    std::uint64_t key = 0;            ///< the host's, to find the point again after its step
    std::uint32_t point = 0;          ///< the host's name of the point in its contact
    double sumNormal = 0.0;           ///< impulse in this frame as solved here, N s
    double sumTangent = 0.0;          ///< N s
    double hostNormal = 0.0;          ///< impulse in the same frame as the host's own solver has it, N s
    double hostTangent = 0.0;         ///< N s
    bool impulseKnown = false;        ///< the last two are filled
    bool impulseUnknown = false;      ///< it acted, but the host no longer knows how much
    double clearance = 0.0;           ///< normal distance opened in this frame, m (grows with the steps)
};

enum class HostRowKind : std::uint8_t {
    Rigid, ///< relative velocity = speed as long as that takes no more than `strength`
    Soft,  ///< force - damping * relative velocity
    Limit  ///< relative motion not below -clearance, pushes only
};

/// One scalar relation of a joint. Relative velocity = axisA . v_a + turnA w_a + axisB . v_b + turnB w_b, with v of the
/// centres of mass; its force acts along the same directions. Units: m/s and N, or rad/s and N m.
struct HostRow {
    BodyId a = 0; ///< 0: nobody there
    BodyId b = 0;
    HostRowKind kind = HostRowKind::Rigid;
    Vec2 axisA = Vec2::Zero(), axisB = Vec2::Zero();           ///< 1
    double turnA = 0.0, turnB = 0.0;                           ///< m, or 1
    double speed = 0.0;                                        ///< Rigid: wanted relative velocity
    double strength = std::numeric_limits<double>::infinity(); ///< Rigid: largest force
    double force = 0.0;                                        ///< Soft: at relative velocity 0
    double damping = 0.0;      ///< Soft: of the whole host step, which is implicit: true damping + dt * stiffness
    double clearance = 0.0;    ///< Limit: left before it is met (shrinks with the steps)
    double last = 0.0;         ///< mean force in the host's last step
    std::uint64_t key = 0;     ///< the host's; the rows of one joint follow each other
    double sum = 0.0;          ///< impulse in this frame as solved here
    double host = 0.0;         ///< impulse in the same frame as the host's own solver has it
    bool impulseKnown = false; ///< `host` is filled
    int saturated = 0;         ///< Rigid: sign of the force when it is at its strength
};

struct HostConstraints {
    std::vector<HostContact> contacts;
    std::vector<HostRow> rows;
    double farthest = std::numeric_limits<double>::infinity(); ///< the host lets a body move in one step, m
    double mostTurn = std::numeric_limits<double>::infinity(); ///< rad

    /// Forgets everything but keeps the storage.
    void clear() {
        contacts.clear();
        rows.clear();
        farthest = mostTurn = std::numeric_limits<double>::infinity();
    }
};

} // namespace supercircle::step
