#include "supercircle/step/contacts/contact_rows.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/contacts/excluded_pairs.h"
#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/contacts/one_sided.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/contacts/pair_materials.h"
#include "supercircle/step/contacts/passed_tips.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Row matrix of a rod's surface point in (n, t).
void surfaceRows(const Rod& rod, const RodWork& w, const contact::RodPoint& at, const Vec2& surface, const Vec2& n,
                 const Vec2& t, Eigen::Matrix<double, 2, Eigen::Dynamic>& rows) {
    const rod::MaterialPoint place = rod::locate(rod.model, at.element, at.s);
    rows.resize(2, rod.model.dofs());
    w.kin.pointRows(rod.model, place, surface - w.kin.point(place), n, t, rows);
}

const BodyOutline& pieceOf(const World& world, const contact::Candidate& c) {
    return world.outlines[static_cast<std::size_t>(c.outline)];
}

constexpr std::uint32_t kKeyMask = (1u << 20) - 1; ///< detection's ids leave 20 bits for an outline

/// Key of a body's piece that stays the same while other bodies come and go: 10 bits each, folded.
std::uint32_t outlineKey(BodyId body, std::uint32_t piece) {
    const auto low = static_cast<std::uint32_t>(body ^ (body >> 10) ^ (body >> 20)) & 1023u;
    return ((low << 10) | ((piece ^ (piece >> 10)) & 1023u)) & kKeyMask;
}

Vec2 surfaceVelocity(const BodyMotion& m, const Vec2& arm) {
    return m.velocity + m.spin * rod::perp(arm);
}

/// Whether the centre lines of two shells, or of two parts of one, all but coincide. They need not cross, but the
/// normal between them is round-off and points to either side along a shell: such rows contradict each other.
bool coincide(const World& world, const contact::Candidate& c, double gap) {
    // Of the thickness. Two rings made at one place part at 200 h/s at most, with half of it at 1240, with a quarter at
    // 34 000 and with the alarm on energy; twice as much changes little there, and is nearer to what steps may make.
    constexpr double kNear = 0.2;
    if (c.b.rod < 0)
        return false;
    const double apart = 0.5 * (world.rods[static_cast<std::size_t>(c.a.rod)].model.definition().thickness +
                                world.rods[static_cast<std::size_t>(c.b.rod)].model.definition().thickness);
    return gap < (kNear - 1.0) * apart;
}

