#include "plugin/api/queries_geometry.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>

namespace supercircle {

using rod::Vec2;

namespace {

/// Largest coordinate that is accepted: squares of distances must not overflow.
constexpr double kFarthest = 1e100;

bool usable(const Point& p) {
    return std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest; // false for NaN
}

template <class T>
Result<T> noShell() {
    return Result<T>::failure(kNoSuchShell);
}

Vec2 outward(const CentrePoint& c, const Vec2& p) {
    const Vec2 d = p - c.point;
    const double size = d.norm();
    return size > 0.0 ? Vec2(d / size) : c.left;
}

ClosestPoint closestPointOf(const ThickCurve& curve, ShellHandle shell, const Vec2& p) {
    const CentrePoint c = closestOnCentreLine(curve, p);
    ClosestPoint out;
    const Vec2 normal = outward(c, p);
    out.shell = shell;
    out.normal = point(normal);
    out.point = point(c.point + curve.half * normal);
    out.distance = c.distance - curve.half;
    out.arc_fraction = c.s / curve.length;
    return out;
}

RayHit hitAt(const ThickCurve& curve, ShellHandle shell, const Vec2& from, const Vec2& to, double fraction) {
    const Vec2 p = from + fraction * (to - from);
    const CentrePoint c = closestOnCentreLine(curve, p);
    RayHit hit;
    hit.shell = shell;
    hit.point = point(p);
    hit.normal = point(outward(c, p));
    hit.fraction = fraction;
    hit.arc_fraction = c.s / curve.length;
    return hit;
}

bool separated(const Vec2& lowerA, const Vec2& upperA, const Vec2& lowerB, const Vec2& upperB) {
    return (lowerA.array() > upperB.array()).any() || (lowerB.array() > upperA.array()).any();
}

/// Fractions at which the ray enters the shell, in order.
void entries(const ThickCurve& curve, const Vec2& from, const Vec2& to, bool firstOnly, std::vector<double>& cuts,
             std::vector<double>& out) {
    out.clear();
    if (separated(curve.lower, curve.upper, from.cwiseMin(to), from.cwiseMax(to)))
        return;
    bool inside = closestOnCentreLine(curve, from).distance <= curve.half;
    if (inside)
        out.push_back(0.0);
    if (inside && firstOnly)
        return;
    intersections(curve, from, to, cuts);
    if (firstOnly) { // every intersection lies in the shell, so the first one is the entry
        if (!cuts.empty())
            out.push_back(cuts.front());
        return;
    }
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const double next = i + 1 < cuts.size() ? cuts[i + 1] : 1.0;
        if (next <= cuts[i])
            continue;
        const Vec2 middle = from + 0.5 * (cuts[i] + next) * (to - from);
        const bool now = closestOnCentreLine(curve, middle).distance <= curve.half;
        if (now && !inside)
            out.push_back(cuts[i]);
        inside = now;
    }
}

Status checkRay(const Point& from, const Point& to) {
    if (!usable(from) || !usable(to))
        return refused("the ends of the ray must be finite");
    if (from.x == to.x && from.y == to.y)
        return refused("the ends of the ray must differ");
    return {};
}

/// Calls visit(index, curve) for the rods selected by the mask that may overlap a box: no point of a rod is farther
/// from its middle than half its length.
template <class Visit>
void visitShells(const step::World& world, QueryMask mask, const Vec2& lower, const Vec2& upper, Visit&& visit) {
    ThickCurve curve;
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        const step::Rod& rod = world.rods[i];
        if ((rod.category & mask) == 0)
            continue;
        const rod::RodDefinition& d = rod.model.definition();
        const Vec2 middle = rod.kin.middle();
        const double rounding = 1e-9 * d.length + 1e-12 * middle.lpNorm<1>(); // of sums of positions
        const Vec2 reach = Vec2::Constant(0.5 * (d.length + d.thickness) + rounding);
        if (separated(middle - reach, middle + reach, lower, upper))
            continue;
        thicken(rod, curve);
        visit(i, curve);
    }
}

/// Indices of the rods for which test(curve) holds.
template <class Test>
std::vector<std::size_t> rodsWhere(const step::World& world, QueryMask mask, const Vec2& lower, const Vec2& upper,
                                   Test&& test) {
    std::vector<std::size_t> out;
    visitShells(world, mask, lower, upper, [&](std::size_t i, const ThickCurve& curve) {
        if (test(curve))
            out.push_back(i);
    });
    return out;
}

std::vector<ShellHandle> handlesOf(const Shells& shells, const std::vector<std::size_t>& rods) {
    std::vector<ShellHandle> out;
    if (rods.empty())
        return out;
    const std::vector<ShellHandle> all = shells.shells();
    for (const std::size_t i : rods)
        out.push_back(all[i]);
    return out;
}

} // namespace

