#include "supercircle/effects/backlash.h"

#include <algorithm>
#include <cstddef>

namespace supercircle::effects {

DriveMotion motionBehindBacklash(const DriveMotion& drive, double width) {
    if (!(width > 0.0) || drive.time.empty())
        return drive;
    DriveMotion crosshead;
    double x = drive.displacement.front();
    const auto put = [&](double time) {
        if (crosshead.time.empty() || time > crosshead.time.back()) {
            crosshead.time.push_back(time);
            crosshead.displacement.push_back(x);
        }
    };
    put(drive.time.front());
    for (std::size_t i = 1; i < drive.time.size(); ++i) {
        const double from = drive.displacement[i - 1], to = drive.displacement[i];
        const double moved = std::clamp(x, to, to + width);
        if (moved != x) { // where the backlash is taken up
            const double meets = to > from ? x : x - width, share = (meets - from) / (to - from);
            put(drive.time[i - 1] + std::clamp(share, 0.0, 1.0) * (drive.time[i] - drive.time[i - 1]));
            x = moved;
        }
        put(drive.time[i]);
    }
    return crosshead;
}

} // namespace supercircle::effects