/// Rows and bias of one candidate.
void coupleOne(const World& world, const std::vector<RodWork>& rods, double dt, double gapAtStart,
               const contact::Candidate& c, const ContactStage& stage, ContactWork& k, coulomb::Contact& out) {
    const Vec2 n = c.normal, t = rod::perp(c.normal);
    const auto ia = static_cast<std::size_t>(c.a.rod);
    const Rod& rodA = world.rods[ia];
    k.rodA = c.a.rod;
    k.rodB = c.b.rod;
    k.bodyB = -1;
    k.surface.setZero();
    surfaceRows(rodA, rods[ia], c.a, c.pointA, n, t, k.Ja);
    out.w.setZero();
    out.kind = coulomb::ContactKind::Unilateral;
    out.a = rods[ia].body; // -1 when asleep: an obstacle
    out.b = -1;
    if (out.a >= 0)
        reduce(rods[ia], k.Ja, 1.0, out.w, out.Ha);
    if (c.b.rod >= 0) {
        const auto ib = static_cast<std::size_t>(c.b.rod);
        surfaceRows(world.rods[ib], rods[ib], c.b, c.pointB, n, t, k.Jb);
        (out.a < 0 ? out.a : out.b) = rods[ib].body;
        if (rods[ib].body >= 0)
            reduce(rods[ib], k.Jb, -1.0, out.w, out.b < 0 ? out.Ha : out.Hb);
        out.mu = frictionOf(world, rodA.material, rodA.mu, world.rods[ib].material, world.rods[ib].mu);
    } else {
        const BodyOutline& piece = pieceOf(world, c);
        k.bodyB = bodyIndex(world, piece.body);
        SC_ASSERT(k.bodyB >= 0, "an outline belongs to a body");
        const Body& body = world.bodies[static_cast<std::size_t>(k.bodyB)];
        const BodyMotion& motion = stage.host.motion[static_cast<std::size_t>(k.bodyB)];
        k.armB = c.pointB - (body.state.centre + 0.5 * dt * motion.velocity);
        out.mu = frictionOf(world, rodA.material, rodA.mu, materialOf(world, piece.body), piece.friction);
        out.b = stage.host.place[static_cast<std::size_t>(k.bodyB)].block;
        if (out.b >= 0) {
            out.Hb.setZero(2, stage.problem.bodies[static_cast<std::size_t>(out.b)].vFree.size());
            addToRow(stage, k.bodyB, -n, -n.dot(rod::perp(k.armB)), out.Hb.row(0));
            addToRow(stage, k.bodyB, -t, -t.dot(rod::perp(k.armB)), out.Hb.row(1));
        }
        const Vec2 given = out.b < 0 ? surfaceVelocity(motion, k.armB)
                                     : surfaceVelocity({body.hostCoupling.drift, body.hostCoupling.driftSpin}, k.armB);
        k.surface = Vec2(n.dot(given), t.dot(given));
        if (!world.surfaceSpeeds.empty())
            k.surface.y() -= surfaceSpeedOf(world, piece);
        out.w -= k.surface;
    }
    if (out.b < 0)
        out.Hb.resize(2, 0); // only now: a contact that keeps its bodies keeps its storage
    // No step makes overlaps deeper than that: deeper ones were put there, and to close them at once would be
    // an explosion. To close others at once is a motion that no shorter step makes smaller, so a short one closes its
    // share of them: 20 um in 1.3 us were a blow of 115 N, and a frame of 1 ps brought in 600 J. Surfaces that give
    // overlap under load as they should, and their springs bound the force.
    const double scale = lengthOf(world, stage.length, c) / stage.h;
    const bool deep = gapAtStart < -scale * stage.overlaps.overlap;
    const bool put = isOverlap(world, c.a.rod, c.b.rod, c.outline, false) || withinJoined(world, c.a.rod, c.outline) ||
                     coincide(world, c, gapAtStart);
    k.damping = put && deep && out.a >= 0 ? contactDamping(world, rods, c) : 0.0;
    const bool gives = complianceOf(world, c).x() > 0.0;
    const double fastest = -scale * (put || deep ? stage.overlaps.recovery : stage.overlaps.fastest(dt));
    const double gap = gives ? gapAtStart / dt : std::max(gapAtStart / dt, fastest);
    k.closing = gives ? 0.0 : std::max(0.0, -gap);
    out.w.x() += gap < 0.0 ? stage.gaps.shareOfContact(c.id) * gap : gap;
    // A held point against what does not yield: no impulse can move it, and holds are not broken by contact.
    if (out.a >= 0 && out.b < 0 && out.Ha.row(0).norm() <= 1e-9)
        out.w.x() = std::max(out.w.x(), 0.0);
    out.id = c.id;
}

/// Tangential give of a contact whose friction is elastic before it slides, m/N: presliding over the most it can hold
/// at the force it was pressed with, so that the spring is as stiff as the contact is strong and ages with it. A
/// contact that was not pressed yet has none.
double preslidingOf(const World& world, const contact::Candidate& c, double dt, double mu, double load) {
    double sum = 0.0, count = 0.0;
    for (const contact::RodPoint* p : {&c.a, &c.b})
        if (p->rod >= 0) {
            const effects::FrictionModel& m =
                world.rods[static_cast<std::size_t>(p->rod)].effects.surface.model.friction;
            sum += m.compliant() ? m.presliding : 0.0;
            count += 1.0;
        }
    return sum > 0.0 && mu * load > 0.0 ? sum / count / (mu * factorAtRest(world, c, dt) * load) : 0.0;
}

