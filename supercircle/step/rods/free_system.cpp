#include "supercircle/step/rods/free_system.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/contact_stiffness.h"
#include "supercircle/step/rods/free_material.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/rods/sdirk2.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr int kMostIterations = 16; ///< of a stage; twice as many seldom save a step
/// Each leaves a small part of what was open: of 286 000 steps of joined strips 214 take two, none more. Halved, six
/// steps are cut and strips of a game lose 40 % of their energy; doubled, nothing changes.
constexpr int kMostClosings = 4;
/// Of the length. Halved, 361 steps take two, doubled, 103, at the same cost; a hundred times it is left to momentum.
constexpr double kCloseEnough = 1e-9;

} // namespace

void FreeSystem::listBodies() {
    for (FreeBody& b : g_.bodies) {
        const Body& body = world_.bodies[static_cast<std::size_t>(b.body)];
        const BodyState& s = body.state;
        const HostCoupling& h = body.hostCoupling;
        const Vec2 pull = s.gravityScale * world_.gravity + h.unexplained.expectedLinear;
        b.mass = {s.mass, s.mass, s.inertia};
        b.pull = b.mass.cwiseProduct(Eigen::Vector3d(pull.x(), pull.y(), h.unexplained.expectedAngular));
        b.slow = {s.linearDamping, s.linearDamping, s.angularDamping};
        b.drift = {h.drift.x(), h.drift.y(), h.driftSpin};
        b.q = b.before = {s.centre.x(), s.centre.y(), s.angle};
        b.v = {s.velocity.x(), s.velocity.y(), s.spin};
        b.p = b.mass.cwiseProduct(b.v);
        b.place.clear();
    }
}

void FreeSystem::listRows() {
    g_.rows = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        FreeWork& f = free(i);
        f.held = holdRowCount(rod(i).model, rod(i).holds);
        f.place.clear();
        for (Eigen::Index r = 0; r < f.held; ++r)
            f.place.push_back(g_.rows++);
    }
    const auto addTo = [&](std::vector<Eigen::Index>& place, Eigen::Index& at, const FreeJoint& j) {
        at = static_cast<Eigen::Index>(place.size());
        for (int r = 0; r < j.rows; ++r)
            place.push_back(j.row + r);
    };
    for (FreeJoint& j : g_.joints) {
        j.impulse.setZero();
        j.work = j.toBody = j.drift = j.turn = 0.0;
        j.row = g_.rows;
        g_.rows += j.rows;
        addTo(free(static_cast<std::size_t>(j.a)).place, j.atA, j);
        if (j.b == j.a)
            j.atB = j.atA;
        else if (j.b >= 0)
            addTo(free(static_cast<std::size_t>(j.b)).place, j.atB, j);
        else if (j.freeBody >= 0)
            addTo(g_.bodies[static_cast<std::size_t>(j.freeBody)].place, j.atB, j);
    }
}

bool FreeSystem::begin() {
    listBodies();
    bool closed = true;
    for (FreeJoint& j : g_.joints) {
        const Link& l = linkOf(j);
        j.rows = l.kind == LinkKind::Pin ? 2 : l.kind == LinkKind::Weld ? 3 : 1;
        if (l.kind == LinkKind::Tether && l.force.isZero(0.0)) {
            j.rows = 0;
            closed = closed && gapOf(j, placesOf(j, 0.0, At::State)).x() <= 0.0;
        } else {
            closed = closed && isClosed(j);
        }
    }
    listRows();
    return closed;
}

void FreeSystem::evaluate() {
    for (std::size_t i = 0; i < size(); ++i)
        equations(i).evaluate(free(i).q, free(i).v);
}

/// Forces as they were last, whose geometric stiffness the matrices of joined rods have: it makes no other solution,
/// but its iteration converges in steps that do not resolve the strings.
void FreeSystem::collectPulls() {
    for (std::size_t i = 0; i < size(); ++i) {
        beginPulls(rod(i).model, work(i));
        for (const AppliedForce& a : rod(i).forces)
            pull(rod(i).model, rod::locate(rod(i).model, a.s), a.force, work(i));
        for (const MouseJoint& g : rod(i).mouseJoints)
            pull(rod(i).model, rod::locate(rod(i).model, g.s), g.force, work(i));
        for (const Hold& h : rod(i).holds)
            pull(rod(i).model, rod::locate(rod(i).model, h.s), h.reaction, work(i));
    }
    for (const FreeJoint& j : g_.joints) {
        const Link& l = linkOf(j);
        const Vec2 force = g_.steps > 0 ? Vec2(j.stages[1].impulse.head<2>() / g_.tau) : l.force;
        const auto at = [&](int rodOfGroup, double s, const Vec2& f) {
            if (const auto i = static_cast<std::size_t>(rodOfGroup); rodOfGroup >= 0 && j.rows > 0)
                pull(rod(i).model, rod::locate(rod(i).model, s), f, work(i));
        };
        at(j.a, l.sA, force);
        at(j.b, l.sB, -force);
    }
    for (std::size_t i = 0; i < size(); ++i)
        if (work(i).loaded)
            axialOfPulls(rod(i).model, work(i));
}

