#include "plugin/lab/session/force_curve.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

double workOf(std::span<const double> displacement, std::span<const double> force) {
    double sum = 0.0;
    for (std::size_t i = 1; i < displacement.size(); ++i)
        sum += 0.5 * (force[i] + force[i - 1]) * (displacement[i] - displacement[i - 1]);
    return sum;
}

std::vector<ForceDrop> forceDrops(std::span<const double> displacement, std::span<const double> force, double threshold,
                                  double maxTravel) {
    std::vector<ForceDrop> out;
    if (force.empty())
        return out;
    bool falling = false;
    std::size_t top = 0, bottom = 0;
    for (std::size_t i = 1; i < force.size(); ++i) {
        if (!falling) {
            if (force[i] >= force[top])
                top = i;
            else if (force[top] - force[i] >= threshold) {
                falling = true;
                bottom = i;
            }
        } else {
            if (force[i] <= force[bottom])
                bottom = i;
            else if (force[i] - force[bottom] >= threshold) {
                if (std::abs(displacement[bottom] - displacement[top]) <= maxTravel)
                    out.push_back({top, bottom, force[top] - force[bottom]});
                falling = false;
                top = i;
            }
        }
    }
    if (falling && std::abs(displacement[bottom] - displacement[top]) <= maxTravel)
        out.push_back({top, bottom, force[top] - force[bottom]});
    return out;
}

std::vector<ForceDrop> mergeDrops(std::span<const double> displacement, std::span<const double> force,
                                  const std::vector<ForceDrop>& drops, double maxGap) {
    std::vector<ForceDrop> out;
    for (const ForceDrop& d : drops) {
        if (out.empty() || std::abs(displacement[d.top] - displacement[out.back().bottom]) > maxGap) {
            out.push_back(d);
            continue;
        }
        ForceDrop& merged = out.back();
        merged.size = std::max({merged.size, d.size, force[merged.top] - force[d.bottom]});
        merged.bottom = d.bottom;
    }
    return out;
}

ForceExtremes averagedExtremes(std::span<const double> time, std::span<const double> displacement,
                               std::span<const double> force, double window) {
    ForceExtremes out;
    double impulse = 0.0; // of rows (first, last]
    std::size_t first = 0;
    for (std::size_t last = 1; last < time.size(); ++last) {
        impulse += force[last] * (time[last] - time[last - 1]);
        // As short as possible, but no shorter than the window.
        while (first + 1 < last && std::abs(displacement[last] - displacement[first + 1]) >= window) {
            impulse -= force[first + 1] * (time[first + 1] - time[first]);
            ++first;
        }
        const double duration = time[last] - time[first];
        if (duration <= 0.0 || std::abs(displacement[last] - displacement[first]) < window)
            continue;
        if (impulse / duration > out.peak) {
            out.peak = impulse / duration;
            out.from = first;
            out.to = last;
        }
        out.pullOff = std::min(out.pullOff, impulse / duration);
    }
    return out;
}

} // namespace supercircle::lab
