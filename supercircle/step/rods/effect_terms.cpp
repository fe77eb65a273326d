#include "supercircle/step/rods/effect_terms.h"

#include "supercircle/rod/elasticity.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Error of a moment that asks for another linearisation, as a share of B / L: 3e-5 of the force of a
/// bent shell.
constexpr double kMomentTolerance = 1e-4;
/// The same of the drag's resultant, as a share of f L.
constexpr double kDragTolerance = 1e-3;

/// Moment of the effects in an element at the end of the step: what differs from linear bending.
double extraMoment(const Rod& rod, int element, double now, double moment) {
    return moment - rod.model.definition().bendingModulus *
                        (now - rod.model.definition().naturalCurvature[static_cast<std::size_t>(element)]);
}

/// Pairs of the effects at the end of a step to q1: what differs from linear bending.
void extraPairs(const Rod& rod, const Eigen::VectorXd& q1, double dt, std::vector<effects::NeighbourResponse>& pairs) {
    effects::materialNeighbours(rod.model, rod.effects.material, rod.q, q1, dt, pairs);
    auto p = pairs.begin();
    rod::forNeighbours(rod.model, [&](int before, int after, double c) {
        const auto strain = [&](int e) {
            return q1[rod.model.dofOfElement(e)] - rod.model.definition().naturalCurvature[static_cast<std::size_t>(e)];
        };
        const double k = rod.model.definition().bendingModulus * c, moment = k * (strain(after) - strain(before));
        p->forceAfter -= moment;
        p->forceBefore += moment;
        p->ownAfter -= k;
        p->ownBefore -= k;
        p->cross += k;
        ++p;
    });
}

/// Linearised forces of a pair, before and after, at the curvatures of q1.
Vec2 linearPair(const Rod& rod, const EffectWork& work, const effects::NeighbourResponse& p,
                const Eigen::VectorXd& q1) {
    const int b = rod.model.dofOfElement(p.before), a = rod.model.dofOfElement(p.after);
    const double ofB = q1[b] - work.at[b], ofA = q1[a] - work.at[a];
    return {p.forceBefore + p.ownBefore * ofB + p.cross * ofA, p.forceAfter + p.cross * ofB + p.ownAfter * ofA};
}

void addPairs(const Rod& rod, double dt, RodWork& w) {
    EffectWork& work = w.effects;
    work.at = 2.0 * w.qk - rod.q;
    extraPairs(rod, work.at, dt, work.pairs);
    for (const effects::NeighbourResponse& p : work.pairs) {
        const int b = rod.model.dofOfElement(p.before), a = rod.model.dofOfElement(p.after);
        const Vec2 force = linearPair(rod, work, p, rod.q);
        w.rhs[b] += dt * force.x();
        w.rhs[a] += dt * force.y();
    }
    effects::addNeighbourStiffness(rod.model, work.pairs, dt * dt, w.A);
}

void addMaterial(const Rod& rod, double dt, RodWork& w) {
    EffectWork& work = w.effects;
    addPairs(rod, dt, w);
    const int n = rod.model.elements();
    work.curvature.resize(static_cast<std::size_t>(n));
    work.moment.resize(static_cast<std::size_t>(n));
    work.tangent.resize(static_cast<std::size_t>(n));
    for (int e = 0; e < n; ++e) {
        const auto k = static_cast<std::size_t>(e);
        const int dof = rod.model.dofOfElement(e);
        const double now = 2.0 * w.qk[dof] - rod.q[dof], l = rod.model.elementLength(e);
        const effects::MaterialResponse r =
            effects::materialResponse(rod.model, rod.effects.material, e, rod.q[dof], now, dt);
        work.curvature[k] = now;
        work.moment[k] = extraMoment(rod, e, now, r.moment);
        work.tangent[k] = r.tangent - rod.model.definition().bendingModulus;
        w.A(dof, dof) += dt * dt * l * work.tangent[k];
        w.rhs[dof] -= dt * l * (work.moment[k] + work.tangent[k] * (rod.q[dof] - now));
    }
}