void FreeSystem::factor(double tau) {
    if (!g_.joints.empty())
        collectPulls();
    for (std::size_t i = 0; i < size(); ++i)
        equations(i).factor(tau, free(i).q, !g_.joints.empty() && work(i).loaded);
    for (FreeBody& b : g_.bodies)
        b.A = b.mass + tau * b.slow.cwiseProduct(b.mass);
}

void FreeSystem::startStage(std::size_t stage) {
    const auto start = [&](const auto& now, auto& stages) {
        auto &one = stages[0], &two = stages[1];
        if (stage == 0) {
            one.q0 = now.q;
            one.p0 = now.p;
            one.v = now.v;
        } else {
            two.q0 = now.q + kExtrapolate * (one.q - now.q);
            two.p0 = now.p + kExtrapolate * (one.p - now.p);
            two.v = now.v + (one.v - now.v) / kGamma;
        }
    };
    for (std::size_t i = 0; i < size(); ++i) {
        start(free(i), free(i).stages);
        startMaterial(stage, free(i));
    }
    for (FreeBody& b : g_.bodies)
        start(b, b.stages);
}

void FreeSystem::jointRows(const FreeJoint& j, double ahead, At at) {
    const Link& l = linkOf(j);
    const Places p = placesOf(j, ahead, at);
    g_.impulse.segment(j.row, j.rows) = givenRate(j, p).head(j.rows);
    const auto ofRod = [&](int rodOfGroup, double s, const Vec2& offset, double sign, Eigen::Index row) {
        const auto i = static_cast<std::size_t>(rodOfGroup);
        const rod::MaterialPoint point = rod::locate(rod(i).model, s);
        FreeEquations e = equations(i);
        if (l.kind == LinkKind::Tether)
            e.addPointRow(point, offset, (p.b - p.a).normalized(), sign, row);
        else
            e.addPointRows(point, offset, sign, row);
        if (l.kind == LinkKind::Weld)
            e.addAngleRow(point, sign, row + 2);
    };
    ofRod(j.a, l.sA, Vec2::Zero(), 1.0, j.atA);
    if (j.b >= 0)
        ofRod(j.b, l.sB, p.offset, -1.0, j.atB);
    if (j.freeBody < 0)
        return;
    Eigen::MatrixXd& C = g_.bodies[static_cast<std::size_t>(j.freeBody)].C;
    const Vec2 turn = rod::perp(p.offset);
    if (l.kind == LinkKind::Tether) {
        const Vec2 n = (p.b - p.a).normalized();
        C.row(j.atB) = Eigen::RowVector3d(-n.x(), -n.y(), -n.dot(turn));
        return;
    }
    C.row(j.atB) = Eigen::RowVector3d(-1.0, 0.0, -turn.x());
    C.row(j.atB + 1) = Eigen::RowVector3d(0.0, -1.0, -turn.y());
    if (l.kind == LinkKind::Weld)
        C.row(j.atB + 2) = Eigen::RowVector3d(0.0, 0.0, -1.0);
}

