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
    const auto at = [&](double value, scene::Scene& out) {
        driven.scene.back().value = value;
        if (auto scene = sceneOf(e, run, driven, failure_))
            out = *std::move(scene);
    };
    scene::Scene middle;
    at(from_, first_);
    at(to_, last_);
    at(0.5 * (from_ + to_), middle);
    for (std::size_t i = 0; failure_.empty() && i < middle.loads.size(); ++i) {
        const scene::PointLoad straight = mixed(first_.loads[i], last_.loads[i], 0.5);
        const scene::PointLoad &a = first_.loads[i], &b = last_.loads[i], &m = middle.loads[i];
        const double size = math::hypot(a.force.x, a.force.y) + math::hypot(b.force.x, b.force.y);
        if (math::hypot(m.force.x - straight.force.x, m.force.y - straight.force.y) > 1e-9 * size ||
            std::abs(m.moment - straight.moment) > 1e-9 * (std::abs(a.moment) + std::abs(b.moment)))
            failure_ = "the loads of the scene do not change in proportion to \"" + e.scene->driveParameter +
                       "\", which is driven";
    }
}

void LoadCourse::set(TestRig& rig, double value) const {
    scene::Scene now = first_;
    now.starts_at_rest = false;
    for (std::size_t i = 0; i < now.loads.size(); ++i)
        now.loads[i] = mixed(first_.loads[i], last_.loads[i], (value - from_) / (to_ - from_));
    rig.setLoads(now);
}

} // namespace supercircle::replay