/// A compliant contact has two springs of its own, memoryless along the normal, with the deflection left by the last
/// step along the tangent. They are two more unknowns of the body on its first side, with A = dt^2 / give: a spring
/// that is stiff or soft costs the solver the same, and the law stays exact.
void addGive(const World& world, double dt, const std::vector<ContactImpulse>& warm, ContactStage& stage) {
    const bool gives = std::any_of(world.rods.begin(), world.rods.end(),
                                   [](const Rod& r) { return r.effects.surface.model.compliant(); });
    if (!gives) {
        for (ContactWork& k : stage.work)
            k.give.setZero();
        return;
    }
    std::vector<std::vector<std::size_t>> ofBody(stage.problem.bodies.size());
    bool any = false;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        ContactWork& k = stage.work[i];
        k.give = complianceOf(world, stage.candidates[i]);
        const ContactImpulse* before = findImpulse(warm, stage.candidates[i].id);
        if (before != nullptr)
            k.give.y() += preslidingOf(world, stage.candidates[i], dt, stage.problem.contacts[i].mu, before->normal);
        k.tangentialDeflection = before != nullptr ? before->tangentialDeflection : 0.0;
        const int a = stage.problem.contacts[i].a;
        if ((k.give.x() > 0.0 || k.give.y() > 0.0) && a >= 0) {
            ofBody[static_cast<std::size_t>(a)].push_back(i);
            any = true;
        } else {
            k.give.setZero();
            k.tangentialDeflection = 0.0;
        }
    }
    if (!any)
        return;
    constexpr double kRigid = 1e-7; // of the give, along the direction that does not give
    std::vector<Eigen::Index> size;
    for (const coulomb::Body& b : stage.problem.bodies)
        size.push_back(b.vFree.size());
    for (std::size_t b = 0; b < ofBody.size(); ++b) {
        if (ofBody[b].empty())
            continue;
        coulomb::Body& body = stage.problem.bodies[b];
        const Eigen::Index n = size[b], more = 2 * static_cast<Eigen::Index>(ofBody[b].size());
        body.A.conservativeResizeLike(Eigen::MatrixXd::Zero(n + more, n + more));
        body.vFree.conservativeResizeLike(Eigen::VectorXd::Zero(n + more));
        for (std::size_t j = 0; j < ofBody[b].size(); ++j) {
            ContactWork& k = stage.work[ofBody[b][j]];
            const Eigen::Index at = n + 2 * static_cast<Eigen::Index>(j);
            SC_ASSERT(at + 2 <= body.A.rows(), "two unknowns a compliant contact");
            for (int axis = 0; axis < 2; ++axis)
                body.A(at + axis, at + axis) = dt * dt / std::max(k.give[axis], kRigid * k.give.maxCoeff());
        }
    }
    const auto widen = [&](std::int32_t body, Eigen::Matrix<double, 2, Eigen::Dynamic>& rows) {
        if (body < 0 || ofBody[static_cast<std::size_t>(body)].empty())
            return;
        const Eigen::Index n = rows.cols();
        rows.conservativeResizeLike(Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(
            2, n + 2 * static_cast<Eigen::Index>(ofBody[static_cast<std::size_t>(body)].size())));
    };
    for (coulomb::Contact& c : stage.problem.contacts) {
        widen(c.a, c.Ha);
        widen(c.b, c.Hb);
    }
    for (std::size_t b = 0; b < ofBody.size(); ++b)
        for (std::size_t j = 0; j < ofBody[b].size(); ++j) {
            coulomb::Contact& c = stage.problem.contacts[ofBody[b][j]];
            c.Ha.middleCols<2>(size[b] + 2 * static_cast<Eigen::Index>(j)).setIdentity();
            c.w.y() -= stage.work[ofBody[b][j]].tangentialDeflection / dt;
        }
}

void addRodBodies(const World& world, std::vector<RodWork>& rods, ContactStage& stage) {
    for (RodWork& w : rods)
        w.body = -1;
    int count = 0;
    const auto take = [&](int rod) {
        if (rod >= 0 && !world.rods[static_cast<std::size_t>(rod)].frozen())
            rods[static_cast<std::size_t>(rod)].body = 0;
    };
    for (const contact::Candidate& c : stage.candidates) {
        take(c.a.rod);
        take(c.b.rod);
    }
    for (std::size_t i = 0; i < stage.links.count; ++i) {
        take(stage.links.rows[i].rodA);
        take(stage.links.rows[i].rodB);
    }
    for (std::size_t i = 0; i < stage.pushes.count; ++i) {
        take(stage.pushes.rows[i].rodA);
        take(stage.pushes.rows[i].rodB);
    }
    for (RodWork& w : rods)
        if (w.body == 0)
            w.body = count++;
    while (stage.problem.bodies.size() > stage.host.firstBlock) { // blocks of the host keep their storage
        stage.host.spareBlocks.push_back(std::move(stage.problem.bodies.back()));
        stage.problem.bodies.pop_back();
    }
    SC_ASSERT(static_cast<std::size_t>(count) <= rods.size(), "one block a rod at most");
    stage.problem.bodies.resize(static_cast<std::size_t>(count));
    parallel::forEach(stage.loop, rods.size(), 32, [&](std::size_t i) {
        const RodWork& w = rods[i];
        if (w.body < 0)
            return;
        coulomb::Body& b = stage.problem.bodies[static_cast<std::size_t>(w.body)];
        if (w.C.rows() == 0)
            b.A = w.A;
        else
            b.A = w.held.reduced; // Z^T A Z
        b.vFree = w.vFree;
        SC_ASSERT(b.A.rows() == b.vFree.size(), "one free velocity for each unknown of a rod");
    });
}

} // namespace