/// Rows at the geometry evaluated last, and into g.impulse the velocities that they ask for.
void FreeSystem::rows(double ahead, At at) {
    g_.impulse.setZero(g_.rows);
    g_.schur.setZero(g_.rows, g_.rows);
    for (std::size_t i = 0; i < size(); ++i) {
        equations(i).holdRows();
        holdRates(world_, rod(i), ahead, free(i).rates);
        for (Eigen::Index r = 0; r < free(i).held; ++r)
            g_.impulse[free(i).place[static_cast<std::size_t>(r)]] = free(i).rates[r];
    }
    for (FreeBody& b : g_.bodies)
        b.C.setZero(static_cast<Eigen::Index>(b.place.size()), 3);
    for (const FreeJoint& j : g_.joints)
        if (j.rows > 0)
            jointRows(j, ahead, at);
    const auto add = [&](const std::vector<Eigen::Index>& place, const Eigen::MatrixXd& schur) {
        for (std::size_t c = 0; c < place.size(); ++c)
            for (std::size_t r = 0; r < place.size(); ++r)
                g_.schur(place[r], place[c]) += schur(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    };
    for (std::size_t i = 0; i < size(); ++i) {
        equations(i).eliminate();
        add(free(i).place, free(i).schur);
    }
    for (FreeBody& b : g_.bodies) {
        b.solved = b.A.cwiseInverse().asDiagonal() * b.C.transpose();
        b.schur.noalias() = b.C * b.solved;
        add(b.place, b.schur);
    }
    g_.schurFactor.compute(g_.schur);
}

/// g.impulse = (C A^-1 C^T)^-1 g.impulse, where rows that others make redundant take nothing.
void FreeSystem::solveSchur() {
    constexpr double kRedundant = 1e-12; // of the largest pivot: those of two clamps on a stiff piece are 1e-16 of it
    const auto& factor = g_.schurFactor;
    const auto pivots = factor.vectorD();
    const double least = kRedundant * pivots.maxCoeff();
    g_.impulse = factor.transpositionsP() * g_.impulse;
    factor.matrixL().solveInPlace(g_.impulse);
    for (Eigen::Index i = 0; i < pivots.size(); ++i)
        g_.impulse[i] = pivots[i] > least ? g_.impulse[i] / pivots[i] : 0.0;
    factor.matrixU().solveInPlace(g_.impulse);
    g_.impulse = factor.transpositionsP().transpose() * g_.impulse;
}

void FreeSystem::gather(const std::vector<Eigen::Index>& place, Eigen::VectorXd& own) const {
    own.resize(static_cast<Eigen::Index>(place.size()));
    for (std::size_t r = 0; r < place.size(); ++r)
        own[static_cast<Eigen::Index>(r)] = g_.impulse[place[r]];
}

void FreeSystem::scatter(const Eigen::VectorXd& own, const std::vector<Eigen::Index>& place) {
    for (std::size_t r = 0; r < place.size(); ++r)
        g_.impulse[place[r]] = own[static_cast<Eigen::Index>(r)];
}

template <class OfRod, class OfBody>
void FreeSystem::takeOff(const OfRod& ofRod, const OfBody& ofBody) {
    for (std::size_t i = 0; i < size(); ++i) {
        FreeWork& f = free(i);
        gather(f.place, f.impulse);
        f.impulse.noalias() -= f.C * ofRod(f);
        scatter(f.impulse, f.place);
    }
    for (FreeBody& b : g_.bodies) {
        gather(b.place, b.impulse);
        b.impulse.noalias() -= b.C * ofBody(b);
        scatter(b.impulse, b.place);
    }
}

template <class OfRod, class OfBody>
void FreeSystem::addSolved(const OfRod& ofRod, const OfBody& ofBody) {
    solveSchur();
    for (std::size_t i = 0; i < size(); ++i) {
        FreeWork& f = free(i);
        gather(f.place, f.impulse);
        ofRod(f).noalias() += f.solved * f.impulse;
    }
    for (FreeBody& b : g_.bodies) {
        gather(b.place, b.impulse);
        ofBody(b).noalias() += b.solved * b.impulse;
    }
}

void FreeSystem::constrainChange() {
    g_.impulse.setZero(g_.rows);
    const auto ofRod = [](FreeWork& f) -> Eigen::VectorXd& { return f.change; };
    const auto ofBody = [](FreeBody& b) -> Eigen::Vector3d& { return b.change; };
    takeOff(ofRod, ofBody);
    addSolved(ofRod, ofBody);
}

/// One iteration: residuals of all, and the impulses of the rows.
void FreeSystem::iterate(std::size_t stage, double tau, double ahead) {
    for (std::size_t i = 0; i < size(); ++i)
        equations(i).residual(tau, ahead, free(i).stages[stage]);
    for (FreeBody& b : g_.bodies) {
        FreeBodyStage& s = b.stages[stage];
        s.q = s.q0 + tau * (s.v + b.drift);
        s.p = s.p0 + tau * (b.pull - b.slow.cwiseProduct(b.mass).cwiseProduct(s.v));
        s.change = (s.p - b.mass.cwiseProduct(s.v)).cwiseQuotient(b.A);
    }
    if (!hasRows())
        return;
    rows(ahead, stage == 0 ? At::First : At::Second);
    takeOff([&](FreeWork& f) -> Eigen::VectorXd& { return f.stages[stage].v; },
            [&](FreeBody& b) -> Eigen::Vector3d& { return b.stages[stage].v; });
    const auto ofRod = [&](FreeWork& f) -> Eigen::VectorXd& { return f.stages[stage].change; };
    const auto ofBody = [&](FreeBody& b) -> Eigen::Vector3d& { return b.stages[stage].change; };
    takeOff(ofRod, ofBody);
    addSolved(ofRod, ofBody);
    for (std::size_t i = 0; i < size(); ++i) {
        FreeWork& f = free(i);
        f.stages[stage].impulse = f.impulse;
        f.stages[stage].p.noalias() += f.C.transpose() * f.impulse;
    }
    for (FreeBody& b : g_.bodies)
        b.stages[stage].p += b.C.transpose() * b.impulse;
}

bool FreeSystem::solve(std::size_t stage, double tau, double ahead) {
    double floor = 0.0;
    for (std::size_t i = 0; i < size(); ++i)
        floor = std::max(floor, 1e-13 * rod(i).model.definition().length / tau * std::sqrt(rod(i).model.mass()));
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMostIterations; ++i) {
        ++g_.iterations;
        iterate(stage, tau, ahead);
        double size2 = 0.0, motion2 = 0.0;
        for (std::size_t k = 0; k < size(); ++k) {
            FreeWork& f = free(k);
            FreeStage& s = f.stages[stage];
            const Eigen::MatrixXd& A = work(k).A;
            f.product.noalias() = A * s.change;
            size2 += s.change.dot(f.product);
            f.shape = s.v;
            f.shape.segment<2>(rod(k).model.dofX()).setZero();
            f.product.noalias() = A * f.shape;
            motion2 += f.shape.dot(f.product);
            s.v += s.change;
        }
        for (FreeBody& b : g_.bodies) {
            FreeBodyStage& s = b.stages[stage];
            size2 += s.change.dot(b.A.cwiseProduct(s.change));
            s.v += s.change;
        }
        const double size = std::sqrt(std::max(0.0, size2)), motion = std::sqrt(std::max(0.0, motion2));
        if (!std::isfinite(size))
            return false;
        const double enough = tolerance_ * motion + floor;
        if (size <= enough) {
            for (std::size_t k = 0; k < this->size(); ++k) {
                FreeStage& s = free(k).stages[stage];
                s.q = s.q0 + tau * s.v;
                relax(rod(k), tau, s);
            }
            for (FreeBody& b : g_.bodies)
                b.stages[stage].q = b.stages[stage].q0 + tau * (b.stages[stage].v + b.drift);
            return record(stage, ahead);
        }
        if (i > 2 && size > 0.7 * last) // too slow to come to an end, or at the end of the digits
            return size <= 1e3 * enough && record(stage, ahead);
        last = size;
    }
    return false;
}

