#include "supercircle/step/coupling/host_rows.h"

#include "supercircle/support/invariants.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace supercircle::step {

namespace {

/// Of the host in one problem; farther ones press with their last force, and heaps do not stand on that: with a limit
/// of 64 one of 109 crates kept moving at 0.9 m/s, whole it rests within 1e-6 m/s at the same cost. The bound is for
/// groups that joints hold together: their block is dense.
constexpr std::size_t kMostBodies = 256;
constexpr double kStiff = 1e6; ///< damping of a rigid row over the effective mass it acts on

/// A body of fixed rotation has translations only.
int freedomsOf(const Body& body) {
    return body.state.inertia > 0.0 ? 3 : 2;
}

const BodyPlace& placeOf(const ContactStage& stage, int body) {
    static const BodyPlace nowhere;
    return body >= 0 ? stage.host.place[static_cast<std::size_t>(body)] : nowhere;
}

bool isDynamic(const World& world, int body) {
    return body >= 0 && world.bodies[static_cast<std::size_t>(body)].dynamic;
}

template <class Constraint>
void endsOf(const World& world, const std::vector<Constraint>& constraints, std::vector<BodyEnds>& out) {
    out.clear();
    for (const Constraint& c : constraints)
        out.push_back({bodyIndex(world, c.a), bodyIndex(world, c.b)});
}

/// Bodies of the problem, nearest to the shells first: those at candidates and links, then their neighbours and so on.
void gatherBodies(const World& world, ContactStage& stage) {
    std::vector<int>& found = stage.scratch.problemBodies;
    found.clear();
    std::vector<char>& in = stage.scratch.marked;
    in.assign(world.bodies.size(), 0);
    const auto take = [&](int body) {
        if (isDynamic(world, body) && !in[static_cast<std::size_t>(body)]) {
            in[static_cast<std::size_t>(body)] = 1;
            found.push_back(body);
        }
    };
    for (const contact::Candidate& c : stage.candidates)
        if (c.b.rod < 0)
            take(bodyIndex(world, world.outlines[static_cast<std::size_t>(c.outline)].body));
    for (std::size_t i = 0; i < stage.links.count; ++i)
        take(stage.links.rows[i].bodyB);
    for (std::size_t i = 0; i < stage.pushes.count; ++i)
        take(stage.pushes.rows[i].bodyB);
    for (std::size_t i = 0; i < found.size() && found.size() < kMostBodies; ++i) {
        const int body = found[i]; // the list grows
        for (const std::vector<BodyEnds>* list : {&stage.host.contactEnds, &stage.host.rowEnds})
            for (const BodyEnds& e : *list)
                if (e.a == body || e.b == body)
                    take(e.a == body ? e.b : e.a);
    }
}

/// Gives every body its columns: one block per group that joints hold together.
void placeBodies(const World& world, const std::vector<int>& bodies, ContactStage& stage) {
    if (bodies.empty())
        return;
    std::vector<int>& root = stage.host.groups;
    root.resize(world.bodies.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
        while (root[static_cast<std::size_t>(i)] != i)
            i = root[static_cast<std::size_t>(i)] = root[static_cast<std::size_t>(root[static_cast<std::size_t>(i)])];
        return i;
    };
    for (const int b : bodies)
        stage.host.place[static_cast<std::size_t>(b)].freedoms = freedomsOf(world.bodies[static_cast<std::size_t>(b)]);
    for (const BodyEnds& e : stage.host.rowEnds)
        if (placeOf(stage, e.a).freedoms > 0 && placeOf(stage, e.b).freedoms > 0) {
            const int a = find(e.a), b = find(e.b);
            root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    std::vector<int>&blockOf = stage.host.groupBlocks, &size = stage.host.blockSizes;
    blockOf.assign(world.bodies.size(), -1);
    size.clear();
    for (const int b : bodies) {
        int& block = blockOf[static_cast<std::size_t>(find(b))];
        if (block < 0) {
            block = static_cast<int>(size.size());
            size.push_back(0);
        }
        BodyPlace& p = stage.host.place[static_cast<std::size_t>(b)];
        p.block = static_cast<int>(stage.problem.bodies.size()) + block;
        SC_ASSERT(p.freedoms == 2 || p.freedoms == 3, "a body translates, and turns unless that is fixed");
        p.column = size[static_cast<std::size_t>(block)];
        size[static_cast<std::size_t>(block)] += p.freedoms;
    }
    for (const int n : size) {
        stage.problem.bodies.emplace_back();
        if (!stage.host.spareBlocks.empty()) {
            std::swap(stage.problem.bodies.back(), stage.host.spareBlocks.back());
            stage.host.spareBlocks.pop_back();
        }
        stage.problem.bodies.back().A.resize(n, n);
        stage.problem.bodies.back().vFree.resize(n);
    }
}

/// Velocity of a body that is not in the problem along a row's directions.
double given(const World& world, const ContactStage& stage, int body, const Vec2& direction, double turn) {
    if (body < 0 || placeOf(stage, body).freedoms > 0 || world.bodies[static_cast<std::size_t>(body)].dynamic)
        return 0.0;
    const BodyMotion& m = stage.host.motion[static_cast<std::size_t>(body)];
    return direction.dot(m.velocity) + turn * m.spin;
}

void pushBody(ContactStage& stage, int body, const Vec2& impulse, double turn) {
    const BodyPlace& p = placeOf(stage, body);
    if (p.freedoms == 0)
        return;
    SC_ASSERT(invariants::inRange(p.block, stage.problem.bodies.size()), "a block of the problem");
    Eigen::VectorXd& momentum = stage.problem.bodies[static_cast<std::size_t>(p.block)].vFree;
    momentum.segment<2>(p.column) += impulse;
    if (p.freedoms == 3)
        momentum[p.column + 2] += turn;
}

/// True when exactly one of the ends is in the problem though both are dynamic: the other lies beyond its border.
bool onBorder(const World& world, const ContactStage& stage, const BodyEnds& e) {
    return isDynamic(world, e.a) && isDynamic(world, e.b) &&
           (placeOf(stage, e.a).freedoms > 0) != (placeOf(stage, e.b).freedoms > 0);
}

bool touchesProblem(const ContactStage& stage, const BodyEnds& e) {
    return placeOf(stage, e.a).freedoms > 0 || placeOf(stage, e.b).freedoms > 0;
}

int blockOfRow(const ContactStage& stage, const BodyEnds& e) {
    return std::max(placeOf(stage, e.a).block, placeOf(stage, e.b).block); // equal where both are in the problem
}

/// Damping that makes a row rigid.
double rigidDamping(const World& world, const HostRow& r, const BodyEnds& e, double dt) {
    double flexibility = 0.0; // inverse of the effective mass
    const auto add = [&](int body, const Vec2& axis, double turn) {
        if (!isDynamic(world, body))
            return;
        const BodyState& s = world.bodies[static_cast<std::size_t>(body)].state;
        flexibility += axis.squaredNorm() / s.mass + (s.inertia > 0.0 ? turn * turn / s.inertia : 0.0);
    };
    add(e.a, r.axisA, r.turnA);
    add(e.b, r.axisB, r.turnB);
    return flexibility > 0.0 ? kStiff / (dt * flexibility) : 0.0;
}

/// A joint row as a damper and a force on its block.
void addJointRow(const World& world, std::size_t k, double dt, ContactStage& stage) {
    const HostRow& r = world.constraints.rows[k];
    const BodyEnds& e = stage.host.rowEnds[k];
    const int saturated = stage.host.saturated[k];
    if (onBorder(world, stage, e)) {
        pushBody(stage, e.a, dt * r.last * r.axisA, dt * r.last * r.turnA);
        pushBody(stage, e.b, dt * r.last * r.axisB, dt * r.last * r.turnB);
        return;
    }
    SC_ASSERT(saturated >= -1 && saturated <= 1, "a sign");
    SC_ASSERT(blockOfRow(stage, e) >= static_cast<int>(stage.host.firstBlock),
              "blocks of the host stand behind the rods");
    coulomb::Body& block = stage.problem.bodies[static_cast<std::size_t>(blockOfRow(stage, e))];
    stage.host.row.assign(static_cast<std::size_t>(block.A.cols()), 0.0);
    Eigen::Map<Eigen::RowVectorXd> row(stage.host.row.data(), block.A.cols());
    addToRow(stage, e.a, r.axisA, r.turnA, row);
    addToRow(stage, e.b, r.axisB, r.turnB, row);
    double damping = r.damping, force = r.force, speed = 0.0;
    if (r.kind == HostRowKind::Rigid) {
        if (saturated != 0) {
            damping = 0.0;
            force = saturated * r.strength;
        } else {
            damping = rigidDamping(world, r, e, dt);
            force = 0.0;
            speed = r.speed;
        }
    }
    speed -= given(world, stage, e.a, r.axisA, r.turnA) + given(world, stage, e.b, r.axisB, r.turnB);
    block.A.noalias() += (dt * damping) * row.transpose() * row;
    block.vFree += (dt * (force + damping * speed)) * row.transpose();
}

/// Row of a contact's or limit's relative velocity on both sides.
struct Sides {
    Vec2 axisA = Vec2::Zero(), axisB = Vec2::Zero();
    double turnA = 0.0, turnB = 0.0;
};

Sides contactSides(const HostContact& c, const Vec2& direction) {
    return {-direction, direction, -rod::cross(c.armA, direction), rod::cross(c.armB, direction)};
}

double relative(const World& world, const ContactStage& stage, const BodyEnds& e, const Sides& s) {
    const auto side = [&](int body, const Vec2& axis, double turn) {
        if (body < 0)
            return 0.0;
        const Body& b = world.bodies[static_cast<std::size_t>(body)];
        const BodyMotion& m = stage.host.motion[static_cast<std::size_t>(body)];
        return axis.dot(m.velocity - b.hostCoupling.drift) + turn * (m.spin - b.hostCoupling.driftSpin);
    };
    return side(e.a, s.axisA, s.turnA) + side(e.b, s.axisB, s.turnB);
}

/// Writes two rows into a contact of the problem; bodies outside it go into w.
void putRows(const World& world, ContactStage& stage, const BodyEnds& e, const Sides& n, const Sides& t,
             coulomb::Contact& out) {
    const int blockA = placeOf(stage, e.a).block, blockB = placeOf(stage, e.b).block;
    out.a = blockA >= 0 ? blockA : blockB;
    out.b = blockA >= 0 && blockB != blockA ? blockB : -1;
    const auto columns = [&](int block) {
        return block >= 0 ? stage.problem.bodies[static_cast<std::size_t>(block)].vFree.size() : Eigen::Index{0};
    };
    SC_ASSERT(out.a >= 0 && out.a != out.b, "a constraint of the host acts on a body of the problem");
    out.Ha.setZero(2, columns(out.a));
    out.Hb.setZero(2, columns(out.b));
    out.w.setZero();
    const Sides* const sides[2] = {&n, &t};
    for (int i = 0; i < 2; ++i) {
        const Sides& s = *sides[i];
        addToRow(stage, e.a, s.axisA, s.turnA, (blockA == out.a ? out.Ha : out.Hb).row(i));
        addToRow(stage, e.b, s.axisB, s.turnB, (blockB == out.a ? out.Ha : out.Hb).row(i));
        out.w[i] = given(world, stage, e.a, s.axisA, s.turnA) + given(world, stage, e.b, s.axisB, s.turnB);
    }
    out.id = 0;
    out.kind = coulomb::ContactKind::Unilateral;
}

} // namespace

BodyMotion freeMotion(const World& world, const Body& b, const Vec2& host, double hostSpin, double dt) {
    const BodyState& s = b.state;
    return {(s.velocity + dt * s.gravityScale * world.gravity) / (1.0 + dt * s.linearDamping) + dt * host,
            s.spin / (1.0 + dt * s.angularDamping) + dt * hostSpin};
}

void addToRow(const ContactStage& stage, int body, const Vec2& direction, double turn, RowRef row) {
    const BodyPlace& p = placeOf(stage, body);
    if (p.freedoms == 0)
        return;
    SC_ASSERT_EXPENSIVE(p.column >= 0 && p.column + p.freedoms <= row.size(), "columns of the body lie in its block");
    row.segment<2>(p.column) += direction.transpose();
    if (p.freedoms == 3)
        row[p.column + 2] += turn;
}

void addHostBlocks(const World& world, double dt, ContactStage& stage) {
    stage.host.place.assign(world.bodies.size(), BodyPlace{});
    endsOf(world, world.constraints.contacts, stage.host.contactEnds);
    endsOf(world, world.constraints.rows, stage.host.rowEnds);
    gatherBodies(world, stage);
    stage.host.firstBlock = stage.problem.bodies.size();
    placeBodies(world, stage.scratch.problemBodies, stage);
    renewHostBlocks(world, dt, stage);
}

void beginHostRows(const World& world, ContactStage& stage) {
    stage.host.saturated.clear();
    for (const HostRow& r : world.constraints.rows)
        stage.host.saturated.push_back(r.saturated);
}

void renewHostBlocks(const World& world, double dt, ContactStage& stage) {
    for (std::size_t b = stage.host.firstBlock; b < stage.problem.bodies.size(); ++b) {
        stage.problem.bodies[b].A.setZero();
        stage.problem.bodies[b].vFree.setZero(); // holds the momentum until the rows are in
    }
    for (const int i : stage.scratch.problemBodies) {
        const Body& body = world.bodies[static_cast<std::size_t>(i)];
        const BodyPlace& p = placeOf(stage, i);
        const BodyMotion free = freeMotion(world, body, body.hostCoupling.unexplained.expectedLinear,
                                           body.hostCoupling.unexplained.expectedAngular, dt);
        Eigen::MatrixXd& A = stage.problem.bodies[static_cast<std::size_t>(p.block)].A;
        const double m = body.state.mass, inertia = body.state.inertia;
        SC_ASSERT(body.dynamic && m > 0.0, "a dynamic body has a mass");
        A.diagonal().segment(p.column, p.freedoms) = Eigen::Vector3d(m, m, inertia).head(p.freedoms);
        pushBody(stage, i, m * free.velocity, inertia * free.spin);
    }
    for (std::size_t k = 0; k < stage.host.rowEnds.size(); ++k)
        if (touchesProblem(stage, stage.host.rowEnds[k]) && world.constraints.rows[k].kind != HostRowKind::Limit)
            addJointRow(world, k, dt, stage);
    for (std::size_t k = 0; k < stage.host.contactEnds.size(); ++k) {
        const BodyEnds& e = stage.host.contactEnds[k];
        if (!onBorder(world, stage, e))
            continue;
        const HostContact& c = world.constraints.contacts[k];
        const Vec2 f = dt * (c.normalForce * c.normal + c.tangentForce * rod::perp(c.normal));
        pushBody(stage, e.a, -f, -rod::cross(c.armA, f));
        pushBody(stage, e.b, f, rod::cross(c.armB, f));
    }
    const std::size_t blocks = stage.problem.bodies.size() - stage.host.firstBlock;
    stage.host.blockFactors.resize(std::max(stage.host.blockFactors.size(), blocks));
    for (std::size_t b = 0; b < blocks; ++b) {
        coulomb::Body& block = stage.problem.bodies[stage.host.firstBlock + b];
        stage.host.blockFactors[b].compute(block.A);
        stage.host.blockFactors[b].solveInPlace(block.vFree);
    }
}

void listHostContacts(const World& world, ContactStage& stage) {
    SC_ASSERT(stage.host.contactEnds.size() == world.constraints.contacts.size() &&
                  stage.host.rowEnds.size() == world.constraints.rows.size(),
              "the ends of all constraints are known");
    stage.host.entries.clear();
    const auto counts = [&](const BodyEnds& e) { return touchesProblem(stage, e) && !onBorder(world, stage, e); };
    for (std::size_t k = 0; k < stage.host.contactEnds.size(); ++k)
        if (counts(stage.host.contactEnds[k]))
            stage.host.entries.push_back(static_cast<int>(k));
    for (std::size_t k = 0; k < stage.host.rowEnds.size(); ++k)
        if (world.constraints.rows[k].kind == HostRowKind::Limit && counts(stage.host.rowEnds[k]))
            stage.host.entries.push_back(-1 - static_cast<int>(k));
}

void addHostContacts(const World& world, double dt, ContactStage& stage) {
    const std::size_t first = stage.candidates.size() + stage.links.count;
    SC_ASSERT(first + stage.host.entries.size() + stage.pushes.count == stage.problem.contacts.size(),
              "only pushes stand behind the contacts of the host");
    for (std::size_t i = 0; i < stage.host.entries.size(); ++i) {
        coulomb::Contact& out = stage.problem.contacts[first + i];
        Vec2 warm = Vec2::Zero();
        if (const int entry = stage.host.entries[i]; entry >= 0) {
            const BodyEnds& e = stage.host.contactEnds[static_cast<std::size_t>(entry)];
            const HostContact& c = world.constraints.contacts[static_cast<std::size_t>(entry)];
            putRows(world, stage, e, contactSides(c, c.normal), contactSides(c, rod::perp(c.normal)), out);
            out.mu = c.friction;
            out.w += Vec2(c.clearance > 0.0 ? c.clearance / dt : -c.restitutionVelocity, -c.tangentSpeed);
            warm = dt * Vec2(c.normalForce, c.tangentForce);
        } else {
            const BodyEnds& e = stage.host.rowEnds[static_cast<std::size_t>(-1 - entry)];
            const HostRow& r = world.constraints.rows[static_cast<std::size_t>(-1 - entry)];
            const Sides n{r.axisA, r.axisB, r.turnA, r.turnB};
            const Sides t{Vec2::UnitX(), Vec2::UnitY(), 0.0, 0.0}; // any rows do: nothing rubs
            putRows(world, stage, e, n, t, out);
            out.mu = 0.0;
            out.w = Vec2(out.w.x() + r.clearance / dt, 0.0);
            warm.x() = dt * std::max(0.0, r.last);
        }
        stage.problem.r0.segment<2>(static_cast<Eigen::Index>(2 * (first + i))) = warm;
    }
}

void readHostBlocks(const World& world, ContactStage& stage) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        const Body& b = world.bodies[i];
        if (!b.dynamic || stage.host.motion[i].isFree)
            continue;
        const HostCoupling& h = b.hostCoupling;
        BodyMotion m = freeMotion(world, b, h.all.expectedLinear, h.all.expectedAngular, stage.problem.dt);
        const BodyPlace p = stage.problem.contacts.empty() ? BodyPlace{} : stage.host.place[i];
        if (p.block >= 0) {
            const Eigen::VectorXd& x = stage.velocity[static_cast<std::size_t>(p.block)];
            SC_ASSERT(p.column + p.freedoms <= x.size(), "columns of the body lie in its block");
            m.velocity = x.segment<2>(p.column);
            m.spin = p.freedoms == 3 ? x[p.column + 2] : b.state.spin;
        }
        stage.host.motion[i] = {m.velocity + h.drift, m.spin + h.driftSpin};
    }
}