std::vector<ShellHandle> Shells::shells() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> slotOfKey;
    for (std::uint32_t i = 0; i < impl_->slots.size(); ++i)
        if (impl_->slots[i].key != 0)
            slotOfKey.emplace_back(impl_->slots[i].key, i);
    std::sort(slotOfKey.begin(), slotOfKey.end());
    std::vector<ShellHandle> out;
    out.reserve(impl_->world.rods.size());
    for (const step::Rod& r : impl_->world.rods) {
        const auto it =
            std::lower_bound(slotOfKey.begin(), slotOfKey.end(), std::pair<std::uint32_t, std::uint32_t>{r.key, 0});
        const bool known = it != slotOfKey.end() && it->first == r.key;
        out.push_back(known ? ShellHandle{it->second, impl_->slots[it->second].generation, impl_->worldId}
                            : ShellHandle{}); // added through world()
    }
    return out;
}

ShellHandle Shells::find(const std::string& name) const {
    for (const ShellHandle& h : shells())
        if (!h.null() && impl_->slots[h.index].name == name)
            return h;
    return {};
}

Result<std::string> Shells::name(ShellHandle shell) const {
    return impl_->find(shell) < 0 ? noShell<std::string>() : Result<std::string>(impl_->slots[shell.index].name);
}

Result<std::uint64_t> Shells::user_data(ShellHandle shell) const {
    return impl_->find(shell) < 0 ? noShell<std::uint64_t>()
                                  : Result<std::uint64_t>(impl_->slots[shell.index].userData);
}

Status Shells::set_name(ShellHandle shell, const std::string& name) {
    return impl_->change([&] {
        if (impl_->find(shell) < 0)
            return refused(kNoSuchShell);
        impl_->slots[shell.index].name = name;
        impl_->recorder.record(Call::SetName, shell, name);
        return done();
    });
}

Status Shells::set_user_data(ShellHandle shell, std::uint64_t data) {
    return impl_->change([&] {
        if (impl_->find(shell) < 0)
            return refused(kNoSuchShell);
        impl_->slots[shell.index].userData = data;
        impl_->recorder.record(Call::SetUserData, shell, data);
        return done();
    });
}

Result<RayHit> Shells::ray_cast(Point from, Point to, QueryMask mask) const {
    if (impl_->gone)
        return Result<RayHit>::failure(kMovedFrom);
    if (const Status checked = checkRay(from, to); !checked)
        return Result<RayHit>::failure(checked.error());
    const Vec2 a = vec(from), b = vec(to);
    std::vector<double> cuts, in;
    std::optional<RayHit> best;
    std::size_t who = 0;
    visitShells(impl_->world, mask, a.cwiseMin(b), a.cwiseMax(b), [&](std::size_t i, const ThickCurve& curve) {
        entries(curve, a, b, true, cuts, in);
        if (in.empty() || (best && in.front() >= best->fraction))
            return;
        best = hitAt(curve, {}, a, b, in.front());
        who = i;
    });
    if (!best)
        return Result<RayHit>::failure("the ray hits no shell");
    best->shell = impl_->handleOf(impl_->world.rods[who].key);
    return Result<RayHit>(*best);
}

Result<std::vector<RayHit>> Shells::ray_cast_all(Point from, Point to, QueryMask mask) const {
    using Hits = std::vector<RayHit>;
    if (impl_->gone)
        return Result<Hits>::failure(kMovedFrom);
    if (const Status checked = checkRay(from, to); !checked)
        return Result<Hits>::failure(checked.error());
    const Vec2 a = vec(from), b = vec(to);
    std::vector<double> cuts, in;
    Hits hits;
    visitShells(impl_->world, mask, a.cwiseMin(b), a.cwiseMax(b), [&](std::size_t i, const ThickCurve& curve) {
        entries(curve, a, b, false, cuts, in);
        const ShellHandle h = in.empty() ? ShellHandle{} : impl_->handleOf(impl_->world.rods[i].key);
        for (const double t : in)
            hits.push_back(hitAt(curve, h, a, b, t));
    });
    std::stable_sort(hits.begin(), hits.end(),
                     [](const RayHit& x, const RayHit& y) { return x.fraction < y.fraction; });
    return hits;
}

Result<std::vector<ShellHandle>> Shells::overlap_point(Point position, QueryMask mask) const {
    return overlap_circle(position, 0.0, mask);
}

Result<std::vector<ShellHandle>> Shells::overlap_box(const Box& box, QueryMask mask) const {
    using Handles = std::vector<ShellHandle>;
    if (impl_->gone)
        return Result<Handles>::failure(kMovedFrom);
    if (!usable(box.lower) || !usable(box.upper) || box.lower.x > box.upper.x || box.lower.y > box.upper.y)
        return Result<Handles>::failure(
            "the box must be finite, with its lower corner below and left of its upper one");
    const Vec2 lower = vec(box.lower), upper = vec(box.upper);
    return handlesOf(*this, rodsWhere(impl_->world, mask, lower, upper,
                                      [&](const ThickCurve& curve) { return overlapsBox(curve, lower, upper); }));
}

