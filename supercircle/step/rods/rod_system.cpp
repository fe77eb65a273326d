#include "supercircle/step/rods/rod_system.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/contact_stiffness.h"
#include "supercircle/step/rods/effect_terms.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/rods/hold_springs.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <span>

namespace supercircle::step {

namespace {

/// Rolling stiffness at most, of each diagonal entry: a blow of 200 m/s on a flat element asks for more, which leaves
/// nothing of the mass but round-off. From here on a section does not turn; half or twice of it is no difference.
constexpr double kStiffestRolling = 1e10;

/// Rows (in the middle of the step) and right-hand side of the holds: C v = (target at the end - place at the start) /
/// dt, as far as the speed of closing allows.
void evaluateHolds(const World& world, const Rod& rod, double dt, RodWork& w) {
    holdRows(rod.model, rod.holds, w.kin, w.C);
    if (w.C.rows() == 0) {
        w.c.resize(0);
        return;
    }
    holdGaps(world, rod, rod.kin, Vec2::Zero(), dt, w.c);
    holdGaps(world, rod, rod.kin, Vec2::Zero(), 0.0, w.held.gaps);
    w.held.closing.resize(w.c.size());
    const double lever = rod.model.longestElement(); // of angles
    const auto close = [&](Eigen::Index row, double gap, double left) {
        w.held.closing[row] = (left - gap) / dt;
        w.c[row] = (w.c[row] + left) / dt;
    };
    forEachHeldPoint(rod.model, rod.holds, [&](Eigen::Index row, bool angle) {
        const Vec2 gap = -w.held.gaps.segment<2>(row), left = w.closing.left(gap, dt);
        close(row, gap.x(), left.x());
        close(row + 1, gap.y(), left.y());
        if (angle) {
            const double off = -w.held.gaps[row + 2];
            close(row + 2, off, w.closing.left(lever * off, dt) / lever);
        }
    });
}

} // namespace

/// Mean tangent angle of the rod's material.
double meanAngle(const rod::RodModel& model, const rod::Kinematics& kin) {
    const double mean = model.definition().length / model.elements();
    double sum = 0.0;
    for (const rod::Arc& a : kin.arcs())
        sum += (a.length / mean) * (a.angle + 0.5 * a.curvature * a.length);
    return sum / static_cast<double>(kin.arcs().size());
}

/// Turns the velocities relative to the centre of mass by `angle`.
void turnAbout(const rod::GaussField& gauss, double angle, std::vector<Vec2>& u) {
    SC_ASSERT(u.size() == gauss.mass.size(), "one velocity a Gauss point");
    Vec2 mean = Vec2::Zero();
    double mass = 0.0;
    for (std::size_t g = 0; g < u.size(); ++g) {
        mean += gauss.mass[g] * u[g];
        mass += gauss.mass[g];
    }
    SC_ASSERT(!(mass <= 0.0), "a rod has a mass");
    mean /= mass;
    const double c = math::cos(angle), s = math::sin(angle);
    for (Vec2& x : u) {
        const Vec2 d = x - mean;
        x = mean + Vec2(c * d.x() - s * d.y(), s * d.x() + c * d.y());
    }
}

/// Evaluates everything at the linearisation point w.qk.
void placeAt(const Rod& rod, RodWork& w) {
    SC_ASSERT(w.qk.size() == rod.model.dofs() && rod.v.size() == rod.model.dofs(), "state sizes are the rod's");
    w.kin.evaluate(rod.model, w.qk);
    rod::evaluateGauss(rod.model, w.kin, w.gauss);
    w.u0 = rod.u;
    turnAbout(w.gauss, meanAngle(rod.model, w.kin) - meanAngle(rod.model, rod.kin), w.u0);
}

void beginAtPredictedMiddle(const Rod& rod, double dt, double farthest, RodWork& w) {
    w.frozen = w.isFree = false;
    const double share = std::min(1.0, farthest / std::max(0.5 * dt * rod.speed, 1e-300));
    SC_ASSERT(!(share < 0.0) && !(share > 1.0), "a prediction goes a part of the way");
    w.qk = rod.q + (0.5 * dt * share) * rod.v;
    placeAt(rod, w);
}

void relineariseInMiddle(const Rod& rod, RodWork& w) {
    w.qk = 0.5 * (rod.q + w.q1);
    placeAt(rod, w);
}

void freezeRod(const Rod& rod, RodWork& w) {
    w.body = -1;
    w.touching = w.loaded = w.isFree = false;
    w.rollingCount = 0;
    w.C.resize(0, rod.model.dofs());
    w.moved = w.shift = w.error = 0.0;
    // Known from the step before, if this place in the list was this rod's then: another one may have the same
    // coordinates and other lengths or masses, or other numbers of them.
    if (w.frozen && w.qk.size() == rod.q.size() && w.qk == rod.q && w.gauss.arm == rod.gauss.arm &&
        w.gauss.mass == rod.gauss.mass && w.u1 == rod.u)
        return;
    w.frozen = true;
    w.qk = w.q1 = rod.q;
    w.v.setZero(rod.model.dofs());
    w.kin = w.kin1 = rod.kin;
    w.gauss = rod.gauss;
    w.u0 = w.u1 = rod.u;
}

void evaluateRod(const World& world, const Rod& rod, double dt, bool first, RodWork& w) {
    SC_ASSERT(dt > 0.0, "a step takes time");
    SC_ASSERT(w.rollingCount <= w.rolling.size(), "rolling terms fit their storage");
    rod::massMatrix(rod.model, w.kin, w.gauss, w.A);
    SC_ASSERT_EXPENSIVE(invariants::forAll(static_cast<std::size_t>(w.A.rows()),
                                           [&](std::size_t i) {
                                               const auto k = static_cast<Eigen::Index>(i);
                                               return !(w.A(k, k) <= 0.0);
                                           }),
                        "the diagonal of the mass matrix is positive");
    rod::addBendingStiffness(rod.model, dt * (dt + rod.dampingTime), w.A);
    rod::momentum(rod.model, w.kin, w.gauss, w.u0, w.p);
    rod::uniformForce(rod.model, w.kin, w.gauss, world.gravity, w.gravityForce);
    w.rhs = w.gravityForce;
    rod::addBendingForce(rod.model, rod.q, w.rhs);
    w.rhs = w.p + dt * w.rhs;
    for (Rolling& roll : std::span(w.rolling).first(w.rollingCount)) {
        for (Eigen::Index i = 0; i < roll.tau.size(); ++i)
            if (roll.tau[i] != 0.0)
                roll.c = std::min(roll.c, kStiffestRolling * w.A(i, i) / (0.5 * dt * roll.tau[i] * roll.tau[i]));
        w.A.noalias() += (0.5 * dt * roll.c) * roll.tau * roll.tau.transpose();
        w.rhs += roll.c * (roll.tau.dot(w.qk - rod.q) + roll.lagAngle) * roll.tau;
    }
    if (w.loaded) {
        w.A += (0.5 * dt * dt) * w.axial;
        w.difference = w.qk - rod.q;
        w.product.noalias() = w.axial * w.difference;
        w.rhs += dt * w.product;
    }
    addLoads(rod, dt, first, w);
    if (rod.effects.on())
        addEffects(rod, dt, !first, w);
    addHoldSprings(world, rod, dt, w);
    evaluateHolds(world, rod, dt, w);
    SC_ASSERT(w.A.rows() == rod.model.dofs() && w.rhs.size() == w.A.rows(), "one equation for each degree of freedom");
}

void predictRod(const Rod& rod, RodWork& w) {
    const Eigen::Index n = rod.model.dofs(), m = w.C.rows();
    SC_ASSERT(w.c.size() == m && (m == 0 || w.C.cols() == n), "one velocity a hold row");
    if (m == 0) {
        w.llt.compute(w.A);
        w.vFree = w.rhs;
        w.llt.solveInPlace(w.vFree);
        return;
    }
    HoldWork& h = w.held;
    h.Ct = w.C.transpose();
    h.qr.compute(h.Ct);
    const Eigen::Index rank = h.qr.rank(); // redundant holds (two clamps on a straight stiff piece) are dropped
    h.Q.resize(n, n);
    h.qr.householderQ().evalTo(h.Q, h.scratch);
    SC_ASSERT(rank <= std::min(m, n), "a rank is at most the number of rows");
    w.Z = h.Q.rightCols(n - rank);
    h.permuted.noalias() = h.qr.colsPermutation().transpose() * w.c;
    auto pc = h.permuted.head(rank);
    h.qr.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().transpose().solveInPlace(pc);
    w.vp.noalias() = h.Q.leftCols(rank) * pc;
    // By the few reflections that Q is made of: m n^2 instead of n^3, a fifth of a clamped shell's replay.
    h.turned = w.A;
    h.qr.householderQ().applyThisOnTheRight(h.turned, h.scratch);
    h.qr.householderQ().transpose().applyThisOnTheLeft(h.turned, h.scratch);
    h.reduced = h.turned.bottomRightCorner(n - rank, n - rank); // Z^T A Z
    w.llt.compute(h.reduced);
    h.rhs = w.rhs;
    h.rhs.noalias() -= w.A * w.vp;
    w.vFree.noalias() = w.Z.transpose() * h.rhs;
    w.llt.solveInPlace(w.vFree);
    SC_ASSERT(w.vFree.size() == n - rank && w.vp.size() == n, "free motions and held ones make all");
    SC_ASSERT_EXPENSIVE(
        !(((w.Z.transpose() * w.Z).eval() - Eigen::MatrixXd::Identity(n - rank, n - rank)).cwiseAbs().sum() >
          1e-9 * static_cast<double>(n)),
        "free motions are orthonormal");
}

/// Impulses of the holds: the least-squares solution of C^T x = force by predictRod()'s factorisation.
const Eigen::VectorXd& holdImpulses(const Eigen::VectorXd& force, HoldWork& h) {
    const Eigen::Index rank = h.qr.rank();
    h.permuted.setZero(h.Ct.cols());
    auto head = h.permuted.head(rank);
    head.noalias() = h.Q.leftCols(rank).transpose() * force;
    h.qr.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solveInPlace(head);
    h.impulse.noalias() = h.qr.colsPermutation() * h.permuted;
    return h.impulse;
}

void advanceRod(const Rod& rod, double dt, RodWork& w) {
    SC_ASSERT(w.v.size() == rod.model.dofs(), "one velocity for each degree of freedom");
    w.q1 = rod.q + dt * w.v;
    w.kin1.evaluate(rod.model, w.q1);
    w.moved = w.shift = 0.0;
    for (int i = 0; i <= rod.model.elements(); ++i) {
        w.moved = std::max(w.moved, (w.kin1.node(i) - rod.kin.node(i)).norm());
        w.shift = std::max(w.shift, (w.kin1.node(i) - w.kin.node(i)).norm());
    }
    rod::velocityField(rod.model, w.kin, w.gauss, w.v, w.u1);
    double change = 0.0;
    for (std::size_t g = 0; g < w.u1.size(); ++g)
        change = std::max(change, (w.u1[g] - w.u0[g]).squaredNorm());
    w.error = 0.5 * dt * std::sqrt(change);
}

RodEnergies acceptRod(const World& world, Rod& rod, double dt, RodWork& w) {
    RodEnergies energies;
    SC_ASSERT(!rod.frozen() && dt > 0.0, "a rod that moves, in a step that takes time");
    SC_ASSERT(w.u1.size() == w.u0.size() && w.gauss.mass.size() == w.u1.size(), "one velocity a Gauss point");
    for (std::size_t g = 0; g < w.u1.size(); ++g) {
        energies.kineticChange += 0.5 * w.gauss.mass[g] * (w.u1[g].squaredNorm() - w.u0[g].squaredNorm());
        energies.kineticLoss += 0.5 * w.gauss.mass[g] * (w.u1[g] - w.u0[g]).squaredNorm();
    }
    energies.bendingChange = rod::bendingEnergy(rod.model, w.q1) - rod::bendingEnergy(rod.model, rod.q);
    energies.secondOrder += 0.5 * rod::bendingForm(rod.model, w.q1 - rod.q);
    if (rod.dampingTime > 0.0)
        energies.damping += dt * rod.dampingTime * rod::bendingForm(rod.model, w.v);
    SC_ASSERT_EXPENSIVE(!(std::abs(w.turningWork - turningWork(rod, dt, w)) > 0.0), "judged in the motion accepted");
    energies.rollingWork = w.turningWork;
    if (w.C.rows() > 0) {
        HoldWork& held = w.held;
        held.rhs = -w.rhs - w.contactImpulse;
        held.rhs.noalias() += w.A * w.v; // = C^T (impulses of the holds)
        const Eigen::VectorXd& impulse = holdImpulses(held.rhs, held);
        held.rate.noalias() = w.C * w.v;
        energies.holdWork = impulse.dot(held.rate);
        energies.holdInjected = std::max(0.0, impulse.dot(held.closing));
        Eigen::Index row = 0;
        for (Hold& h : rod.holds) {
            h.reaction = Vec2(impulse[row], impulse[row + 1]) / dt;
            row += 2;
            h.reactionTorque = h.fixesAngle() ? impulse[row++] / dt : torqueOfHoldSpring(world, rod, h, w.kin1, dt);
            if (h.yields()) // the spring is the clamp's, and what it stores is not the rod's
                energies.holdWork += h.reactionTorque * (w.kin1.angle(rod::locate(rod.model, h.s)) -
                                                         rod.kin.angle(rod::locate(rod.model, h.s)));
            advanceTarget(world, dt, h);
        }
    }
    energies.loadWork = recordAppliedForces(rod, dt, w);
    if (rod.effects.on()) {
        const EffectEnergyChange taken = acceptEffects(rod, dt, w);
        energies.effects = taken.taken;
        energies.secondOrder += taken.secondOrder;
    }
    const Vec2 before = rod::massCentre(rod.kin, rod.gauss);
    const double turned = meanAngle(rod.model, w.kin1) - meanAngle(rod.model, w.kin);
    rod.u = w.u1;
    rod.q = w.q1;
    rod.v = w.v;
    rod.kin = w.kin1;
    rod::evaluateGauss(rod.model, rod.kin, rod.gauss);
    turnAbout(rod.gauss, turned, rod.u);
    energies.gravityChange = -rod.model.mass() * world.gravity.dot(rod::massCentre(rod.kin, rod.gauss) - before);
    energies.secondOrder -= dt * w.v.dot(w.gravityForce) + energies.gravityChange;
    rod.speed = w.moved / dt;
    rod.leastBending = rod::bendingEnergy(rod.model, rod.q);
    rod.lastAccepted = rod.q;
    SC_ASSERT(!(rod.speed < 0.0) && rod.u.size() == rod.gauss.mass.size(), "the new state is complete");
    return energies;
}

} // namespace supercircle::step
