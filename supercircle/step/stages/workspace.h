#pragma once
// Work space of one step attempt (private to step/).

#include "supercircle/step/contacts/gap_closing.h"
#include "supercircle/step/world.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace supercircle::step {

/// The contact point of two smooth surfaces rolls along them by (relative rotation) / (relative curvature). Where the
/// surfaces are nearly conformal - an arc pressed flat, nested shells - it runs far, and a normal force N that follows
/// it only from step to step is an explicit spring of stiffness N / curvature on the rotation: it flutters. This term
/// makes it implicit: impulse -c tau [tau . (dt v / 2 - (q_k - q)) - lag angle] on the rod.
struct Rolling {
    Eigen::VectorXd tau;   ///< rotation of the rod's section at the contact, d theta / dq
    double c = 0.0;        ///< N dt / relative curvature, N s m
    double lagAngle = 0.0; ///< rotation of the other side since the linearisation point, as far as known, rad
};

/// What one candidate adds to its rods.
struct RollingPair {
    bool any = false;
    Rolling a, b;
};

/// A loaded contact point on the lower-numbered rod of its pair.
struct LoadedPoint {
    std::int32_t first = -1; ///< rod
    std::int32_t other = -1; ///< rod, or -2 - outline
    double s = 0.0;          ///< on `first`, m
    double normal = 0.0;     ///< N
};

/// A mouse joint inside an attempt (applied_forces.h).
struct MouseJointWork {
    Eigen::Matrix<double, 2, Eigen::Dynamic> J; ///< rows of its point
    Vec2 stretch = Vec2::Zero();                ///< target minus point at the start of the step, m
    double stiffness = 0.0;                     ///< as far as the largest force allows, N/m
    double damping = 0.0;                       ///< N s/m
};

/// The effects on a rod, linearised (effect_terms.h).
struct EffectWork {
    std::vector<double> curvature, moment, tangent; ///< per element: where, extra moment (N m), its slope (N m^2)
    Eigen::VectorXd at;                             ///< the same curvatures by degrees of freedom
    std::vector<effects::NeighbourResponse> pairs;  ///< there, less those of the rod without effects
    std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic>> rows; ///< of the drag's points
    std::vector<Vec2> way;                                      ///< in the step as predicted, m
    std::vector<effects::DragResponse> drag;
    std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic>> airRows; ///< of the air's points, along normal and tangent
    std::vector<double> airSpeed;                                  ///< along the normal as predicted, m/s
    std::vector<effects::AirResponse> air;
    std::vector<Eigen::Index> columns; ///< storage: those of a point that are not zero
    int tries = 0;                     ///< linearisations of this step so far
};

/// Attraction between a place of a rod and what is near (adhesion.h), linearised.
struct AdhesionWork {
    int rodA = -1, rodB = -1, bodyB = -1; ///< bodyB: index into World::bodies
    std::size_t point = 0;                ///< of rod A's Attraction
    double share = 1.0;                   ///< of its weight
    Vec2 normal = Vec2::UnitX();          ///< from B to A
    double force = 0.0;                   ///< as linearised, towards each other, N
    double stiffness = 0.0;               ///< >= 0, of each side's own motion, N/m
    Eigen::RowVectorXd rowA, rowB;        ///< velocity along the normal
    double wayA = 0.0, wayB = 0.0;        ///< along the normal in the step as predicted, m
    double surface = 0.0;                 ///< velocity of a body along the normal, m/s
    Vec2 armB = Vec2::Zero();             ///< foot minus body centre, m
};

/// Storage of the factorisations of a held rod's rows: m x n rows C, of rank k.
struct HoldWork {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr; ///< of C^T
    Eigen::MatrixXd Ct, Q, turned, reduced;         ///< n x m, n x n, Q^T A Q: n x n, (n - k)^2
    Eigen::VectorXd permuted, rhs, impulse, rate, scratch, gaps;
    Eigen::VectorXd closing; ///< per row: velocity at which the gap found at the start closes, m/s or rad/s
};

/// Two points of one rod that are near each other.
struct SelfPair {
    std::array<double, 2> s{}; ///< m
    double gap = 0.0;          ///< at the start, m
    double distance = 0.0;     ///< of the points, at the start, m
};

/// A stage of a rod's free motion (free_motion.h).
struct FreeStage {
    Eigen::VectorXd q0, p0;                      ///< where it starts
    Eigen::VectorXd q, p, v;                     ///< what it finds
    Eigen::VectorXd impulse;                     ///< of its holds, then of its joints, N s
    Eigen::VectorXd change;                      ///< scratch
    std::vector<double> overstress0, overstress; ///< of Maxwell branches, by branch and element, 1/m
    double airPower = 0.0;                       ///< that the air takes, W
    double mousePower = 0.0;                     ///< that mouse joints give, W
};

