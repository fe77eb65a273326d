#include "plugin/lab/curve.h"

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
                                  double within) {
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
                if (std::abs(displacement[bottom] - displacement[top]) <= within)
                    out.push_back({top, bottom, force[top] - force[bottom]});
                falling = false;
                top = i;
            }
        }
    }
    if (falling && std::abs(displacement[bottom] - displacement[top]) <= within)
        out.push_back({top, bottom, force[top] - force[bottom]});
    return out;
}

std::vector<ForceDrop> mergeDrops(std::span<const double> displacement, const std::vector<ForceDrop>& drops,
                                  double apart) {
    std::vector<ForceDrop> out;
    for (const ForceDrop& d : drops) {
        if (out.empty() || std::abs(displacement[d.top] - displacement[out.back().bottom]) > apart) {
            out.push_back(d);
            continue;
        }
        out.back().size = std::max(out.back().size, d.size);
        out.back().bottom = d.bottom;
    }
    return out;
}

} // namespace supercircle::lab