void FreeSystem::take() {
    for (std::size_t i = 0; i < size(); ++i) {
        FreeWork& f = free(i);
        f.q = f.stages[1].q;
        f.p = f.stages[1].p;
        f.v = f.stages[1].v;
    }
    for (FreeBody& b : g_.bodies) {
        b.q = b.stages[1].q;
        b.p = b.stages[1].p;
        b.v = b.stages[1].v;
    }
    for (FreeJoint& j : g_.joints)
        if (j.rows > 0)
            for (std::size_t i = 0; i < 2; ++i) {
                const FreeJointStage& s = j.stages[i];
                const double weight = i == 0 ? kExtrapolate : 1.0; // an impulse is of tau
                j.impulse += weight * s.impulse;
                (j.freeBody >= 0 ? j.drift : j.work) += weight * s.given;
                j.turn += weight * s.turn;
                j.toBody += weight * s.toBody;
            }
}

bool FreeSystem::close(double ahead) {
    if (!hasRows())
        return true;
    const auto ofRod = [](FreeWork& f) -> Eigen::VectorXd& { return f.q; };
    const auto ofBody = [](FreeBody& b) -> Eigen::Vector3d& { return b.q; };
    double left = 0.0;
    for (int pass = 0; pass < kMostClosings; ++pass) {
        g_.impulse.setZero(g_.rows);
        left = 0.0;
        for (std::size_t i = 0; i < size(); ++i) {
            FreeWork& f = free(i);
            holdGaps(world_, rod(i), work(i).kin, f.middle, ahead, f.rates);
            for (Eigen::Index r = 0; r < f.held; ++r)
                g_.impulse[f.place[static_cast<std::size_t>(r)]] = f.rates[r];
        }
        for (const FreeJoint& j : g_.joints)
            if (j.rows > 0) {
                const Eigen::Vector3d gap = gapOf(j, placesOf(j, ahead, At::State));
                g_.impulse.segment(j.row, j.rows) = gap.head(j.rows);
                const double length = rod(static_cast<std::size_t>(j.a)).model.definition().length;
                left = std::max({left, gap.head<2>().norm() / length, std::abs(gap.z())});
            }
        if (pass > 0 && left < kCloseEnough)
            return true;
        addSolved(ofRod, ofBody);
        evaluate();
        if (g_.joints.empty())
            return true;
    }
    return left < kCloseEnough;
}

} // namespace supercircle::step