bool boundHostRows(const World& world, double dt, ContactStage& stage) {
    bool changed = false;
    for (std::size_t k = 0; k < stage.host.rowEnds.size() && !stage.problem.contacts.empty(); ++k) {
        const BodyEnds& e = stage.host.rowEnds[k];
        const HostRow& row = world.constraints.rows[k];
        if (row.kind != HostRowKind::Rigid || stage.host.saturated[k] != 0 || !std::isfinite(row.strength) ||
            !touchesProblem(stage, e) || onBorder(world, stage, e))
            continue;
        const double u = relative(world, stage, e, {row.axisA, row.axisB, row.turnA, row.turnB});
        const double force = rigidDamping(world, row, e, dt) * (row.speed - u);
        if (std::abs(force) <= row.strength)
            continue;
        SC_ASSERT(k < stage.host.saturated.size(), "one state a row of the host");
        stage.host.saturated[k] = force > 0.0 ? 1 : -1;
        changed = true;
    }
    return changed;
}

void acceptHostConstraints(World& world, const ContactStage& stage, double dt) {
    if (stage.problem.contacts.empty())
        return;
    const std::size_t first = stage.candidates.size() + stage.links.count;
    for (std::size_t i = 0; i < stage.host.entries.size(); ++i) {
        const Vec2 r = stage.r.segment<2>(static_cast<Eigen::Index>(2 * (first + i)));
        const int entry = stage.host.entries[i];
        if (entry >= 0) {
            const BodyEnds& e = stage.host.contactEnds[static_cast<std::size_t>(entry)];
            HostContact& c = world.constraints.contacts[static_cast<std::size_t>(entry)];
            c.clearance = std::max(0.0, c.clearance + dt * relative(world, stage, e, contactSides(c, c.normal)));
            SC_ASSERT(!(c.clearance < 0.0), "a clearance is not negative");
            c.normalForce = r.x() / dt;
            c.tangentForce = r.y() / dt;
            c.sumNormal += r.x();
            c.sumTangent += r.y();
        } else {
            const auto k = static_cast<std::size_t>(-1 - entry);
            HostRow& row = world.constraints.rows[k];
            row.clearance = std::max(0.0, row.clearance + dt * relative(world, stage, stage.host.rowEnds[k],
                                                                        {row.axisA, row.axisB, row.turnA, row.turnB}));
            row.last = r.x() / dt;
            row.sum += r.x();
        }
    }
    for (std::size_t k = 0; k < stage.host.rowEnds.size(); ++k) {
        const BodyEnds& e = stage.host.rowEnds[k];
        HostRow& row = world.constraints.rows[k];
        if (row.kind == HostRowKind::Limit || !touchesProblem(stage, e) || onBorder(world, stage, e))
            continue;
        const double u = relative(world, stage, e, {row.axisA, row.axisB, row.turnA, row.turnB});
        if (row.kind == HostRowKind::Soft) {
            row.sum += dt * (row.force - row.damping * u);
            continue;
        }
        const double missing = row.speed - u;
        row.saturated = stage.host.saturated[k];
        if (row.saturated != 0) {
            row.sum += dt * row.saturated * row.strength;
            if (row.saturated * missing < 0.0)
                row.saturated = 0;
            continue;
        }
        row.last = rigidDamping(world, row, e, dt) * missing;
        row.sum += dt * row.last;
    }
}

} // namespace supercircle::step
