#include "supercircle/step/contacts/adhesion.h"

#include "supercircle/contact/outline_shape.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr double kOfAttractions = 1e-3; ///< of the sum of all attractions

bool anyAttraction(const World& world) {
    return std::any_of(world.rods.begin(), world.rods.end(), [](const Rod& r) { return r.effects.adhesion.on(); });
}

/// What a place of a rod feels.
struct Near {
    int rodB = -1, bodyB = -1;
    double sB = 0.0; ///< m
    double gap = 0.0;
    Vec2 normal = Vec2::UnitX(); ///< from B to A
    Vec2 foot = Vec2::Zero();    ///< on B's outline or centre line
};

struct Bounds {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());
    [[nodiscard]] bool holds(const Vec2& p, double reach) const {
        return p.x() > low.x() - reach && p.y() > low.y() - reach && p.x() < high.x() + reach &&
               p.y() < high.y() + reach;
    }
};

/// Everything near at one configuration.
class Surroundings {
public:
    Surroundings(const World& world, std::vector<rod::Kinematics> kin, const std::vector<BodyMotion>& motion,
                 double ahead)
        : world_(world), kin_(std::move(kin)), rods_(world.rods.size()), bounds_(world.rods.size()) {
        std::vector<contact::Outline> outlines;
        std::vector<std::uint32_t> keys;
        placeOutlines(world, motion, ahead, 0.0, keys, outlines);
        outlines_.resize(outlines.size());
        for (std::size_t i = 0; i < outlines.size(); ++i) {
            contact::prepare(outlines[i], outlines_[i]);
            bodies_.push_back(bodyIndex(world, world.outlines[i].body));
            radius_.push_back(outlines[i].radius);
        }
        if (world.rods.size() < 2)
            return;
        contact::RodCurve curve;
        for (std::size_t i = 0; i < rods_.size(); ++i) {
            toCurve(world.rods[i], kin_[i], curve);
            contact::prepare(curve, rods_[i]);
            for (const contact::SubArc& p : rods_[i].subArcs)
                for (const Vec2& end : {p.p0, p.p1}) {
                    bounds_[i].low = bounds_[i].low.cwiseMin(end - Vec2::Constant(p.length));
                    bounds_[i].high = bounds_[i].high.cwiseMax(end + Vec2::Constant(p.length));
                }
        }
    }

    /// Calls `act(point, Near)` for every place of rod i that feels something, in their order.
    template <class Do>
    void forNear(std::size_t i, Do&& act) const {
        const std::vector<rod::MaterialPoint>& place = world_.rods[i].effects.adhesion.points;
        std::vector<Close> stack;
        for (std::size_t from = 0, to = 0; from < place.size(); from = to) {
            while (to < place.size() && place[to].side == place[from].side && place[to].segment == place[from].segment)
                ++to;
            forStretch(i, {from, to}, nullptr, stack, act);
        }
    }
    [[nodiscard]] const rod::Kinematics& kin(std::size_t i) const { return kin_[i]; }

private:
    /// A piece of another rod that may be near.
    struct Close {
        std::size_t rod = 0, piece = 0;
    };
    struct Range {
        std::size_t from = 0, to = 0;
    };

    /// Places on one arc lie within its length of the one in the middle: most stretches are done with after one look,
    /// the others are halved, with the pieces that are still near.
    /// @param close pieces near the stretch this one is a half of, as a range of `stack`; null: all of them
    template <class Do>
    void forStretch(std::size_t i, Range r, const Range* close, std::vector<Close>& stack, Do&& act) const {
        constexpr std::size_t kFew = 3;
        const Rod& rod = world_.rods[i];
        const effects::Adhesion& a = rod.effects.adhesion;
        const std::size_t half = (r.from + r.to) / 2;
        const double at = a.points[half].local;
        const double within = std::max(std::abs(a.points[r.from].local - at), std::abs(a.points[r.to - 1].local - at));
        const double reach = a.model.range + 0.5 * rod.model.definition().thickness + within;
        const Vec2 p = kin_[i].point(a.points[half]);
        const Range mine = collectClose(i, p, reach, close, stack);
        if (mine.to == mine.from && !nearOutline(p, reach))
            return;
        if (r.to - r.from > kFew) {
            forStretch(i, {r.from, half}, &mine, stack, act);
            forStretch(i, {half, r.to}, &mine, stack, act);
        } else
            for (std::size_t k = r.from; k < r.to; ++k)
                nearPlace(i, k, mine, stack, act);
        stack.resize(mine.from);
    }