Vec2 complianceOf(const World& world, const contact::Candidate& c) {
    Vec2 sum = Vec2::Zero();
    double count = 0.0;
    for (const contact::RodPoint* p : {&c.a, &c.b})
        if (p->rod >= 0) {
            const auto& m = world.rods[static_cast<std::size_t>(p->rod)].effects.surface.model.compliance;
            sum += Vec2(m.normal, m.tangential);
            count += 1.0;
        }
    return sum / count;
}

void reduce(const RodWork& w, const Eigen::Matrix<double, 2, Eigen::Dynamic>& full, double sign, Vec2& offset,
            Eigen::Matrix<double, 2, Eigen::Dynamic>& reduced) {
    if (w.C.rows() == 0) {
        reduced = sign * full;
        return;
    }
    SC_ASSERT(full.cols() == w.Z.rows() && w.vp.size() == full.cols(), "rows of this rod");
    reduced.noalias() = full * w.Z;
    reduced *= sign;
    offset += sign * (full * w.vp);
}

double shortStep(const Settings& settings) {
    return settings.fixedDt <= 0.0 ? kShortStep * settings.dtMax : 0.0;
}

OverlapClosing overlapClosing(const Settings& settings, double h) {
    return {2.0 * settings.rejectPenetration * h, shortStep(settings), settings.recovery * h};
}

BodyMotion predictedMotion(const Body& b) {
    return {b.state.velocity + b.hostCoupling.drift, b.state.spin + b.hostCoupling.driftSpin};
}

void predictMotion(const World& world, ContactStage& stage) {
    stage.host.motion.resize(world.bodies.size());
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        stage.host.motion[i] = predictedMotion(world.bodies[i]);
}

bool isOfFreeBody(const World& world, const ContactStage& stage, const contact::Candidate& c) {
    if (c.outline < 0)
        return false;
    const int index = bodyIndex(world, world.outlines[static_cast<std::size_t>(c.outline)].body);
    return index >= 0 && stage.host.motion[static_cast<std::size_t>(index)].isFree;
}

void placeOutlines(const World& world, const std::vector<BodyMotion>& motion, double ahead, double motionTime,
                   std::vector<std::uint32_t>& keys, std::vector<contact::Outline>& outlines) {
    keys.clear(); // those taken, sorted
    outlines.resize(world.outlines.size());
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        const BodyOutline& piece = world.outlines[i];
        const int index = bodyIndex(world, piece.body);
        SC_ASSERT(index >= 0, "an outline belongs to a body");
        const Body& body = world.bodies[static_cast<std::size_t>(index)];
        const BodyMotion& m = motion[static_cast<std::size_t>(index)];
        place(piece, body.state.centre + ahead * m.velocity, body.state.angle + ahead * m.spin, outlines[i]);
        outlines[i].body = static_cast<std::uint32_t>(index);
        std::uint32_t key = outlineKey(piece.body, piece.local.key);
        auto at = std::lower_bound(keys.begin(), keys.end(), key);
        while (at != keys.end() && *at == key) { // rare: two pieces fold onto one key; the later one moves on
            key = (key + 1) & kKeyMask;
            at = std::lower_bound(keys.begin(), keys.end(), key);
        }
        SC_ASSERT(key <= kKeyMask, "an id leaves 20 bits for an outline");
        keys.insert(at, key);
        outlines[i].key = key;
        double reach = 0.0;
        for (const Vec2& p : piece.local.points)
            reach = std::max(reach, p.norm() + piece.local.radius);
        outlines[i].motion = motionTime * (m.velocity.norm() + std::abs(m.spin) * reach);
    }
    SC_ASSERT_EXPENSIVE(invariants::strictlyRising(keys), "an outline has a key of its own");
}

