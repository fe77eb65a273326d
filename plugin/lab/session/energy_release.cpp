#include "plugin/lab/session/energy_release.h"

#include <algorithm>

namespace supercircle::lab {

void EnergyRelease::sample(double travel, const std::vector<double>& energies) {
    recent_.resize(energies.size());
    for (std::size_t i = 0; i < energies.size(); ++i) {
        RecentMaxima& r = recent_[i];
        while (!r.empty() && r.back().second <= energies[i]) // a later and higher energy is where a fall begins
            r.pop_back();
        r.emplace_back(travel, energies[i]);
        while (r.front().first < travel - window_)
            r.pop_front();
        largest_ = std::max(largest_, r.front().second - energies[i]);
    }
}

} // namespace supercircle::lab