    [[nodiscard]] bool nearOutline(const Vec2& p, double reach) const {
        return std::any_of(outlines_.begin(), outlines_.end(),
                           [&](const contact::OutlineShape& o) { return contact::distanceBound(o, p) <= reach; });
    }

    /// Appends the pieces within reach, by rod and along it. A piece lies within half of its length of its chord's
    /// middle, because no point of it is farther than that from both ends in the mean.
    Range collectClose(std::size_t i, const Vec2& p, double reach, const Range* of, std::vector<Close>& stack) const {
        Range mine{stack.size(), 0};
        const auto look = [&](std::size_t j, std::size_t k) {
            const contact::SubArc& piece = rods_[j].subArcs[k];
            const double most = reach + rods_[j].halfThickness + 0.5 * piece.length;
            if ((0.5 * (piece.p0 + piece.p1) - p).squaredNorm() <= most * most)
                stack.push_back({j, k});
        };
        if (of != nullptr)
            for (std::size_t c = of->from; c < of->to; ++c)
                look(stack[c].rod, stack[c].piece);
        else
            for (std::size_t j = 0; j < rods_.size(); ++j)
                if (j != i && bounds_[j].holds(p, reach + rods_[j].halfThickness))
                    for (std::size_t k = 0; k < rods_[j].subArcs.size(); ++k)
                        look(j, k);
        mine.to = stack.size();
        return mine;
    }

    template <class Do>
    void nearPlace(std::size_t i, std::size_t k, Range close, const std::vector<Close>& stack, Do&& act) const {
        const Rod& rod = world_.rods[i];
        const effects::Adhesion& a = rod.effects.adhesion;
        const double range = a.model.range, half = 0.5 * rod.model.definition().thickness;
        const Vec2 p = kin_[i].point(a.points[k]);
        for (std::size_t o = 0; o < outlines_.size(); ++o) {
            contact::OutlineHit hit;
            if (contact::distanceBound(outlines_[o], p) > range + half ||
                !contact::closestOnOutline(outlines_[o], p, half, Vec2::UnitY(), hit))
                continue;
            const double gap = hit.distance - radius_[o] - half;
            if (gap < range)
                act(k, Near{-1, bodies_[o], 0.0, gap, hit.normal, hit.point + radius_[o] * hit.normal});
        }
        for (std::size_t c = close.from; c < close.to;) {
            const std::size_t j = stack[c].rod;
            Near best;
            best.gap = range;
            for (; c < close.to && stack[c].rod == j; ++c)
                nearPiece(p, half, j, rods_[j].subArcs[stack[c].piece], best);
            if (best.rodB >= 0)
                act(k, best);
        }
    }

    /// Keeps the nearer of `best` and the foot of p on the piece.
    void nearPiece(const Vec2& p, double half, std::size_t j, const contact::SubArc& piece, Near& best) const {
        contact::Foot foot;
        const double reach = best.gap + half + rods_[j].halfThickness;
        if (!contact::footInSubArc(piece, p, reach, foot))
            return;
        const double gap = std::abs(foot.distance) - half - rods_[j].halfThickness;
        if (gap < best.gap)
            best = {
                static_cast<int>(j), -1, piece.s0 + foot.s, gap, foot.distance > 0.0 ? foot.normal : Vec2(-foot.normal),
                foot.point};
    }

    const World& world_;
    std::vector<rod::Kinematics> kin_;
    std::vector<contact::RodShape> rods_;
    std::vector<Bounds> bounds_;
    std::vector<contact::OutlineShape> outlines_;
    std::vector<int> bodies_;
    std::vector<double> radius_;
};

double shareOf(const Near& near) {
    return near.rodB >= 0 ? 0.5 : 1.0;
}