void collide(const World& world, const std::vector<const rod::Kinematics*>& kin, const std::vector<double>& range,
             double ahead, double motionTime, double margin, ContactStage& stage,
             std::vector<contact::Candidate>& out) {
    SC_ASSERT(kin.size() == world.rods.size() && range.size() == world.rods.size(), "one configuration a rod");
    SC_ASSERT(!(ahead < 0.0) && !(margin < 0.0), "looks forward, outwards");
    placeOutlines(world, stage.host.motion, ahead, motionTime, stage.scratch.outlineKeys, stage.detection.outlines);
    stage.detection.curves.resize(world.rods.size());
    parallel::forEach(stage.loop, world.rods.size(), 32, [&](std::size_t i) {
        toCurve(world.rods[i], *kin[i], stage.detection.curves[i]);
        stage.detection.curves[i].motion = range[i];
    });
    stage.detection.detector.detect(stage.detection.curves, stage.detection.outlines, {margin}, out, stage.loop);
    collectExcluded(world, stage);
    collectPassing(world, stage.detection.passing);
    stage.detection.behind =
        std::erase_if(out, [&](const contact::Candidate& c) { return comesFromBehind(world, c); }) > 0;
    std::erase_if(out,
                  [&](const contact::Candidate& c) { return excluded(world, stage, c.a.rod, c.b.rod, c.outline); });
}

void frameInMiddle(const World& world, const std::vector<RodWork>& rods, const std::vector<contact::Candidate>& start,
                   bool addNew, double dt, ContactStage& stage) {
    placeOutlines(world, stage.host.motion, 0.5 * dt, 0.0, stage.scratch.outlineKeys, stage.detection.outlinesMiddle);
    stage.detection.curvesMiddle.resize(world.rods.size());
    parallel::forEach(stage.loop, world.rods.size(), 32,
                      [&](std::size_t i) { toCurve(world.rods[i], rods[i].kin, stage.detection.curvesMiddle[i]); });
    stage.candidates = start;
    stage.gapAtStart.clear();
    for (const contact::Candidate& c : start)
        stage.gapAtStart.push_back(c.gap);
    if (addNew) { // found at the end only: their gap at the start follows from the motion between
        sortedIds(start, stage.scratch.ids);
        Eigen::Matrix<double, 2, Eigen::Dynamic> rows;
        for (const contact::Candidate& c : stage.after) {
            if (c.gap > stage.addBelow || isOfFreeRod(rods, c) ||
                std::binary_search(stage.scratch.ids.begin(), stage.scratch.ids.end(), c.id))
                continue;
            const auto ia = static_cast<std::size_t>(c.a.rod);
            surfaceRows(world.rods[ia], rods[ia], c.a, c.pointA, c.normal, rod::perp(c.normal), rows);
            double gap = c.gap - rows.row(0).dot(rods[ia].q1 - world.rods[ia].q);
            if (c.b.rod >= 0) {
                const auto ib = static_cast<std::size_t>(c.b.rod);
                surfaceRows(world.rods[ib], rods[ib], c.b, c.pointB, c.normal, rod::perp(c.normal), rows);
                gap += rows.row(0).dot(rods[ib].q1 - world.rods[ib].q);
            } else {
                const auto ib = static_cast<std::size_t>(bodyIndex(world, pieceOf(world, c).body));
                const BodyMotion& m = stage.host.motion[ib];
                const Vec2 arm = c.pointB - (world.bodies[ib].state.centre + dt * m.velocity);
                gap += dt * c.normal.dot(surfaceVelocity(m, arm));
            }
            stage.candidates.push_back(c);
            stage.gapAtStart.push_back(gap);
        }
    }
    parallel::forEach(stage.loop, stage.candidates.size(), 64, [&](std::size_t i) {
        contact::updateCandidate(stage.candidates[i], stage.detection.curvesMiddle, stage.detection.outlinesMiddle);
    });
    SC_ASSERT(stage.candidates.size() == stage.gapAtStart.size() && stage.candidates.size() >= start.size(),
              "no candidate is lost");
    if (stage.leavesTips)
        leaveOutPassedTips(start, stage.detection.curvesMiddle, stage.candidates, stage.gapAtStart);
}

