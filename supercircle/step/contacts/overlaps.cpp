#include "supercircle/step/contacts/overlaps.h"

#include "supercircle/step/contacts/pair_vetoes.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/step/sleep.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

/// Time in which a push reaches its speed, s. Halved, it brings in the same energy in half the time; doubled, a pair of
/// a few thicknesses is apart a tenth of a second later.
constexpr double kPushTime = 0.1;
/// Weights of the pair's shells that a push lifts. At one it does not lift a shell off the other; at four it bends soft
/// shells visibly.
constexpr double kPushWeights = 2.0;
/// What a deep contact of an overlap carries at rest, in a shell's own forces: its weight and B / L^2. Halved, the foot
/// of a pile of 25 shells that was built into the floor sinks; doubled, contacts that contradict each other bend a
/// shell twice as much.
constexpr double kContactForces = 50.0;
/// Deepest contact of a free pair, in half thicknesses: what a step leaves open anyway. Halved, a pair under load is
/// listed some frames longer; doubled, what is left closes within one step, at a higher speed than a push has.
constexpr double kFreeDepth = 0.02;

int outlineIndex(const World& world, const Overlap& o) {
    for (std::size_t i = 0; i < world.outlines.size(); ++i)
        if (world.outlines[i].body == o.body && world.outlines[i].local.key == o.outline)
            return static_cast<int>(i);
    return -1;
}

/// What an overlap names, as indices; -1: not there.
struct Ends {
    int rodA = -1, rodB = -1, outline = -1;
    [[nodiscard]] bool complete() const { return rodA >= 0 && (rodB >= 0 || outline >= 0); }
};

Ends endsOf(const World& world, const Overlap& o) {
    Ends e;
    e.rodA = rodIndex(world, o.rodA);
    e.rodB = o.rodB != 0 ? rodIndex(world, o.rodB) : -1;
    e.outline = o.rodB == 0 ? outlineIndex(world, o) : -1;
    return e;
}

const Rod& rodOf(const World& world, int i) {
    return world.rods[static_cast<std::size_t>(i)];
}

contact::RodCurve curveOf(const Rod& rod) {
    contact::RodCurve curve;
    toCurve(rod, rod.kin, curve);
    curve.resting = false;
    return curve;
}

contact::Outline outlineOf(const World& world, int index) {
    const BodyOutline& piece = world.outlines[static_cast<std::size_t>(index)];
    const BodyState& s = world.bodies[static_cast<std::size_t>(bodyIndex(world, piece.body))].state;
    return placed(piece, s.centre, s.angle);
}

/// Empty: they do not cross. Filters count: a pair that may not touch does not cross.
std::vector<contact::WayOut> waysOutOf(const World& world, const Ends& e) {
    const contact::RodCurve a = curveOf(rodOf(world, e.rodA));
    if (e.rodB == e.rodA)
        return contact::waysOut(a, a);
    return e.rodB >= 0 ? contact::waysOut(a, curveOf(rodOf(world, e.rodB)))
                       : contact::waysOut(a, outlineOf(world, e.outline));
}

bool concerns(const Ends& e, const contact::Candidate& c) {
    if (e.rodB < 0)
        return c.b.rod < 0 && c.a.rod == e.rodA && c.outline == e.outline;
    return (c.a.rod == e.rodA && c.b.rod == e.rodB) || (c.a.rod == e.rodB && c.b.rod == e.rodA);
}

/// Whether the contacts of the last step have moved a pair so far apart that it cannot cross by rounding.
bool isFree(const World& world, const Ends& e) {
    if (world.range.size() != world.rods.size())
        return false;
    double halves = 0.5 * rodOf(world, e.rodA).model.definition().thickness;
    if (e.rodB >= 0)
        halves += 0.5 * rodOf(world, e.rodB).model.definition().thickness;
    return std::none_of(world.candidates.begin(), world.candidates.end(),
                        [&](const contact::Candidate& c) { return concerns(e, c) && c.gap < -kFreeDepth * halves; });
}