/// Free motion of a rod within a step: state and storage. q, p, v have the centre of mass in place of the middle.
struct FreeWork {
    Eigen::VectorXd q, p, v;
    std::array<FreeStage, 2> stages;
    Vec2 middle = Vec2::Zero(), middleVelocity = Vec2::Zero(); ///< at the geometry evaluated last
    double tau = 0.0, size = 0.0, vibration = 0.0;             ///< of its group
    double least = 0.0;                                        ///< see Rod::leastBending
    double holdWork = 0.0, damped = 0.0;                       ///< J
    double relaxed = 0.0, softened = 0.0;                      ///< by Maxwell branches and by age, J
    double airTaken = 0.0, mouseWork = 0.0;                    ///< by the air, of mouse joints, J
    std::vector<double> overstress;                            ///< as in FreeStage
    int steps = 0, iterations = 0;                             ///< of its group
    Vec2 centre = Vec2::Zero(), carried = Vec2::Zero();        ///< centre of mass at the start, its way so far, m
    double about = 0.0;                                        ///< farthest way of its points about it, m
    std::vector<SelfPair> selfPairs;
    std::vector<effects::NeighbourResponse> pairs; ///< storage: of its material
    double closest = 0.0;                          ///< smallest gap of those so far, m
    Eigen::Index held = 0;                         ///< rows of its holds; those of its joints follow
    std::vector<Eigen::Index> place;               ///< of its rows among those of its group
    Eigen::MatrixXd heldRows, C, solved, schur;    ///< rows of the holds, all of them, A^-1 C^T, C A^-1 C^T
    Eigen::VectorXd mean[2], rates, impulse, shape, rate, force, product, change;
    Eigen::RowVectorXd turn;
    std::vector<Vec2> u;
};

/// What a joint does in a stage of free motion.
struct FreeJointStage {
    Eigen::Vector3d impulse{0.0, 0.0, 0.0}; ///< on rod A: N s along x and y, N m s
    double turn = 0.0;                      ///< taken from the body about its centre, N m s
    double given = 0.0, toBody = 0.0;       ///< work of motion that is given; on the body that yields, J
};

/// A link of rods that move freely: two rows of a point, one of a weld's angle; one of a taut tether.
struct FreeJoint {
    int link = -1;                          ///< index into World::links
    int a = -1, b = -1;                     ///< rods of the group, b -1: none
    int body = -1;                          ///< index into World::bodies, -1: none
    int freeBody = -1;                      ///< of the group, if that body yields
    int rows = 0;                           ///< none: a slack tether
    Eigen::Index row = 0, atA = 0, atB = 0; ///< the first of them in the group and in both ends
    std::array<FreeJointStage, 2> stages;
    Eigen::Vector3d impulse{0.0, 0.0, 0.0};                   ///< on rod A in the step so far
    double turn = 0.0, work = 0.0, drift = 0.0, toBody = 0.0; ///< likewise: N m s; J
};

/// A stage of a body: centre and angle.
struct FreeBodyStage {
    Eigen::Vector3d q0, p0, q, p, v, change;
};

/// A body of the host on which only joints of freely moving rods act.
struct FreeBody {
    int body = -1;                           ///< index into World::bodies
    Eigen::Vector3d mass, pull, slow, drift; ///< kg, kg m^2; N, N m; 1/s; m/s, rad/s
    Eigen::Vector3d q, p, v, A, change;
    Eigen::Vector3d before; ///< q at the start of the step
    std::array<FreeBodyStage, 2> stages;
    std::vector<Eigen::Index> place; ///< as FreeWork::place
    Eigen::MatrixXd C, solved, schur;
    Eigen::VectorXd impulse;
};

/// Rods that joints tie to each other, or one alone, and that move freely. Storage is kept from step to step.
struct FreeGroup {
    std::vector<std::size_t> rods; ///< indices into World::rods, sorted
    std::vector<FreeJoint> joints;
    std::vector<FreeBody> bodies;
    Eigen::Index rows = 0;         ///< of holds, then of joints
    bool tied = false;             ///< to the world or to a body of given motion
    double tau = 0.0;              ///< of the last stage, s
    double size = 0.0;             ///< of the next step of its own, s; 0: not known
    double vibration = 0.0;        ///< see Rod::vibration
    int steps = 0, iterations = 0; ///< of its own
    Eigen::MatrixXd schur;
    Eigen::LDLT<Eigen::MatrixXd> schurFactor;
    Eigen::VectorXd impulse;
};