/// A += J^T K J. A point moves with the elements between the middle of the rod and itself: a quarter of the columns in
/// the mean, and only those are touched (a drag of 62 points took half of its time here before).
void addOuter(const Eigen::Matrix<double, 2, Eigen::Dynamic>& J, const Eigen::Matrix2d& K,
              std::vector<Eigen::Index>& columns, Eigen::MatrixXd& A) {
    columns.clear();
    for (Eigen::Index c = 0; c < J.cols(); ++c)
        if (J(0, c) != 0.0 || J(1, c) != 0.0)
            columns.push_back(c);
    for (const Eigen::Index c : columns) {
        const Eigen::Vector2d f = K * J.col(c);
        double* const a = &A(0, c);
        for (const Eigen::Index r : columns)
            a[r] += J(0, r) * f.x() + J(1, r) * f.y();
    }
}

/// Newton first; from the third linearisation on secants, which cannot miss.
void addDrag(const Rod& rod, double dt, RodWork& w) {
    EffectWork& work = w.effects;
    const effects::Drag& drag = rod.effects.drag;
    const Eigen::Index n = rod.model.dofs();
    work.rows.resize(drag.points.size());
    work.way.resize(drag.points.size());
    work.drag.resize(drag.points.size());
    const Eigen::VectorXd motion = 2.0 * (w.qk - rod.q);
    for (std::size_t i = 0; i < drag.points.size(); ++i) {
        auto& J = work.rows[i];
        J.resize(2, n);
        w.kin.pointRows(rod.model, drag.points[i], Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), J);
        work.way[i] = J * motion;
        work.drag[i] = effects::dragAt(drag, i, work.way[i], work.tries > 2);
        const effects::DragResponse& p = work.drag[i];
        addOuter(J, (dt * dt) * p.stiffness, work.columns, w.A);
        w.rhs.noalias() += dt * (J.transpose() * (p.force + p.stiffness * work.way[i]));
    }
}

/// Air, linear in the speed about that of the prediction.
void addAir(const Rod& rod, double dt, RodWork& w) {
    EffectWork& work = w.effects;
    const effects::Air& air = rod.effects.air;
    work.airRows.resize(air.points.size());
    work.airSpeed.resize(air.points.size());
    work.air.resize(air.points.size());
    const Eigen::VectorXd motion = 2.0 / dt * (w.qk - rod.q);
    for (std::size_t i = 0; i < air.points.size(); ++i) {
        auto& J = work.airRows[i];
        J.resize(2, rod.model.dofs());
        const Vec2 normal = effects::normalAt(w.kin, air.points[i]);
        w.kin.pointRows(rod.model, air.points[i], Vec2::Zero(), normal, rod::perp(normal), J);
        work.airSpeed[i] = J.row(0).dot(motion);
        work.air[i] = effects::airAt(air, i, work.airSpeed[i]);
        const effects::AirResponse& p = work.air[i];
        addOuter(J, Eigen::Vector2d(dt * p.slope, 0.0).asDiagonal(), work.columns, w.A);
        w.rhs += dt * (p.slope * work.airSpeed[i] - p.force) * J.row(0).transpose();
    }
}

/// Force of the linearised air on point i, against its motion.
double linearAir(const EffectWork& work, std::size_t i, double speed) {
    return work.air[i].force + work.air[i].slope * (speed - work.airSpeed[i]);
}

/// Force of the linearised drag on point i.
Vec2 linearDrag(const EffectWork& work, std::size_t i, const Vec2& way) {
    return work.drag[i].force - work.drag[i].stiffness * (way - work.way[i]);
}

} // namespace

void addEffects(const Rod& rod, double dt, bool again, RodWork& w) {
    if (rod.effects.material.on())
        addMaterial(rod, dt, w);
    w.effects.tries = again ? w.effects.tries + 1 : 1;
    if (rod.effects.drag.on())
        addDrag(rod, dt, w);
    if (rod.effects.air.on())
        addAir(rod, dt, w);
}