/// Forgets what detection knows about a pair whose contacts begin or cease to act.
void forget(World& world, const Ends& e) {
    std::vector<std::uint64_t> ids;
    for (const contact::Candidate& c : world.candidates)
        if (concerns(e, c))
            ids.push_back(c.id);
    std::erase_if(world.impulses,
                  [&](const ContactImpulse& i) { return std::find(ids.begin(), ids.end(), i.id) != ids.end(); });
    world.range.clear();
}

/// Whether a joint or the user's filter says that the two do not collide.
bool keptApart(const World& world, const Overlap& o, const Ends& e) {
    const auto joins = [&](const Link& l) {
        if (l.collide || (l.rodA != o.rodA && l.rodA != o.rodB))
            return false;
        return o.rodB == 0 ? l.end == LinkEnd::Body && l.body == o.body
                           : l.end == LinkEnd::Rod && l.rodB == (l.rodA == o.rodA ? o.rodB : o.rodA);
    };
    return std::any_of(world.links.begin(), world.links.end(), joins) ||
           (e.outline >= 0 && vetoed(world, rodOf(world, e.rodA), world.outlines[static_cast<std::size_t>(e.outline)]));
}

/// Faces of an outline are ways of their own, and joined outlines have many: the last bit is that of all the others.
std::uint32_t bitOf(contact::WayKind kind) {
    return std::uint32_t{1} << std::min(static_cast<unsigned>(kind), 31U);
}

/// The shortest way that is not blocked. One that gets no shorter in some time is.
contact::WayOut& chosen(const World& world, std::vector<contact::WayOut>& ways, double dt, const Ends& e, Overlap& o) {
    // s. Halved, a push that friction has to be overcome for gives up too early; doubled, a pair of which somebody
    // holds one way shut stays a second longer.
    constexpr double kPatience = 0.5;
    const double least = rodOf(world, e.rodA).model.definition().thickness; // a tenth of what a free push makes of it
    std::sort(ways.begin(), ways.end(), [](const contact::WayOut& a, const contact::WayOut& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.kind < b.kind;
    });
    o.tried += dt;
    if (o.tried > kPatience) {
        const auto same = std::find_if(ways.begin(), ways.end(), [&](const auto& w) { return w.kind == o.way; });
        if (same != ways.end() && o.from - same->distance < least)
            o.blocked |= bitOf(o.way);
        o.tried = 0.0;
    }
    const auto isOpen = [&](const contact::WayOut& w) { return (o.blocked & bitOf(w.kind)) == 0; };
    auto way = std::find_if(ways.begin(), ways.end(), isOpen);
    if (way == ways.end()) {
        o.blocked = 0;
        way = ways.begin();
    }
    if (way->kind != o.way || o.tried == 0.0) {
        o.way = way->kind;
        o.from = way->distance;
        o.tried = 0.0;
    }
    return *way;
}

/// Of one overlap; false: it leaves the list.
bool review(World& world, bool frameBegins, Overlap& o) {
    const Ends e = endsOf(world, o);
    if (!e.complete() || rodOf(world, e.rodA).quarantined || (e.rodB >= 0 && rodOf(world, e.rodB).quarantined) ||
        keptApart(world, o, e))
        return false;
    const bool acted = o.contact;
    std::vector<contact::WayOut> ways = waysOutOf(world, e);
    const bool cross = !ways.empty();
    o.contact = true;
    o.pushes.clear();
    if (cross) {
        contact::WayOut& way = chosen(world, ways, frameBegins ? 0.0 : world.dt, e, o);
        o.contact = way.contactLeads;
        if (!o.contact)
            o.pushes = std::move(way.pushes);
    }
    if (frameBegins && o.free && !cross)
        return false;
    o.free = !frameBegins && acted && !cross && isFree(world, e);
    if (o.contact != acted)
        forget(world, e);
    return true;
}

/// Of a push that reaches its speed in kPushTime and carries `force` (N) at rest.
double dampingFor(double mass, double speed, double force) {
    return mass / kPushTime + force / speed;
}

void surfaceRows(const World& world, const RodWork& w, int rod, double s, const Vec2& direction,
                 Eigen::Matrix<double, 2, Eigen::Dynamic>& rows) {
    const rod::RodModel& model = rodOf(world, rod).model;
    rows.resize(2, model.dofs());
    w.kin.pointRows(model, rod::locate(model, s), Vec2::Zero(), direction, rod::perp(direction), rows);
}