/// One rod inside an attempt.
struct RodWork {
    rod::Kinematics kin;   ///< at the linearisation point, the (predicted) middle of the step
    rod::GaussField gauss; ///< at the linearisation point
    Eigen::VectorXd qk;    ///< linearisation point
    std::vector<Vec2> u0;  ///< material velocities at the start, carried to the linearisation point
    Eigen::MatrixXd A;     ///< M + dt^2 K + rolling + axial
    Eigen::VectorXd p;     ///< int lambda J^T u0
    Eigen::VectorXd rhs;   ///< p + dt F(q) + rolling + axial
    Eigen::VectorXd gravityForce;
    Eigen::MatrixXd C;              ///< hold rows, m x n (empty: free)
    HoldWork held;                  ///< storage of predictRod() and acceptRod()
    Eigen::VectorXd c;              ///< C v = c
    Eigen::MatrixXd Z;              ///< basis of C Z = 0, n x (n - m)
    Eigen::VectorXd vp;             ///< particular solution of C v = c
    Eigen::VectorXd contactImpulse; ///< sum of H^T r, n
    Eigen::VectorXd v;              ///< mean velocity of the step, (q1 - q) / dt
    Eigen::VectorXd q1;             ///< new configuration
    rod::Kinematics kin1;           ///< at q1
    std::vector<Vec2> u1;           ///< new material velocities at the linearisation point
    std::vector<Rolling> rolling;   ///< storage; the first rollingCount belong to this linearisation
    std::size_t rollingCount = 0;
    Eigen::VectorXd load; ///< generalised force of the applied forces, or empty
    std::vector<MouseJointWork> mouseJoints;
    Eigen::Matrix<double, 2, Eigen::Dynamic> rowsOfLoad; ///< storage
    bool frozen = false;                                 ///< quarantined or asleep: stays where it is
    bool loaded = false;                                 ///< has point forces, so that `axial` counts
    std::vector<Vec2> beyond[2];    ///< per side and segment: force that pulls at it from the tip's side, N
    std::vector<double> tension[2]; ///< per side and segment: axial force times length where in tension, else 0, N m
    Eigen::MatrixXd axial;          ///< geometric stiffness of those, n x n
    double moved = 0.0;             ///< largest node displacement over the step, m
    double shift = 0.0;             ///< largest node distance between the linearisation point and the end, m
    double error = 0.0;             ///< local error of backward Euler, m
    double turningWork = 0.0;       ///< of terms that turn with the rod (contact_stiffness.h), J
    double impactShare = 0.0;       ///< 1/2 r . (u_rel - u_rel,old) of its contacts, J
    GapClosing closing;             ///< of its joints and holds
    bool isFree = false;            ///< touches nothing in this attempt and moves as free_motion.h says
    /// Whether it takes part in the equations of the attempt.
    [[nodiscard]] bool solved() const { return !frozen && !isFree; }
    FreeWork free;
    int body = -1;         ///< index into the contact problem, -1: no candidates
    bool touching = false; ///< carries a contact force in this attempt, or has holds
    Eigen::VectorXd vFree;
    EffectWork effects;
    Eigen::VectorXd difference, product; ///< scratch, n
    Eigen::LLT<Eigen::MatrixXd> llt;     ///< of A, used where the rod has no contact
};

/// One contact inside an attempt: what the problem does not carry.
/// A factor of the friction coefficient that is too small, and one that is too large, with what the law says at the
/// slip they lead to minus themselves.
struct FactorBounds {
    double low = 0.0, atLow = 0.0, high = 0.0, atHigh = 0.0;
    int last = 0; ///< +1: the last one tried was too small, -1: too large, 0: none was
};

struct ContactWork {
    Eigen::Matrix<double, 2, Eigen::Dynamic> Ja, Jb; ///< full (unreduced) rows of rod a and rod b
    Vec2 surface = Vec2::Zero();                     ///< (n, t) velocity of a fixed or kinematic surface, m/s
    int rodA = -1, rodB = -1;
    int bodyB = -1;                    ///< index into World::bodies
    Vec2 armB = Vec2::Zero();          ///< contact point minus body centre at the linearisation point
    double closing = 0.0;              ///< at which an overlap found at the start closes unless it waits, m/s
    double slip = 0.0;                 ///< speed of slip its friction was taken at, m/s
    double friction = 1.0;             ///< factor of the friction coefficient
    FactorBounds bounds;               ///< of that factor, within one linearisation
    Vec2 give = Vec2::Zero();          ///< compliance along (n, t), m/N
    double tangentialDeflection = 0.0; ///< tangential deflection at the start of the step, m
    double damping = 0.0;              ///< of a contact that gives way (overlaps.h), N s/m; 0: it does not
};

} // namespace supercircle::step