Result<std::vector<ShellHandle>> Shells::overlap_circle(Point centre, double radius, QueryMask mask) const {
    using Handles = std::vector<ShellHandle>;
    if (impl_->gone)
        return Result<Handles>::failure(kMovedFrom);
    if (!usable(centre) || !(radius >= 0.0) || !(radius < kFarthest))
        return Result<Handles>::failure("centre and radius must be finite, the radius not negative");
    const Vec2 p = vec(centre), lower = p - Vec2::Constant(radius), upper = p + Vec2::Constant(radius);
    return handlesOf(*this, rodsWhere(impl_->world, mask, lower, upper, [&](const ThickCurve& curve) {
        return !separated(curve.lower, curve.upper, lower, upper) &&
               closestOnCentreLine(curve, p).distance <= curve.half + radius;
    }));
}

Result<ClosestPoint> Shells::closest_point(ShellHandle shell, Point to) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return noShell<ClosestPoint>();
    if (!usable(to))
        return Result<ClosestPoint>::failure("the point must be finite");
    ThickCurve curve;
    thicken(impl_->rod(i), curve);
    return closestPointOf(curve, shell, vec(to));
}

Result<ClosestPoint> Shells::closest_point(Point to, double max_distance, QueryMask mask) const {
    if (!usable(to) || !(max_distance >= 0.0))
        return Result<ClosestPoint>::failure("the point must be finite and the distance not negative");
    const Vec2 p = vec(to);
    std::optional<ClosestPoint> best;
    std::size_t who = 0;
    const Vec2 far = Vec2::Constant(max_distance);
    visitShells(impl_->world, mask, p - far, p + far, [&](std::size_t i, const ThickCurve& curve) {
        const Vec2 outside = (curve.lower - p).cwiseMax(p - curve.upper).cwiseMax(Vec2::Zero());
        const double limit = best ? std::max(best->distance, 0.0) : max_distance;
        if (outside.norm() > limit)
            return;
        const ClosestPoint n = closestPointOf(curve, {}, p);
        if (n.distance > max_distance || (best && n.distance >= best->distance))
            return;
        best = n;
        who = i;
    });
    if (!best)
        return Result<ClosestPoint>::failure("no shell is within max_distance");
    best->shell = impl_->handleOf(impl_->world.rods[who].key);
    return Result<ClosestPoint>(*best);
}

Result<ShellSection> Shells::section(ShellHandle shell, double arc_fraction) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return noShell<ShellSection>();
    if (!(arc_fraction >= 0.0 && arc_fraction <= 1.0))
        return Result<ShellSection>::failure(kBadFraction);
    const step::Rod& rod = impl_->rod(i);
    const rod::RodDefinition& d = rod.model.definition();
    const double s = arc_fraction * d.length;
    const int element = rod.model.elementAt(s);
    const rod::MaterialPoint at = rod::locate(rod.model, element, s);
    ShellSection out;
    out.position = point(rod.kin.point(at));
    out.angle = rod.kin.angle(at);
    const math::SinCos turned = math::sinCos(out.angle);
    out.tangent = {turned.cosine, turned.sine};
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, rod.model.dofs());
    rod.kin.pointRows(rod.model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), rows);
    const Vec2 velocity = rows * rod.v;
    out.velocity = point(velocity);
    Eigen::RowVectorXd turn(rod.model.dofs());
    rod.kin.angleRow(rod.model, at, turn);
    out.spin = turn.dot(rod.v);
    out.curvature = rod.q[rod.model.dofOfElement(element)];
    out.natural_curvature = d.naturalCurvature[static_cast<std::size_t>(element)];
    const double curvatureChange = out.curvature - out.natural_curvature;
    out.bending_moment = d.bendingModulus * curvatureChange;
    out.surface_strain = surfaceStrain(rod, element);
    out.energy_density = 0.5 * d.bendingModulus * curvatureChange * curvatureChange;
    return out;
}

Result<ShellState> Shells::state(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return noShell<ShellState>();
    const step::Rod& rod = impl_->rod(i);
    const rod::RodDefinition& d = rod.model.definition();
    ShellState out;
    out.length = d.length;
    out.mass = rod.model.mass();
    const Vec2 centre = rod::massCentre(rod.kin, rod.gauss);
    out.centre = point(centre);
    Vec2 momentum = Vec2::Zero();
    for (std::size_t g = 0; g < rod.u.size(); ++g) {
        const Vec2 p = rod.gauss.mass[g] * rod.u[g];
        momentum += p;
        out.angular_momentum += rod::cross(rod.kin.middle() + rod.gauss.arm[g] - centre, p);
    }
    out.momentum = point(momentum);
    out.kinetic_energy = rod::kineticEnergy(rod.gauss, rod.u);
    out.stored_energy = rod::bendingEnergy(rod.model, rod.q);
    for (int e = 0; e < rod.model.elements(); ++e)
        out.max_surface_strain = std::max(out.max_surface_strain, surfaceStrain(rod, e));
    ThickCurve curve;
    thicken(rod, curve);
    Vec2 lower, upper;
    boundingBox(curve, lower, upper);
    out.box = {point(lower), point(upper)};
    out.quarantined = rod.quarantined;
    return out;
}

} // namespace supercircle