void addPush(const World& world, const std::vector<RodWork>& rods, double dt, const Overlap& o, const Ends& e,
             const contact::Push& push, ContactStage& stage) {
    if (stage.pushes.rows.size() <= stage.pushes.count)
        stage.pushes.rows.emplace_back();
    PushRow& row = stage.pushes.rows[stage.pushes.count++];
    const auto ia = static_cast<std::size_t>(e.rodA);
    row.rodA = e.rodA;
    row.rodB = e.rodB;
    row.bodyB = -1;
    row.surface.setZero();
    row.direction = push.direction;
    row.speed = rods[ia].closing.speed;
    double mass = rodOf(world, e.rodA).model.mass();
    surfaceRows(world, rods[ia], e.rodA, push.sA, push.direction, row.Ja);
    if (e.rodB >= 0) {
        const auto ib = static_cast<std::size_t>(e.rodB);
        surfaceRows(world, rods[ib], e.rodB, push.sB, push.direction, row.Jb);
        row.speed = std::min(row.speed, rods[ib].closing.speed);
        mass += e.rodB != e.rodA ? rodOf(world, e.rodB).model.mass() : 0.0;
    } else {
        row.bodyB = bodyIndex(world, o.body);
        const Body& body = world.bodies[static_cast<std::size_t>(row.bodyB)];
        const BodyMotion& motion = stage.host.motion[static_cast<std::size_t>(row.bodyB)];
        const rod::RodModel& model = rodOf(world, e.rodA).model;
        row.armB = rods[ia].kin.point(rod::locate(model, push.sA)) - (body.state.centre + 0.5 * dt * motion.velocity);
        const BodyMotion given =
            body.dynamic ? BodyMotion{body.hostCoupling.drift, body.hostCoupling.driftSpin} : motion;
        const Vec2 velocity = given.velocity + given.spin * rod::perp(row.armB);
        row.surface = {push.direction.dot(velocity), rod::perp(push.direction).dot(velocity)};
    }
    const double share = 1.0 / static_cast<double>(o.pushes.size());
    row.damping = share * dampingFor(mass, row.speed, kPushWeights * mass * world.gravity.norm());
    SC_ASSERT(row.speed > 0.0 && row.damping > 0.0, "a push has a speed and a force");
}

} // namespace

Overlap overlapOf(const World& world, const contact::Crossing& c) {
    Overlap o;
    o.rodA = rodOf(world, c.rodA).key;
    if (c.rodB >= 0) {
        const std::uint32_t other = rodOf(world, c.rodB).key;
        o.rodB = std::max(o.rodA, other);
        o.rodA = std::min(o.rodA, other);
    } else {
        const BodyOutline& piece = world.outlines[static_cast<std::size_t>(c.outline)];
        o.body = piece.body;
        o.outline = piece.local.key;
    }
    return o;
}

bool overlapsNow(const World& world, const Overlap& pair) {
    const Ends e = endsOf(world, pair);
    return e.complete() && !waysOutOf(world, e).empty();
}

bool isOverlap(const World& world, int rodA, int rodB, int outline, bool apart) {
    if (world.overlaps.empty())
        return false;
    contact::Crossing c;
    c.rodA = rodA;
    c.rodB = rodB;
    c.outline = outline;
    const Overlap want = overlapOf(world, c);
    const auto it = std::lower_bound(world.overlaps.begin(), world.overlaps.end(), want,
                                     [](const Overlap& a, const Overlap& b) { return a.pair() < b.pair(); });
    return it != world.overlaps.end() && it->pair() == want.pair() && !(apart && it->contact);
}

bool withinJoined(const World& world, int rod, int outline) {
    const auto joined = [&](int i) {
        return i >= 0 && !world.outlines[static_cast<std::size_t>(i)].local.seams.empty();
    };
    return !world.overlaps.empty() && joined(outline) &&
           std::any_of(world.overlaps.begin(), world.overlaps.end(), [&](const Overlap& o) {
               return o.rodB == 0 && o.rodA == rodOf(world, rod).key && joined(outlineIndex(world, o));
           });
}

