#include "plugin/lab/validation/tip_slip.h"

#include "supercircle/rod/arc.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::validation {

namespace {

struct Tip {
    rod::Vec2 at;
    double angle = 0.0;
};

Tip tip(const record::ShellPose& pose, const std::vector<double>& lengths, bool last) {
    Tip t{{pose.start[0], pose.start[1]}, pose.angle};
    for (std::size_t i = 0; last && i < pose.curvature.size(); ++i) {
        const rod::Arc arc{t.at, t.angle, static_cast<double>(pose.curvature[i]), lengths[i]};
        t = {arc.pointAt(lengths[i]), arc.angleAt(lengths[i])};
    }
    return t;
}

} // namespace

double tipSlip(const record::Recording& recording, Support support) {
    const record::ShellInfo& shell = recording.shells.front();
    double most = 0.0;
    for (const bool last : {false, true}) {
        const Tip before = tip(recording.frames.front().shells.front(), shell.element_length, last);
        const Tip after = tip(recording.frames.back().shells.front(), shell.element_length, last);
        // along the support, counter-clockwise on the cylinder, to the left on the floor
        const double along = support == Support::Floor ? before.at.x() - after.at.x()
                                                       : after.at.norm() * math::atan2(rod::cross(before.at, after.at),
                                                                                       before.at.dot(after.at));
        most = std::max(most, std::abs(along - 0.5 * shell.thickness * (after.angle - before.angle)));
    }
    return most;
}

double bisect(double low, double high, int steps, const std::function<bool(double)>& sticks) {
    for (int i = 0; i < steps; ++i) {
        const double middle = 0.5 * (low + high);
        (sticks(middle) ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace supercircle::validation
