#include "plugin/identification/replay/load_course.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

double mixed(double a, double b, double share) {
    return a + share * (b - a);
}

scene::PointLoad mixed(const scene::PointLoad& a, const scene::PointLoad& b, double share) {
    scene::PointLoad out = a;
    out.force = {mixed(a.force.x, b.force.x, share), mixed(a.force.y, b.force.y, share)};
    out.moment = mixed(a.moment, b.moment, share);
    return out;
}

} // namespace

LoadCourse::LoadCourse(const experiment::Experiment& e, std::size_t run, const Parameters& p) {
    const std::vector<double>& drive = e.runs[run].driveDisplacement;
    const auto [least, most] = std::minmax_element(drive.begin(), drive.end());
    from_ = *least;
    to_ = *most > *least ? *most : *least + 1.0;
    Parameters driven = p;
    driven.scene.push_back({e.scene->driveParameter, -1, 0.0}); // after a stated value, which it replaces
    const auto at = [&](double value) {
        driven.scene.back().value = value;
        auto scene = sceneOf(e, run, driven, failure_);
        return scene ? std::move(scene->loads) : std::vector<scene::PointLoad>{};
    };
    first_ = at(from_);
    last_ = at(to_);
    const std::vector<scene::PointLoad> middle = at(0.5 * (from_ + to_));
    for (std::size_t i = 0; failure_.empty() && i < middle.size(); ++i) {
        const scene::PointLoad straight = mixed(first_[i], last_[i], 0.5);
        const scene::PointLoad &a = first_[i], &b = last_[i], &m = middle[i];
        const double size = math::hypot(a.force.x, a.force.y) + math::hypot(b.force.x, b.force.y);
        if (math::hypot(m.force.x - straight.force.x, m.force.y - straight.force.y) > 1e-9 * size ||
            std::abs(m.moment - straight.moment) > 1e-9 * (std::abs(a.moment) + std::abs(b.moment)))
            failure_ = "the loads of the scene do not change in proportion to \"" + e.scene->driveParameter +
                       "\", which is driven";
    }
}

Resolution LoadCourse::forRest(Resolution resolution) {
    // On a cantilever of 0.27 m a factor of 25 costs 1.5 times the steps and 100 saves a third. Up to 1000 readings
    // differ by less than 1e-6 of the largest.
    constexpr double kOnTheWay = 50.0;
    resolution.positionTolerance *= kOnTheWay;
    return resolution;
}

void LoadCourse::set(TestRig& rig, double value) const {
    std::vector<scene::PointLoad> now;
    for (std::size_t i = 0; i < first_.size(); ++i)
        now.push_back(mixed(first_[i], last_[i], (value - from_) / (to_ - from_)));
    rig.setLoads(now, false);
}

} // namespace supercircle::replay