std::vector<rod::Kinematics> atStart(const World& world) {
    std::vector<rod::Kinematics> kin;
    for (const Rod& r : world.rods)
        kin.push_back(r.kin);
    return kin;
}

std::vector<rod::Kinematics> atEnd(const std::vector<RodWork>& rods, const World& world) {
    std::vector<rod::Kinematics> kin;
    for (std::size_t i = 0; i < rods.size(); ++i)
        kin.push_back(world.rods[i].frozen() ? world.rods[i].kin : rods[i].kin1);
    return kin;
}

/// Energy per rod, J.
std::vector<double> energies(const World& world, const Surroundings& around) {
    std::vector<double> all(world.rods.size(), 0.0);
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        const effects::Adhesion& a = world.rods[i].effects.adhesion;
        around.forNear(i, [&](std::size_t k, const Near& near) {
            all[i] += shareOf(near) * a.weight[k] * effects::adhesionAt(a.model, near.gap).energy;
        });
    }
    return all;
}

AdhesionWork linearised(const World& world, const std::vector<RodWork>& rods, std::size_t i, std::size_t k,
                        const Near& near, const ContactStage& stage, double dt) {
    const Rod& rod = world.rods[i];
    const effects::Adhesion& a = rod.effects.adhesion;
    const effects::AdhesionResponse law = effects::adhesionAt(a.model, near.gap);
    AdhesionWork p;
    p.rodA = static_cast<int>(i);
    p.rodB = near.rodB;
    p.bodyB = near.bodyB;
    p.point = k;
    p.share = shareOf(near);
    p.normal = near.normal;
    SC_ASSERT(p.share > 0.0 && p.share <= 1.0, "a share is a fraction");
    SC_ASSERT(invariants::isUnit(p.normal), "a normal has length 1");
    SC_ASSERT((near.rodB >= 0) != (near.bodyB >= 0), "what is near is a rod or a body");
    const double weight = p.share * a.weight[k];
    p.force = weight * law.force;
    p.stiffness = (near.rodB >= 0 ? 2.0 : 1.0) * weight * std::max(0.0, law.slope);
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, rod.model.dofs());
    SC_ASSERT(!(p.stiffness < 0.0), "the implicit part of adhesion is a stiffness");
    rods[i].kin.pointRows(rod.model, a.points[k], Vec2::Zero(), p.normal, rod::perp(p.normal), rows);
    p.rowA = rows.row(0);
    p.wayA = 2.0 * p.rowA.dot(rods[i].qk - rod.q);
    if (near.rodB >= 0) {
        const auto j = static_cast<std::size_t>(near.rodB);
        const Rod& other = world.rods[j];
        rows.resize(2, other.model.dofs());
        rods[j].kin.pointRows(other.model, rod::locate(other.model, near.sB), Vec2::Zero(), p.normal,
                              rod::perp(p.normal), rows);
        p.rowB = rows.row(0);
        p.wayB = 2.0 * p.rowB.dot(rods[j].qk - other.q);
    } else {
        const auto b = static_cast<std::size_t>(near.bodyB);
        const BodyMotion& m = stage.host.motion[b];
        p.armB = near.foot - (world.bodies[b].state.centre + dt * m.velocity);
        p.surface = p.normal.dot(m.velocity + m.spin * rod::perp(p.armB));
    }
    return p;
}

} // namespace

void collectAdhesion(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage) {
    stage.pulls.clear();
    if (!anyAttraction(world))
        return;
    std::vector<rod::Kinematics> kin(world.rods.size());
    for (std::size_t i = 0; i < kin.size(); ++i)
        kin[i].evaluate(world.rods[i].model, world.rods[i].q + 2.0 * (rods[i].qk - world.rods[i].q));
    const Surroundings around(world, std::move(kin), stage.host.motion, dt);
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        around.forNear(i, [&](std::size_t k, const Near& near) {
            stage.pulls.push_back(linearised(world, rods, i, k, near, stage, dt));
        });
}

