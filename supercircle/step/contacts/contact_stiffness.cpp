#include "supercircle/step/contacts/contact_stiffness.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/step/contact_memory.h"
#include "supercircle/step/parallel.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

namespace supercircle::step {

namespace {

/// Share of a rod's energy that forces may bring in within a step because their rows turn. Half of it linearises twice
/// as many steps of impacts again; with twice as much a step may bring in a fifth of all that moves.
constexpr double kMostTurning = 0.1;

constexpr double kFlatness = 0.0025; ///< h, see collectRolling

/// Part of an element's bending stiffness up to which tension may act on its own curvature explicitly: a quarter of
/// what neighbours leave where curvatures alternate (rod/elasticity.h), a third. Twice as much is where a massless
/// strip begins to flutter with a period of two steps; with half of it nothing becomes better.
constexpr double kExplicitShare = 0.25 / 3.0;

bool isBefore(const LoadedPoint& x, const LoadedPoint& y) {
    return std::tie(x.first, x.other, x.s) < std::tie(y.first, y.other, y.s);
}

LoadedPoint pointOf(const contact::Candidate& c) {
    if (c.b.rod < 0)
        return {c.a.rod, -2 - c.outline, c.a.s, 0.0};
    return c.a.rod <= c.b.rod ? LoadedPoint{c.a.rod, c.b.rod, c.a.s, 0.0} : LoadedPoint{c.b.rod, c.a.rod, c.b.s, 0.0};
}

/// Sampled points (nodes, corners) that carried force in the last step, sorted.
void loadedSamples(const std::vector<contact::Candidate>& candidates, const std::vector<ContactImpulse>& warm,
                   std::vector<LoadedPoint>& list) {
    list.clear();
    for (const contact::Candidate& c : candidates) {
        const contact::Feature kind = contact::featureOf(c.id);
        if (kind == contact::Feature::Interior || kind == contact::Feature::InteriorOutline)
            continue;
        if (const ContactImpulse* before = findImpulse(warm, c.id)) {
            list.push_back(pointOf(c));
            list.back().normal = before->normal;
        }
    }
    std::sort(list.begin(), list.end(), isBefore);
}

/// Force of the sampled points around a minimum, weighted by a hat as wide as an element. A nearly conformal contact
/// rests now on the minimum, now on the nodes beside it; a minimum that lost its rolling stiffness whenever the nodes
/// had the force gave it back and forth every step (4 % of friction lost and 6 % pushed out at 1e-4 s).
double forceAround(const std::vector<LoadedPoint>& samples, const contact::Candidate& c, double width) {
    LoadedPoint from = pointOf(c);
    const double s = from.s;
    from.s -= width;
    double sum = 0.0;
    for (auto it = std::lower_bound(samples.begin(), samples.end(), from, isBefore);
         it != samples.end() && it->first == from.first && it->other == from.other && it->s < s + width; ++it)
        sum += it->normal * (1.0 - std::abs(it->s - s) / width);
    return sum;
}

/// Relative curvature of the two surfaces at a candidate, 1/m; 0 where an element lies along an outline, because the
/// contact is at its middle then and does not roll.
double relativeCurvature(const World& world, const std::vector<RodWork>& rods, const contact::Candidate& c) {
    const auto side = [&](const contact::RodPoint& at, double outward) {
        const auto i = static_cast<std::size_t>(at.rod);
        const rod::RodModel& model = world.rods[i].model;
        const rod::MaterialPoint place = rod::locate(model, at.element, at.s);
        const double angle = rods[i].kin.angle(place);
        const double k = rods[i].kin.arcs()[static_cast<std::size_t>(at.element)].curvature *
                         c.normal.dot(Vec2(-math::sin(angle), math::cos(angle))) * outward;
        return k / (1.0 + 0.5 * model.definition().thickness * k); // of the surface, positive: bulges towards the other
    };
    double curvature = side(c.a, 1.0);
    if (c.b.rod >= 0)
        curvature += side(c.b, -1.0);
    else if (const contact::Outline& local = world.outlines[static_cast<std::size_t>(c.outline)].local;
             local.kind == contact::OutlineKind::Circle)
        curvature += 1.0 / local.radius;
    // An element that is flat to within h/400 is carried by its end nodes as well: its point cannot run away further.
    const rod::RodModel& model = world.rods[static_cast<std::size_t>(c.a.rod)].model;
    const double length = model.elementLength(c.a.element), thickness = model.definition().thickness;
    if (c.b.rod < 0 && curvature * length * length / 8.0 < 0.5 * contact::kConditionedShare * thickness)
        return 0.0;
    return std::max(curvature, 8.0 * kFlatness * thickness / (length * length));
}

void rollingOf(const World& world, const std::vector<RodWork>& rods, double dt, double normal, bool firstIteration,
               const contact::Candidate& c, RollingPair& pair) {
    SC_ASSERT(normal > 0.0, "a contact that carried force");
    const double curvature = relativeCurvature(world, rods, c);
    pair.any = curvature > 0.0;
    if (!pair.any)
        return;
    const double strength = normal * dt / curvature;
    SC_ASSERT(!(strength < 0.0), "rolling is a stiffness");
    const auto turn = [&](const contact::RodPoint& at, Rolling& rolling) {
        const auto i = static_cast<std::size_t>(at.rod);
        rolling.tau.resize(world.rods[i].model.dofs());
        Eigen::Map<Eigen::RowVectorXd> row(rolling.tau.data(), rolling.tau.size());
        rods[i].kin.angleRow(world.rods[i].model, rod::locate(world.rods[i].model, at.element, at.s), row);
        rolling.c = strength;
        rolling.lagAngle = 0.0;
    };
    const auto turned = [&](std::int32_t rod, const Rolling& r) { // of the other side since the linearisation point
        const auto i = static_cast<std::size_t>(rod);
        const Eigen::VectorXd& v = firstIteration ? world.rods[i].v : rods[i].v;
        return r.tau.dot(0.5 * dt * v - (rods[i].qk - world.rods[i].q));
    };
    turn(c.a, pair.a);
    if (c.b.rod < 0)
        return;
    turn(c.b, pair.b);
    // Twice the stiffness about the mean rotation, on each side: exact when the lagged rotations are right, no
    // force against a steady common rotation, and stable however stiff (once the stiffness about the other
    // side's lagged rotation would be a Jacobi splitting that flips sign every step without decay).
    const double mean = 0.5 * (turned(c.a.rod, pair.a) + turned(c.b.rod, pair.b));
    pair.a.c = pair.b.c = 2.0 * strength;
    pair.a.lagAngle = pair.b.lagAngle = mean;
}

} // namespace

void collectRolling(const World& world, std::vector<RodWork>& rods, double dt, const std::vector<ContactImpulse>& warm,
                    bool firstIteration, ContactStage& stage) {
    for (RodWork& w : rods)
        w.rollingCount = 0;
    if (warm.empty()) // nothing carried force
        return;
    sortedIds(stage.candidates, stage.scratch.ids);
    loadedSamples(stage.candidates, warm, stage.scratch.loadedPoints);
    const std::size_t count = stage.candidates.size();
    std::vector<RollingPair>& pairs = stage.scratch.rollingPairs;
    pairs.resize(std::max(pairs.size(), count));
    parallel::forEach(stage.loop, count, 64, [&](std::size_t i) {
        pairs[i].any = false;
        const contact::Candidate& c = stage.candidates[i];
        const contact::Feature kind = contact::featureOf(c.id);
        if (kind != contact::Feature::Interior && kind != contact::Feature::InteriorOutline)
            return;
        const double width = world.rods[static_cast<std::size_t>(c.a.rod)].model.elementLength(c.a.element);
        const double normal =
            forceBefore(warm, stage.scratch.ids, c).normal + forceAround(stage.scratch.loadedPoints, c, width);
        if (normal > 0.0)
            rollingOf(world, rods, dt, normal, firstIteration, c, pairs[i]);
    });
    const auto hand = [&](std::int32_t rod, Rolling& rolling) { // swapped, so that nobody loses its storage
        RodWork& w = rods[static_cast<std::size_t>(rod)];
        if (w.rolling.size() == w.rollingCount)
            w.rolling.emplace_back().tau.resize(rolling.tau.size());
        SC_ASSERT(rolling.tau.size() == world.rods[static_cast<std::size_t>(rod)].model.dofs(), "a row of this rod");
        std::swap(w.rolling[w.rollingCount++], rolling);
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (!pairs[i].any)
            continue;
        const contact::Candidate& c = stage.candidates[i];
        hand(c.a.rod, pairs[i].a);
        if (c.b.rod >= 0)
            hand(c.b.rod, pairs[i].b);
    }
}

void beginPulls(const rod::RodModel& model, RodWork& w) {
    w.loaded = false;
    for (int side = 0; side < 2; ++side)
        w.beyond[side].assign(model.side(side).size(), Vec2::Zero());
}

void pull(const rod::RodModel& model, const rod::MaterialPoint& at, const Vec2& force, RodWork& w) {
    for (int k = 0; k < at.segment; ++k)
        w.beyond[at.side][static_cast<std::size_t>(k)] += force;
    // Of its own segment it pulls at the part between the inner end and the point.
    const auto own = static_cast<std::size_t>(at.segment);
    SC_ASSERT_EXPENSIVE(own < model.side(at.side).size(), "a segment of the rod");
    w.beyond[at.side][own] += (at.local / model.side(at.side)[own].signedLength) * force;
    w.loaded = true;
}

void axialOfPulls(const rod::RodModel& model, RodWork& w) {
    for (int side = 0; side < 2; ++side) {
        w.tension[side].resize(model.side(side).size());
        for (std::size_t k = 0; k < w.tension[side].size(); ++k) {
            const double length = model.side(side)[k].signedLength;
            const double angle = w.kin.angle({side, static_cast<int>(k), 0.5 * length});
            const double force = w.beyond[side][k].dot(Vec2(math::cos(angle), math::sin(angle)));
            w.tension[side][k] = std::max(0.0, force * length); // both signs turn on the left side
        }
    }
    axialStiffness(model, w, w.axial);
}

void collectAxial(const World& world, std::vector<RodWork>& rods, const std::vector<ContactImpulse>& warm,
                  const ContactStage& stage) {
    for (std::size_t i = 0; i < rods.size(); ++i) {
        RodWork& w = rods[i];
        const rod::RodModel& model = world.rods[i].model;
        beginPulls(model, w);
        for (const Hold& h : world.rods[i].holds)
            pull(model, rod::locate(model, h.s), h.reaction, w);
        for (const AppliedForce& f : world.rods[i].forces)
            pull(model, rod::locate(model, f.s), f.force, w);
        for (const MouseJoint& g : world.rods[i].mouseJoints)
            pull(model, rod::locate(model, g.s), g.force, w);
    }
    SC_ASSERT(stage.links.ends.size() == world.links.size(), "the ends of all links are known");
    for (std::size_t k = 0; k < world.links.size(); ++k) {
        const Link& l = world.links[k];
        const auto at = [&](int rod, double s, const Vec2& force) {
            const auto i = static_cast<std::size_t>(rod);
            if (rod >= 0 && !force.isZero(0.0))
                pull(world.rods[i].model, rod::locate(world.rods[i].model, s), force, rods[i]);
        };
        at(stage.links.ends[k].rodA, l.sA, l.force);
        at(stage.links.ends[k].rodB, l.sB, -l.force);
    }
    for (const contact::Candidate& c : stage.candidates) {
        const ContactImpulse* before = findImpulse(warm, c.id);
        if (!before)
            continue;
        const Vec2 force = before->normal * c.normal + before->tangent * rod::perp(c.normal);
        const auto put = [&](const contact::RodPoint& at, const Vec2& f) {
            const auto i = static_cast<std::size_t>(at.rod);
            pull(world.rods[i].model, rod::locate(world.rods[i].model, at.element, at.s), f, rods[i]);
        };
        put(c.a, force);
        if (c.b.rod >= 0)
            put(c.b, -force);
    }
    forEachRod(stage.loop, rods.size(), [&](std::size_t i) {
        if (rods[i].loaded)
            axialOfPulls(world.rods[i].model, rods[i]);
    });
}

double turningWork(const Rod& rod, double dt, RodWork& w) {
    double work = 0.0;
    for (const Rolling& roll : std::span(w.rolling).first(w.rollingCount)) {
        const double rate = roll.tau.dot(w.v);
        work -= roll.c * rate * (0.5 * dt * rate - roll.tau.dot(w.qk - rod.q) - roll.lagAngle);
    }
    if (w.loaded) {
        w.difference = 0.5 * dt * w.v - (w.qk - rod.q);
        w.product.noalias() = w.axial * w.difference;
        work -= dt * w.v.dot(w.product);
    }
    return work;
}

bool turnsTooMuch(const Rod& rod, double dt, RodWork& w) {
    const double work = w.turningWork = turningWork(rod, dt, w);
    if (!(work > 0.0))
        return false;
    const double energy = rod::kineticEnergy(w.gauss, w.u1) + rod::bendingEnergy(rod.model, w.q1);
    const double closing = 0.5 * rod.model.mass() * w.closing.speed * w.closing.speed; // what any gap may bring in
    return work > kMostTurning * energy + closing;
}

void axialStiffness(const rod::RodModel& model, const RodWork& w, Eigen::MatrixXd& out) {
    // A segment's middle turns with the frame (theta), with all curvatures on its inner side (by their lengths) and
    // with half of its own: sums from the tip inwards give every entry once. What the sections beside the middle add,
    // tension times l^3 / 12 on the segment's own curvature, is left to the implicit bending stiffness as long as that
    // is the larger one. In a slack strip it is not: there the rest would be an explicit stiffness.
    const int theta = model.dofTheta();
    SC_ASSERT(w.tension[0].size() == model.side(0).size() && w.tension[1].size() == model.side(1).size(),
              "one tension a segment");
    const rod::RodDefinition& definition = model.definition();
    out.setZero(model.dofs(), model.dofs());
    const auto add = [&](int a, int b, double value) {
        out(a, b) += value;
        if (a != b)
            out(b, a) += value;
    };
    for (int side = 0; side < 2; ++side) {
        const std::vector<rod::Segment>& segments = model.side(side);
        double beyond = 0.0; // sum of tension * length outside of segment j
        for (std::size_t j = segments.size(); j-- > 0;) {
            const double own = w.tension[side][j], lj = segments[j].signedLength;
            const double half = lj * (beyond + 0.5 * own);
            add(segments[j].dof, segments[j].dof, lj * lj * (beyond + 0.25 * own));
            const double held = kExplicitShare * definition.bendingModulus * std::abs(lj);
            if (const double aside = own * lj * lj / 12.0; aside > held)
                add(segments[j].dof, segments[j].dof, aside - held);
            for (std::size_t i = 0; i < j; ++i)
                add(segments[i].dof, segments[j].dof, segments[i].signedLength * half);
            add(theta, segments[j].dof, half);
            beyond += own;
        }
        out(theta, theta) += beyond;
    }
}

} // namespace supercircle::step