void couple(const World& world, std::vector<RodWork>& rods, double dt, const std::vector<ContactImpulse>& warm,
            bool again, ContactStage& stage) {
    SC_ASSERT(dt > 0.0, "a step takes time");
    SC_ASSERT(rods.size() == world.rods.size() && stage.host.motion.size() == world.bodies.size(),
              "sizes of the world");
    stage.problem.dt = dt;
    prepareLinks(world, rods, dt, again, stage);
    prepareOverlaps(world, rods, dt, stage);
    addRodBodies(world, rods, stage);
    addHostBlocks(world, dt, stage);
    listHostContacts(world, stage);
    const std::size_t n = stage.candidates.size(),
                      all = n + stage.links.count + stage.host.entries.size() + stage.pushes.count;
    stage.problem.contacts.resize(all);
    stage.work.resize(n);
    stage.problem.r0.setZero(static_cast<Eigen::Index>(2 * all));
    sortedIds(stage.candidates, stage.scratch.ids);
    parallel::forEach(stage.loop, n, 32, [&](std::size_t i) {
        const contact::Candidate& c = stage.candidates[i];
        coupleOne(world, rods, dt, stage.gapAtStart[i], c, stage, stage.work[i], stage.problem.contacts[i]);
        if (stage.gaps.shareOfContact(c.id) < 1.0) // the forces of a contradiction would hold each other for ever
            return;
        const ContactImpulse before = forceBefore(warm, stage.scratch.ids, c);
        stage.problem.r0[static_cast<Eigen::Index>(2 * i)] = before.normal * dt;
        stage.problem.r0[static_cast<Eigen::Index>(2 * i + 1)] = before.tangent * dt;
    });
    coupleLinks(world, rods, dt, stage);
    addHostContacts(world, dt, stage);
    coupleOverlaps(world, rods, stage);
    addGive(world, dt, world.impulses, stage); // last: both widen the rows of all contacts
    softenOverlaps(dt, stage);
}

void solveContacts(const World& world, std::vector<RodWork>& rods, const coulomb::SolverOptions& options,
                   ContactStage& stage) {
    const bool any = !stage.problem.contacts.empty();
    if (!any) {
        stage.r.resize(0);
        stage.report = {};
        stage.report.converged = true;
    } else {
        stage.report = stage.solver.solve(stage.problem, options, stage.r, stage.velocity, stage.loop);
    }
    SC_ASSERT(!any || stage.velocity.size() == stage.problem.bodies.size(), "one velocity a body of the problem");
    for (std::size_t i = 0; i < rods.size(); ++i) {
        RodWork& w = rods[i];
        SC_ASSERT(w.body < static_cast<int>(stage.problem.bodies.size()), "a rod's block is one of the problem");
        const Eigen::VectorXd& x = w.body >= 0 && any ? stage.velocity[static_cast<std::size_t>(w.body)] : w.vFree;
        const Eigen::Index own = w.vFree.size(); // behind it stand those of springs and pushes
        if (w.isFree)
            continue;
        if (w.frozen)
            w.v.setZero(world.rods[i].model.dofs());
        else if (w.C.rows() == 0 && x.size() == own)
            w.v = x;
        else if (w.C.rows() == 0)
            w.v = x.head(own);
        else if (x.size() == own)
            (w.v = w.vp).noalias() += w.Z * x;
        else
            (w.v = w.vp).noalias() += w.Z * x.head(own);
        SC_ASSERT(w.v.size() == world.rods[i].model.dofs(), "one velocity for each degree of freedom");
    }
    readHostBlocks(world, stage);
}

void gather(const ContactStage& stage, double dt, std::vector<ContactImpulse>& out) {
    SC_ASSERT(dt > 0.0, "a step takes time");
    SC_ASSERT(static_cast<std::size_t>(stage.r.size()) >= 2 * stage.candidates.size(), "two impulses a candidate");
    out.clear();
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const double rn = stage.r[static_cast<Eigen::Index>(2 * i)], rt = stage.r[static_cast<Eigen::Index>(2 * i + 1)];
        if (rn > 0.0)
            out.push_back({stage.candidates[i].id, rn / dt, rt / dt, stage.work[i].give.y() * (rt / dt)});
    }
    std::sort(out.begin(), out.end(), [](const ContactImpulse& a, const ContactImpulse& b) { return a.id < b.id; });
}

} // namespace supercircle::step