void addOverlaps(World& world, const std::vector<Overlap>& pairs) {
    for (const Overlap& o : pairs) {
        const auto at = std::lower_bound(world.overlaps.begin(), world.overlaps.end(), o,
                                         [](const Overlap& a, const Overlap& b) { return a.pair() < b.pair(); });
        if (at != world.overlaps.end() && at->pair() == o.pair())
            continue;
        Overlap& added = *world.overlaps.insert(at, o);
        review(world, false, added);
        forget(world, endsOf(world, added));
        for (const std::uint32_t key : {added.rodA, added.rodB})
            if (const int rod = rodIndex(world, key); rod >= 0)
                wake(world, static_cast<std::size_t>(rod));
    }
}

void reviewOverlaps(World& world, bool frameBegins) {
    std::erase_if(world.overlaps, [&](Overlap& o) { return !review(world, frameBegins, o); });
}

double contactDamping(const World& world, const std::vector<RodWork>& rods, const contact::Candidate& c) {
    double mass = 0.0, speed = std::numeric_limits<double>::infinity(), force = 0.0;
    for (const std::int32_t i : {c.a.rod, c.b.rod})
        if (i >= 0) {
            const rod::RodModel& m = rodOf(world, i).model;
            const double length = m.definition().length;
            mass += m.mass();
            speed = std::min(speed, rods[static_cast<std::size_t>(i)].closing.speed);
            force += m.mass() * world.gravity.norm() + m.definition().bendingModulus / (length * length);
        }
    return dampingFor(mass, speed, kContactForces * force);
}

void prepareOverlaps(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage) {
    stage.pushes.count = 0;
    for (const Overlap& o : world.overlaps) {
        const Ends e = endsOf(world, o);
        if (!e.complete() || (rodOf(world, e.rodA).frozen() && (e.rodB < 0 || rodOf(world, e.rodB).frozen())))
            continue;
        for (const contact::Push& push : o.pushes)
            addPush(world, rods, dt, o, e, push, stage);
    }
}

void coupleOverlaps(const World& world, const std::vector<RodWork>& rods, ContactStage& stage) {
    const std::size_t first = stage.problem.contacts.size() - stage.pushes.count;
    for (std::size_t i = 0; i < stage.pushes.count; ++i) {
        PushRow& row = stage.pushes.rows[i];
        coulomb::Contact& out = stage.problem.contacts[first + i];
        out.kind = coulomb::ContactKind::Unilateral;
        out.mu = 0.0;
        out.id = 0;
        out.w = -row.surface;
        out.w.x() -= row.speed;
        out.a = out.b = -1;
        out.Ha.resize(2, 0);
        out.Hb.resize(2, 0);
        Eigen::Matrix<double, 2, Eigen::Dynamic> reduced;
        const auto side = [&](int rod, const Eigen::Matrix<double, 2, Eigen::Dynamic>& J, double sign) {
            if (rod < 0 || rodOf(world, rod).frozen())
                return;
            const RodWork& w = rods[static_cast<std::size_t>(rod)];
            reduce(w, J, sign, out.w, reduced);
            if (out.a == w.body) { // a rod that crosses itself
                out.Ha += reduced;
                return;
            }
            const bool isFirst = out.a < 0;
            (isFirst ? out.a : out.b) = w.body;
            (isFirst ? out.Ha : out.Hb) = reduced;
        };
        side(row.rodA, row.Ja, 1.0);
        side(row.rodB, row.Jb, -1.0);
        row.bodyProblem = row.bodyB >= 0 ? stage.host.place[static_cast<std::size_t>(row.bodyB)].block : -1;
        if (row.bodyProblem >= 0) {
            const Vec2 n = row.direction, t = rod::perp(n);
            row.Hb.setZero(2, stage.problem.bodies[static_cast<std::size_t>(row.bodyProblem)].vFree.size());
            addToRow(stage, row.bodyB, -n, -n.dot(rod::perp(row.armB)), row.Hb.row(0));
            addToRow(stage, row.bodyB, -t, -t.dot(rod::perp(row.armB)), row.Hb.row(1));
            out.b = row.bodyProblem;
            out.Hb = row.Hb;
        }
    }
}