double effectError(const Rod& rod, double dt, const RodWork& w) {
    double worst = 0.0;
    const EffectWork& work = w.effects;
    SC_ASSERT(!rod.effects.material.on() || work.moment.size() == static_cast<std::size_t>(rod.model.elements()),
              "one moment an element");
    SC_ASSERT(!rod.effects.drag.on() || work.drag.size() == rod.effects.drag.points.size(), "one drag a point");
    if (rod.effects.material.on()) {
        const double unit = kMomentTolerance * rod.model.definition().bendingModulus / rod.model.definition().length;
        for (int e = 0; e < rod.model.elements(); ++e) {
            const auto k = static_cast<std::size_t>(e);
            const int dof = rod.model.dofOfElement(e);
            const double now = w.q1[dof];
            const effects::MaterialResponse r =
                effects::materialResponse(rod.model, rod.effects.material, e, rod.q[dof], now, dt);
            const double linear = work.moment[k] + work.tangent[k] * (now - work.curvature[k]);
            worst = std::max(worst, std::abs(extraMoment(rod, e, now, r.moment) - linear) / unit);
        }
        std::vector<effects::NeighbourResponse> pairs;
        extraPairs(rod, w.q1, dt, pairs);
        for (std::size_t k = 0; k < work.pairs.size(); ++k) {
            const effects::NeighbourResponse& p = pairs[k];
            const Vec2 missed = linearPair(rod, work, work.pairs[k], w.q1) - Vec2(p.forceBefore, p.forceAfter);
            const double l = std::min(rod.model.elementLength(p.before), rod.model.elementLength(p.after));
            worst = std::max(worst, missed.cwiseAbs().maxCoeff() / (l * unit));
        }
    }
    if (rod.effects.drag.on()) {
        const double unit = kDragTolerance * rod.effects.drag.model.force * rod.model.definition().length;
        double sum = 0.0;
        for (std::size_t i = 0; i < work.rows.size(); ++i) {
            const Vec2 way = dt * (work.rows[i] * w.v);
            sum += (effects::dragAt(rod.effects.drag, i, way).force - linearDrag(work, i, way)).norm();
        }
        worst = std::max(worst, sum / unit);
    }
    if (rod.effects.air.on()) {
        const rod::RodDefinition& d = rod.model.definition();
        double missed = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < work.airRows.size(); ++i) {
            const double speed = work.airRows[i].row(0).dot(w.v);
            const double force = effects::airAt(rod.effects.air, i, speed).force;
            missed += std::abs(force - linearAir(work, i, speed));
            sum += std::abs(force);
        }
        worst = std::max(worst,
                         missed / (kDragTolerance * sum + kMomentTolerance * d.bendingModulus / (d.length * d.length)));
    }
    return worst;
}

EffectEnergyChange acceptEffects(Rod& rod, double dt, const RodWork& w) {
    EffectEnergyChange out;
    effects::RodEffects& fx = rod.effects;
    const EffectWork& work = w.effects;
    double given = 0.0; // work of the rod on the linearised effects
    const double before = effects::taken(fx.energies);
    if (fx.material.on()) {
        for (int e = 0; e < rod.model.elements(); ++e) {
            const auto k = static_cast<std::size_t>(e);
            const int dof = rod.model.dofOfElement(e);
            given += rod.model.elementLength(e) * (w.q1[dof] - rod.q[dof]) *
                     (work.moment[k] + work.tangent[k] * (w.q1[dof] - work.curvature[k]));
        }
        for (const effects::NeighbourResponse& p : work.pairs) {
            const int b = rod.model.dofOfElement(p.before), a = rod.model.dofOfElement(p.after);
            given -= linearPair(rod, work, p, w.q1).dot(Vec2(w.q1[b] - rod.q[b], w.q1[a] - rod.q[a]));
        }
        effects::advance(rod.model, rod.q, w.q1, dt, fx.material, fx.energies);
    }
    if (fx.drag.on()) {
        effects::EffectEnergy& book = fx.energies[static_cast<std::size_t>(effects::Key::PlanarDrag)];
        for (std::size_t i = 0; i < work.rows.size(); ++i) {
            const Vec2 way = dt * (work.rows[i] * w.v);
            given -= way.dot(linearDrag(work, i, way));
            const effects::DragResponse p = effects::dragAt(fx.drag, i, way);
            book.dissipated += fx.drag.model.force * fx.drag.weight[i] * p.slipped;
            fx.drag.stretch[i] = p.stretch;
        }
        book.stored = effects::storedEnergy(fx.drag);
    }
    for (std::size_t i = 0; fx.air.on() && i < work.airRows.size(); ++i) {
        const double speed = work.airRows[i].row(0).dot(w.v);
        given += dt * speed * linearAir(work, i, speed);
        fx.energies[static_cast<std::size_t>(effects::Key::AirDrag)].dissipated +=
            dt * speed * effects::airAt(fx.air, i, speed).force;
    }
    out.taken = effects::taken(fx.energies) - before;
    out.secondOrder = given - out.taken;
    return out;
}

} // namespace supercircle::step