void addAdhesion(const ContactStage& stage, int rod, double dt, RodWork& w) {
    const auto add = [&](const Eigen::RowVectorXd& row, double force, double stiffness, double way) {
        if (stiffness > 0.0)
            w.A.noalias() += (dt * dt * stiffness) * (row.transpose() * row);
        w.rhs += (dt * (force + stiffness * way)) * row.transpose();
    };
    for (const AdhesionWork& p : stage.pulls) {
        if (p.rodA == rod)
            add(p.rowA, -p.force, p.stiffness, p.wayA);
        if (p.rodB == rod)
            add(p.rowB, p.force, p.stiffness, p.wayB);
    }
}

double adhesionError(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage) {
    if (!anyAttraction(world))
        return 0.0;
    const Surroundings around(world, atEnd(rods, world), stage.host.motion, dt);
    double sum = 0.0, wrong = 0.0, floor = 0.0;
    std::vector<bool> still(stage.pulls.size(), false); // near
    std::size_t next = 0;
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        const effects::Adhesion& a = world.rods[i].effects.adhesion;
        floor += 1e-6 * a.model.force * world.rods[i].model.definition().length;
        around.forNear(i, [&](std::size_t k, const Near& near) {
            const double force = shareOf(near) * a.weight[k] * effects::adhesionAt(a.model, near.gap).force;
            double linear = 0.0;
            // Both lists run through rods and points in the same order.
            const auto before = [&](const AdhesionWork& p) {
                return p.rodA < static_cast<int>(i) || (p.rodA == static_cast<int>(i) && p.point < k);
            };
            while (next < stage.pulls.size() && before(stage.pulls[next]))
                ++next;
            for (std::size_t m = next; m < stage.pulls.size(); ++m) {
                const AdhesionWork& p = stage.pulls[m];
                if (p.rodA != static_cast<int>(i) || p.point != k)
                    break;
                if (p.rodB == near.rodB && p.bodyB == near.bodyB) {
                    linear = p.force + p.stiffness * (dt * p.rowA.dot(rods[i].v) - p.wayA);
                    still[m] = true;
                }
            }
            sum += force;
            wrong += std::abs(force - linear);
        });
    }
    for (std::size_t m = 0; m < still.size(); ++m)
        wrong += still[m] ? 0.0 : stage.pulls[m].force;
    // Linearised from both sides, a pair of rods is right only in the mean of its sides; the rest is second order.
    return wrong / (kOfAttractions * sum + floor);
}

AdhesionEnergies recordAdhesion(World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage) {
    AdhesionEnergies out;
    if (!anyAttraction(world))
        return out;
    const std::vector<double> before = energies(world, Surroundings(world, atStart(world), stage.host.motion, 0.0));
    const std::vector<double> after = energies(world, Surroundings(world, atEnd(rods, world), stage.host.motion, dt));
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        effects::EffectEnergy& book = world.rods[i].effects.energies[static_cast<std::size_t>(effects::Key::Adhesion)];
        out.taken += after[i] - before[i];
        world.energyBalance.effects += before[i] - book.stored; // what came near otherwise than by a step was put there
        world.energyBalance.added += before[i] - book.stored;
        book.stored = after[i];
    }
    double given = 0.0;
    for (const AdhesionWork& p : stage.pulls) {
        const double wayA = dt * p.rowA.dot(rods[static_cast<std::size_t>(p.rodA)].v);
        given += (p.force + p.stiffness * (wayA - p.wayA)) * wayA;
        if (p.rodB >= 0) {
            const double wayB = dt * p.rowB.dot(rods[static_cast<std::size_t>(p.rodB)].v);
            given -= (p.force - p.stiffness * (wayB - p.wayB)) * wayB;
            continue;
        }
        Body& body = world.bodies[static_cast<std::size_t>(p.bodyB)];
        const double force = p.force + p.stiffness * (wayA - p.wayA), way = dt * p.surface;
        given -= force * way;
        body.force += force * p.normal;
        (body.dynamic ? out.toBodies : out.work) += (body.dynamic ? 1.0 : -1.0) * force * way;
        if (body.dynamic) {
            body.impulse += dt * force * p.normal;
            body.angularImpulse += rod::cross(p.armB, dt * force * p.normal);
        }
    }
    out.secondOrder = given - out.taken;
    return out;
}

} // namespace supercircle::step
