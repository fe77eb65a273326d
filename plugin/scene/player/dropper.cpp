#include "plugin/scene/player/dropper.h"

#include "supercircle/step/world.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::player {

namespace {

using rod::Vec2;

/// Arcs of a rod in steps of about 0.05 rad: extreme points to far better than a micrometre.
template <class Visit>
void walk(const step::Rod& rod, Visit&& visit) {
    for (const rod::Arc& a : rod.kin.arcs()) {
        const int pieces = 1 + static_cast<int>(std::abs(a.curvature) * a.length / 0.05);
        for (int i = 0; i <= pieces; ++i)
            visit(a.pointAt(a.length * i / pieces));
    }
}

/// Places of the shells of one batch: circles in rows, so that they do not overlap while they fall.
class Rows {
public:
    Rows(double bottom, double height) : bottom_(bottom), height_(height) {}
    /// Lowest free height (m, of the shell's lowest point) for a shell between x - reach and x + reach.
    double place(double x, double reach) {
        std::size_t row = 0;
        const auto clear = [&](const std::pair<double, double>& other) {
            return std::abs(x - other.first) > reach + other.second;
        };
        while (row < rows_.size() && !std::all_of(rows_[row].begin(), rows_[row].end(), clear))
            ++row;
        if (row == rows_.size())
            rows_.emplace_back();
        rows_[row].emplace_back(x, reach);
        return bottom_ + static_cast<double>(row) * height_;
    }

private:
    double bottom_, height_;
    std::vector<std::vector<std::pair<double, double>>> rows_;
};

} // namespace

Status dropBatch(Shells& shells, const scene::Drop& d, int count, Random& random, std::vector<ShellHandle>& made) {
    const step::World& w = shells.world();
    const double pad = 0.5 * d.shell.thickness;
    const double top = std::max(0.0, pileTop(w));
    Rows rows(top + d.clearance, 2.2 * (d.shell.radius + pad));
    for (int i = 0; i < count; ++i) {
        ShellDef def = d.shell;
        def.angle = random.uniform(-M_PI, M_PI);
        def.position = {0.0, 0.0};
        const auto probe = shells.create(def); // created at the origin for its extent, then in its place
        if (!probe)
            return Status::failure(probe.error());
        Vec2 lower = Vec2::Constant(1e300), upper = -lower;
        walk(w.rods.back(), [&](const Vec2& p) {
            lower = lower.cwiseMin(p);
            upper = upper.cwiseMax(p);
        });
        const double x = random.uniform(d.x_min, d.x_max);
        def.position = {x - 0.5 * (lower.x() + upper.x()),
                        rows.place(x, 0.55 * (upper.x() - lower.x()) + pad) - lower.y() + pad};
        if (Status gone = shells.destroy(*probe); !gone)
            return gone;
        const auto placed = shells.create(def);
        if (!placed)
            return Status::failure(placed.error());
        made.push_back(*placed);
    }
    return {};
}

double pileTop(const step::World& world) {
    double top = -std::numeric_limits<double>::infinity();
    for (const step::Rod& r : world.rods)
        walk(r, [&](const Vec2& p) { top = std::max(top, p.y() + 0.5 * r.model.definition().thickness); });
    return top;
}

double fastest(const step::World& world) {
    double speed = 0.0;
    for (const step::Rod& r : world.rods)
        speed = std::max(speed, r.speed);
    return speed;
}

} // namespace supercircle::player
