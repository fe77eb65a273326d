#include "plugin/lab/session/release.h"

#include <algorithm>

namespace supercircle::lab {

void Release::sample(double way, const std::vector<double>& energies) {
    recent_.resize(energies.size());
    for (std::size_t i = 0; i < energies.size(); ++i) {
        Recent& r = recent_[i];
        while (!r.empty() && r.back().second <= energies[i]) // what comes later and is higher is what a fall begins at
            r.pop_back();
        r.emplace_back(way, energies[i]);
        while (r.front().first < way - within_)
            r.pop_front();
        largest_ = std::max(largest_, r.front().second - energies[i]);
    }
}

} // namespace supercircle::lab
