#include "supercircle/effects/play.h"

#include <algorithm>
#include <cstddef>

namespace supercircle::effects {

Motion behindPlay(const Motion& drive, double width) {
    if (!(width > 0.0) || drive.time.empty())
        return drive;
    Motion head;
    double x = drive.displacement.front();
    const auto put = [&](double time) {
        if (head.time.empty() || time > head.time.back()) {
            head.time.push_back(time);
            head.displacement.push_back(x);
        }
    };
    put(drive.time.front());
    for (std::size_t i = 1; i < drive.time.size(); ++i) {
        const double from = drive.displacement[i - 1], to = drive.displacement[i];
        const double moved = std::clamp(x, to, to + width);
        if (moved != x) { // where the play is used up
            const double meets = to > from ? x : x - width, share = (meets - from) / (to - from);
            put(drive.time[i - 1] + std::clamp(share, 0.0, 1.0) * (drive.time[i] - drive.time[i - 1]));
            x = moved;
        }
        put(drive.time[i]);
    }
    return head;
}

} // namespace supercircle::effects