void softenOverlaps(double dt, ContactStage& stage) {
    if (stage.pushes.count == 0 &&
        std::none_of(stage.work.begin(), stage.work.end(), [](const ContactWork& k) { return k.damping > 0.0; }))
        return;
    const std::size_t first = stage.problem.contacts.size() - stage.pushes.count;
    struct Soft {
        std::size_t contact;
        Eigen::Index column;
    };
    std::vector<Soft> soft;
    std::vector<char> widened(stage.problem.bodies.size(), 0);
    const auto soften = [&](std::size_t i, double damping) {
        const coulomb::Contact& c = stage.problem.contacts[i];
        SC_ASSERT(c.a >= 0, "a push acts on a rod that moves");
        coulomb::Body& body = stage.problem.bodies[static_cast<std::size_t>(c.a)];
        const Eigen::Index n = body.vFree.size();
        body.A.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 1, n + 1));
        body.vFree.conservativeResizeLike(Eigen::VectorXd::Zero(n + 1));
        body.A(n, n) = dt * damping;
        widened[static_cast<std::size_t>(c.a)] = 1;
        soft.push_back({i, n});
    };
    for (std::size_t i = 0; i < stage.work.size(); ++i)
        if (stage.work[i].damping > 0.0)
            soften(i, stage.work[i].damping);
    for (std::size_t i = 0; i < stage.pushes.count; ++i)
        soften(first + i, stage.pushes.rows[i].damping);
    const auto widen = [&](std::int32_t body, Eigen::Matrix<double, 2, Eigen::Dynamic>& rows) {
        if (body < 0 || widened[static_cast<std::size_t>(body)] == 0)
            return;
        rows.conservativeResizeLike(Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(
            2, stage.problem.bodies[static_cast<std::size_t>(body)].vFree.size()));
    };
    for (coulomb::Contact& c : stage.problem.contacts) {
        widen(c.a, c.Ha);
        widen(c.b, c.Hb);
    }
    for (const Soft& s : soft)
        stage.problem.contacts[s.contact].Ha(0, s.column) = 1.0;
}

void recordOverlaps(World& world, std::vector<RodWork>& rods, const ContactStage& stage, double dt) {
    const std::size_t first = stage.problem.contacts.size() - stage.pushes.count;
    for (std::size_t i = 0; i < stage.pushes.count; ++i) {
        const PushRow& row = stage.pushes.rows[i];
        const double r = stage.r[static_cast<Eigen::Index>(2 * (first + i))];
        if (!(r > 0.0))
            continue;
        double u = -row.surface.x();
        const auto side = [&](int rod, const Eigen::Matrix<double, 2, Eigen::Dynamic>& J, double sign) {
            if (rod < 0)
                return;
            RodWork& w = rods[static_cast<std::size_t>(rod)];
            u += sign * J.row(0).dot(w.v);
            w.contactImpulse += sign * r * J.row(0).transpose();
        };
        side(row.rodA, row.Ja, 1.0);
        side(row.rodB, row.Jb, -1.0);
        EnergyBalance& l = world.energyBalance;
        if (row.bodyB >= 0) {
            Body& body = world.bodies[static_cast<std::size_t>(row.bodyB)];
            const Vec2 impulse = r * row.direction;
            body.force -= impulse / dt;
            if (row.bodyProblem >= 0) {
                const double ub =
                    row.Hb.row(0).dot(stage.velocity[static_cast<std::size_t>(row.bodyProblem)].head(row.Hb.cols()));
                const double turn = rod::cross(row.armB, impulse);
                u += ub;
                l.toBodies += r * ub;
                l.addDrift(r * row.surface.x());
                body.impulse -= impulse;
                body.angularImpulse -= turn;
                body.hostCoupling.hostImpulse += impulse;
                body.hostCoupling.hostTurnImpulse += turn;
            } else {
                l.work += r * row.surface.x();
            }
        }
        l.positionCorrection -= r * u;
        l.injected.contact += std::max(0.0, r * u);
    }
}

} // namespace supercircle::step
