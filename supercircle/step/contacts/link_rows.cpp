#include "supercircle/step/contacts/link_rows.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

Vec2 inRow(const LinkRow& row, const Vec2& velocity, double spin) {
    if (row.kind == LinkRowKind::Angle)
        return {row.lever * spin, 0.0};
    return {row.normal.dot(velocity), rod::perp(row.normal).dot(velocity)};
}

namespace {

/// The two points of a link and the angles of their sections at one moment.
struct Places {
    Vec2 a = Vec2::Zero(), b = Vec2::Zero(); ///< m
    double angleA = 0.0, angleB = 0.0;       ///< rad
};

enum class When { Start, Middle, End };

Vec2 turned(const Vec2& v, double angle) {
    const double c = math::cos(angle), s = math::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

const rod::Kinematics& kinematics(const World& world, const std::vector<RodWork>& rods, std::size_t i, When when) {
    if (when == When::Start || world.rods[i].frozen())
        return world.rods[i].kin;
    return when == When::Middle ? rods[i].kin : rods[i].kin1;
}

double lengthAfter(const Link& l, double dt) {
    return l.length + std::clamp(l.goal - l.length, -l.reel * dt, l.reel * dt);
}

/// Index of the rod with this key by a sorted table, -1 if there is none.
int rodOf(const std::vector<std::pair<std::uint32_t, int>>& table, std::uint32_t key) {
    const auto it = std::lower_bound(table.begin(), table.end(), std::pair<std::uint32_t, int>{key, -1});
    return it != table.end() && it->first == key ? it->second : -1;
}

/// The other end of a link; that of a rod needs its solution for the end of the step.
void placeOther(const World& world, const std::vector<RodWork>& rods, const std::vector<BodyMotion>& motion,
                const Link& l, const LinkEnds& e, When when, double dt, Places& p) {
    const double ahead = when == When::Start ? 0.0 : when == When::Middle ? 0.5 * dt : dt;
    if (e.rodB >= 0) {
        const auto ib = static_cast<std::size_t>(e.rodB);
        const rod::MaterialPoint atB = rod::locate(world.rods[ib].model, l.sB);
        const rod::Kinematics& b = kinematics(world, rods, ib, when);
        p.angleB = b.angle(atB);
        p.b = b.point(atB) + turned(l.local, p.angleB);
    } else if (e.body >= 0) {
        const BodyState& s = world.bodies[static_cast<std::size_t>(e.body)].state;
        const BodyMotion& m = motion[static_cast<std::size_t>(e.body)];
        p.angleB = s.angle + ahead * m.spin;
        p.b = s.centre + ahead * m.velocity + turned(l.local, p.angleB);
    } else {
        p.b = poseAfter(world, l.target, ahead).point;
    }
}

Places placesOf(const World& world, const std::vector<RodWork>& rods, const std::vector<BodyMotion>& motion,
                const Link& l, const LinkEnds& e, When when, double dt) {
    Places p;
    const auto ia = static_cast<std::size_t>(e.rodA);
    const rod::MaterialPoint atA = rod::locate(world.rods[ia].model, l.sA);
    const rod::Kinematics& a = kinematics(world, rods, ia, when);
    p.a = a.point(atA);
    p.angleA = a.angle(atA);
    placeOther(world, rods, motion, l, e, when, dt, p);
    return p;
}

/// Length over which the angle of a weld counts: a turn by 1 rad is as bad as so many metres.
double lever(const World& world, const LinkEnds& e) {
    return world.rods[static_cast<std::size_t>(e.rodA)].model.longestElement();
}

/// How fast a link closes what it finds open, unless it waits.
GapClosing wantedClosing(const std::vector<RodWork>& rods, const LinkEnds& e) {
    const GapClosing& a = rods[static_cast<std::size_t>(e.rodA)].closing;
    if (e.rodB < 0)
        return a;
    const GapClosing& b = rods[static_cast<std::size_t>(e.rodB)].closing;
    return b.speed < a.speed ? b : a;
}

GapClosing closingOf(const std::vector<RodWork>& rods, const ContactStage& stage, const Link& l, const LinkEnds& e) {
    return {wantedClosing(rods, e).speed, stage.gaps.shareOfLink(l.key)};
}

/// Gap of a row (both components for a locked point).
Vec2 gapOf(const LinkRow& row, const Link& l, const Places& p, double length) {
    switch (row.kind) {
    case LinkRowKind::Point:
        return p.a - p.b;
    case LinkRowKind::Angle:
        return {row.lever * (p.angleA - p.angleB - l.angle), 0.0};
    case LinkRowKind::Pull:
        return {length - (p.a - p.b).norm(), 0.0};
    }
    return Vec2::Zero();
}

/// Part of a row's gap that a step leaves open. A tether that is slack has nothing to close.
Vec2 leftOpen(const LinkRow& row, const Vec2& gap, const GapClosing& closing, double dt) {
    if (row.kind == LinkRowKind::Pull)
        return {std::min(0.0, closing.left(gap.x(), dt)), 0.0};
    return closing.left(gap, dt);
}

/// Full rows of one rod for a point `offset` from its centre line, or of its angle.
void rowsOf(const World& world, const std::vector<RodWork>& rods, std::size_t i, double s, const Vec2& offset,
            const LinkRow& row, Eigen::Matrix<double, 2, Eigen::Dynamic>& out) {
    const rod::RodModel& model = world.rods[i].model;
    const rod::MaterialPoint at = rod::locate(model, s);
    out.setZero(2, model.dofs());
    const rod::Kinematics& kin = kinematics(world, rods, i, When::Middle);
    if (row.kind == LinkRowKind::Angle) {
        Eigen::RowVectorXd turn(model.dofs());
        kin.angleRow(model, at, turn);
        out.row(0) = row.lever * turn;
        return;
    }
    kin.pointRows(model, at, offset, row.normal, rod::perp(row.normal), out);
}

/// Rows of a dynamic body's velocity and spin in its block (its sign included).
void bodyRows(const ContactStage& stage, const LinkRow& row, Eigen::Matrix<double, 2, Eigen::Dynamic>& out) {
    out.setZero(2, stage.problem.bodies[static_cast<std::size_t>(row.bodyProblem)].vFree.size());
    if (row.kind == LinkRowKind::Angle) {
        addToRow(stage, row.bodyB, Vec2::Zero(), -row.lever, out.row(0));
        return;
    }
    const Vec2 axis[2] = {row.normal, rod::perp(row.normal)};
    for (int k = 0; k < 2; ++k) // a tether's tangent carries nothing, but the local law wants a regular block
        addToRow(stage, row.bodyB, -axis[k], -axis[k].dot(rod::perp(row.armB)), out.row(k));
}

/// Velocity of the other end as far as it is given, in the row's own directions: exact over the step for places that
/// follow a path or belong to a body that is not solved for.
Vec2 givenVelocity(const World& world, const std::vector<RodWork>& rods, const ContactStage& stage, const Link& l,
                   const LinkRow& row, const LinkEnds& e, double dt) {
    Vec2 given = Vec2::Zero();
    if (e.body >= 0 && world.bodies[static_cast<std::size_t>(e.body)].dynamic) {
        const Body& body = world.bodies[static_cast<std::size_t>(e.body)];
        const HostCoupling& h = body.hostCoupling;
        given = inRow(row, h.drift + h.driftSpin * rod::perp(row.armB), h.driftSpin);
        if (row.kind == LinkRowKind::Angle && !(body.state.inertia > 0.0)) // fixed rotation: its spin is no unknown
            given.x() += row.lever * body.state.spin;
    } else if (e.rodB < 0) {
        Places start, end;
        placeOther(world, rods, stage.host.motion, l, e, When::Start, dt, start);
        placeOther(world, rods, stage.host.motion, l, e, When::End, dt, end);
        given = inRow(row, (end.b - start.b) / dt, (end.angleB - start.angleB) / dt);
    }
    if (row.kind == LinkRowKind::Pull)
        given.x() -= (lengthAfter(l, dt) - l.length) / dt;
    return given;
}

/// Relative velocity of the last solution in the row.
Vec2 lastVelocity(const World& world, const std::vector<RodWork>& rods, const ContactStage& stage, const LinkRow& row,
                  const LinkEnds& e) {
    Vec2 u = -row.surface;
    const auto add = [&](int rod, const auto& J, double sign) {
        if (rod >= 0 && !world.rods[static_cast<std::size_t>(rod)].frozen())
            u += sign * (J * rods[static_cast<std::size_t>(rod)].v);
    };
    add(e.rodA, row.Ja, 1.0);
    add(e.rodB, row.Jb, -1.0);
    if (e.body >= 0 && world.bodies[static_cast<std::size_t>(e.body)].dynamic) {
        const BodyMotion& m = stage.host.motion[static_cast<std::size_t>(e.body)];
        const HostCoupling& h = world.bodies[static_cast<std::size_t>(e.body)].hostCoupling;
        const Vec2 velocity = m.velocity - h.drift;
        const double spin = m.spin - h.driftSpin;
        const bool turns = world.bodies[static_cast<std::size_t>(e.body)].state.inertia > 0.0;
        u -= inRow(row, velocity + (turns ? spin : 0.0) * rod::perp(row.armB), turns ? spin : 0.0);
    }
    return u;
}

void addRow(const World& world, const std::vector<RodWork>& rods, double dt, bool again, int index, LinkRowKind kind,
            const LinkEnds& e, ContactStage& stage) {
    const Link& l = world.links[static_cast<std::size_t>(index)];
    const Places middle = placesOf(world, rods, stage.host.motion, l, e, When::Middle, dt);
    SC_ASSERT(e.counts && e.rodA >= 0, "a link whose ends are there");
    const std::size_t used = stage.links.count++;
    if (stage.links.rows.size() < stage.links.count)
        stage.links.rows.emplace_back();
    LinkRow& row = stage.links.rows[used];
    row.link = index;
    row.kind = kind;
    row.lever = lever(world, e);
    row.rodA = e.rodA;
    row.rodB = e.rodB;
    row.bodyB = e.body;
    row.normal = Vec2::UnitX();
    if (kind == LinkRowKind::Pull) {
        const Vec2 way = middle.b - middle.a;
        row.normal = way.norm() > 1e-9 * l.length ? Vec2(way.normalized()) : Vec2::UnitX();
    }
    SC_ASSERT(invariants::isUnit(row.normal) && !(row.lever <= 0.0), "a direction of length 1, a lever");
    rowsOf(world, rods, static_cast<std::size_t>(e.rodA), l.sA, Vec2::Zero(), row, row.Ja);
    if (e.rodB >= 0)
        rowsOf(world, rods, static_cast<std::size_t>(e.rodB), l.sB, turned(l.local, middle.angleB), row, row.Jb);
    if (e.body >= 0)
        row.armB = turned(l.local, middle.angleB);
    row.surface = givenVelocity(world, rods, stage, l, row, e, dt);
    const Vec2 gap = gapOf(row, l, placesOf(world, rods, stage.host.motion, l, e, When::Start, dt), l.length);
    const Vec2 left = leftOpen(row, gap, closingOf(rods, stage, l, e), dt);
    row.closing = (left - gap) / dt;
    row.wanted = stage.gaps.shareOfLink(l.key) < 1.0 ? Vec2((leftOpen(row, gap, wantedClosing(rods, e), dt) - gap) / dt)
                                                     : row.closing;
    if (again) {
        const Places end = placesOf(world, rods, stage.host.motion, l, e, When::End, dt);
        row.bias = (gapOf(row, l, end, lengthAfter(l, dt)) - left) / dt - lastVelocity(world, rods, stage, row, e);
    } else {
        row.bias = (gap - left) / dt;
    }
}

/// A tether far from being taut needs no row.
bool mayPull(const World& world, const std::vector<RodWork>& rods, const ContactStage& stage, const Link& l,
             const LinkEnds& e, double dt, bool again) {
    const Places start = placesOf(world, rods, stage.host.motion, l, e, When::Start, dt);
    double way = world.rods[static_cast<std::size_t>(e.rodA)].speed + l.reel;
    if (e.rodB >= 0) {
        way += world.rods[static_cast<std::size_t>(e.rodB)].speed;
    } else {
        Places end;
        placeOther(world, rods, stage.host.motion, l, e, When::End, dt, end);
        way += (end.b - start.b).norm() / dt;
    }
    const double reach = 2.0 * dt * (way + dt * world.gravity.norm()) + 0.01 * l.length;
    if (l.length - (start.a - start.b).norm() < reach)
        return true;
    if (!again)
        return false;
    const Places end = placesOf(world, rods, stage.host.motion, l, e, When::End, dt);
    return lengthAfter(l, dt) - (end.a - end.b).norm() < reach;
}

} // namespace

void findLinkEnds(const World& world, ContactStage& stage) {
    stage.links.ends.assign(world.links.size(), LinkEnds{});
    stage.scratch.rodOfKey.clear();
    if (world.links.empty())
        return;
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        stage.scratch.rodOfKey.emplace_back(world.rods[i].key, static_cast<int>(i));
    std::sort(stage.scratch.rodOfKey.begin(), stage.scratch.rodOfKey.end());
    for (std::size_t i = 0; i < world.links.size(); ++i) {
        const Link& l = world.links[i];
        LinkEnds& e = stage.links.ends[i];
        e.rodA = rodOf(stage.scratch.rodOfKey, l.rodA);
        e.rodB = l.end == LinkEnd::Rod ? rodOf(stage.scratch.rodOfKey, l.rodB) : -1;
        e.body = l.end == LinkEnd::Body ? bodyIndex(world, l.body) : -1;
        const bool there =
            e.rodA >= 0 && (e.rodB >= 0 || l.end != LinkEnd::Rod) && (e.body >= 0 || l.end != LinkEnd::Body);
        const auto moves = [&](int rod) { return rod >= 0 && !world.rods[static_cast<std::size_t>(rod)].frozen(); };
        e.counts = there && !l.broken && (moves(e.rodA) || moves(e.rodB));
    }
}

void prepareLinks(const World& world, const std::vector<RodWork>& rods, double dt, bool again, ContactStage& stage) {
    SC_ASSERT(stage.links.ends.size() == world.links.size(), "the ends of all links are known");
    stage.links.count = 0;
    for (std::size_t i = 0; i < world.links.size(); ++i) {
        const Link& l = world.links[i];
        const int index = static_cast<int>(i);
        const LinkEnds& e = stage.links.ends[i];
        if (!e.counts)
            continue;
        if (l.kind == LinkKind::Tether) {
            if (mayPull(world, rods, stage, l, e, dt, again))
                addRow(world, rods, dt, again, index, LinkRowKind::Pull, e, stage);
            continue;
        }
        addRow(world, rods, dt, again, index, LinkRowKind::Point, e, stage);
        if (l.kind == LinkKind::Weld)
            addRow(world, rods, dt, again, index, LinkRowKind::Angle, e, stage);
    }
}

void coupleLinks(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage) {
    const std::size_t first = stage.candidates.size();
    for (std::size_t i = 0; i < stage.links.count; ++i) {
        LinkRow& row = stage.links.rows[i];
        SC_ASSERT(invariants::inRange(row.link, world.links.size()), "a row belongs to a link");
        const Link& l = world.links[static_cast<std::size_t>(row.link)];
        coulomb::Contact& out = stage.problem.contacts[first + i];
        out.kind = row.kind == LinkRowKind::Pull ? coulomb::ContactKind::Unilateral : coulomb::ContactKind::Bilateral;
        out.mu = row.kind == LinkRowKind::Point ? std::numeric_limits<double>::infinity() : 0.0;
        out.id = 0;
        out.w = row.bias - row.surface;
        out.a = out.b = -1;
        out.Ha.resize(2, 0);
        out.Hb.resize(2, 0);
        const auto side = [&](int rod, const Eigen::Matrix<double, 2, Eigen::Dynamic>& J, double sign) {
            const auto r = static_cast<std::size_t>(rod);
            if (rod < 0 || world.rods[r].frozen())
                return;
            const bool isFirst = out.a < 0;
            (isFirst ? out.a : out.b) = rods[r].body;
            reduce(rods[r], J, sign, out.w, isFirst ? out.Ha : out.Hb);
        };
        side(row.rodA, row.Ja, 1.0);
        side(row.rodB, row.Jb, -1.0);
        row.bodyProblem = row.bodyB >= 0 ? stage.host.place[static_cast<std::size_t>(row.bodyB)].block : -1;
        if (row.bodyProblem >= 0) {
            SC_ASSERT(out.b < 0, "a joint connects two bodies at most");
            const bool isFirst = out.a < 0;
            (isFirst ? out.a : out.b) = row.bodyProblem;
            bodyRows(stage, row, row.Hb);
            (isFirst ? out.Ha : out.Hb) = row.Hb;
        }
        if (stage.gaps.shareOfLink(l.key) < 1.0)
            continue;
        Vec2 before = l.force;
        if (row.kind == LinkRowKind::Pull)
            before = {l.force.norm(), 0.0};
        else if (row.kind == LinkRowKind::Angle)
            before = {l.torque / row.lever, 0.0};
        stage.problem.r0.segment<2>(static_cast<Eigen::Index>(2 * (first + i))) = dt * before;
    }
}

namespace {

/// Error of a link at one moment, m.
double errorOf(const World& world, const Link& l, const LinkEnds& e, const Places& p, double length) {
    const double apart = (p.a - p.b).norm();
    if (l.kind == LinkKind::Tether)
        return std::max(0.0, apart - length);
    return l.kind == LinkKind::Pin ? apart : std::max(apart, lever(world, e) * std::abs(p.angleA - p.angleB - l.angle));
}

/// Error of a link at the end of the step beyond what the step leaves open of the gap it found, m.
double errorAtEnd(const World& world, const std::vector<RodWork>& rods, const ContactStage& stage, const Link& l,
                  const LinkEnds& e, double dt) {
    const double error =
        errorOf(world, l, e, placesOf(world, rods, stage.host.motion, l, e, When::End, dt), lengthAfter(l, dt));
    const GapClosing closing = closingOf(rods, stage, l, e);
    if (error == 0.0)
        return 0.0;
    const double before =
        errorOf(world, l, e, placesOf(world, rods, stage.host.motion, l, e, When::Start, dt), l.length);
    return std::max(0.0, error - closing.left(before, dt));
}

} // namespace

double linkError(const World& world, const std::vector<RodWork>& rods, double dt, double tolerance,
                 const ContactStage& stage) {
    double worst = 0.0;
    for (std::size_t i = 0; i < world.links.size(); ++i) {
        const Link& l = world.links[i];
        const LinkEnds& e = stage.links.ends[i];
        if (!e.counts)
            continue;
        const double size = l.kind == LinkKind::Tether ? l.length : lever(world, e);
        const double allowed = std::min(tolerance, 1e-7 * size);
        worst = std::max(worst, errorAtEnd(world, rods, stage, l, e, dt) / allowed);
    }
    for (std::size_t i = 0; i < stage.links.count; ++i) { // a tether that pulls though it is slack by now
        const LinkRow& row = stage.links.rows[i];
        if (row.kind != LinkRowKind::Pull ||
            !(stage.r[static_cast<Eigen::Index>(2 * (stage.candidates.size() + i))] > 0.0))
            continue;
        const Link& l = world.links[static_cast<std::size_t>(row.link)];
        const Places end = placesOf(world, rods, stage.host.motion, l,
                                    stage.links.ends[static_cast<std::size_t>(row.link)], When::End, dt);
        const double slack = lengthAfter(l, dt) - (end.a - end.b).norm();
        worst = std::max(worst, slack / std::min(tolerance, 1e-7 * l.length));
    }
    return worst;
}

LinkGaps linkGaps(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage) {
    LinkGaps gaps;
    for (std::size_t i = 0; i < world.links.size(); ++i) {
        const Link& l = world.links[i];
        const LinkEnds& e = stage.links.ends[i];
        if (!e.counts)
            continue;
        const Places start = placesOf(world, rods, stage.host.motion, l, e, When::Start, dt);
        const Places end = placesOf(world, rods, stage.host.motion, l, e, When::End, dt);
        gaps.before = std::max(gaps.before, errorOf(world, l, e, start, l.length));
        gaps.after = std::max(gaps.after, errorOf(world, l, e, end, lengthAfter(l, dt)));
    }
    return gaps;
}

void recordLinks(World& world, std::vector<RodWork>& rods, const ContactStage& stage, double dt) {
    for (Link& l : world.links) {
        l.force.setZero();
        l.torque = 0.0;
    }
    for (std::size_t i = 0; i < stage.links.count; ++i) {
        const LinkRow& row = stage.links.rows[i];
        const std::size_t contact = stage.candidates.size() + i;
        SC_ASSERT(2 * contact + 1 < static_cast<std::size_t>(stage.r.size()), "two impulses a row");
        const Vec2 r = stage.r.segment<2>(static_cast<Eigen::Index>(2 * contact));
        if (r.isZero(0.0))
            continue;
        Link& l = world.links[static_cast<std::size_t>(row.link)];
        Vec2 u = -row.surface;
        const auto side = [&](int rod, const Eigen::Matrix<double, 2, Eigen::Dynamic>& J, double sign) {
            if (rod < 0)
                return;
            const auto k = static_cast<std::size_t>(rod);
            u += sign * (J * rods[k].v);
            rods[k].contactImpulse += sign * (J.transpose() * r);
            if (row.kind == LinkRowKind::Pull) // a string that snaps taut is an impact; a joint only steers
                rods[k].impactShare += sign * 0.5 * r.dot(J * (rods[k].v - world.rods[k].v));
        };
        side(row.rodA, row.Ja, 1.0);
        side(row.rodB, row.Jb, -1.0);
        Vec2 force = Vec2::Zero();
        double torque = 0.0;
        if (row.kind == LinkRowKind::Angle)
            torque = l.torque = row.lever * r.x() / dt;
        else
            force = l.force = (row.normal * r.x() + rod::perp(row.normal) * r.y()) / dt;
        if (row.bodyB >= 0) {
            Body& body = world.bodies[static_cast<std::size_t>(row.bodyB)];
            body.force -= force;
            if (row.bodyProblem >= 0) {
                const Vec2 ub = row.Hb * stage.velocity[static_cast<std::size_t>(row.bodyProblem)];
                u += ub;
                world.energyBalance.toBodies += r.dot(ub);
                const double turn = dt * (rod::cross(row.armB, force) + torque);
                body.impulse -= dt * force;
                body.angularImpulse -= turn;
                body.hostCoupling.hostImpulse += dt * force;
                body.hostCoupling.hostTurnImpulse += turn;
            }
        }
        if (row.bodyProblem >= 0)
            world.energyBalance.addDrift(r.dot(row.surface));
        else
            world.energyBalance.work += r.dot(row.surface);
        world.energyBalance.positionCorrection -= r.dot(u);
        world.energyBalance.injected.link += std::max(0.0, r.dot(row.closing));
    }
}

void advanceLinks(World& world, double dt) {
    for (Link& l : world.links) {
        if (l.end == LinkEnd::World)
            advanceTarget(world, dt, l.target);
        l.length = lengthAfter(l, dt);
    }
}

} // namespace supercircle::step
