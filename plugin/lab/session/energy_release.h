#pragma once
// Abruptness of snap-fits: the largest fall of one shell's bending energy within a short crosshead travel.
// The energy of one shell cannot fall faster than its tips slide, unless it unfolds (decision 0062).

#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

namespace supercircle::lab {

class EnergyRelease {
public:
    /// @param window crosshead travel within which a fall counts, m
    explicit EnergyRelease(double window) : window_(window) {}

    /// @param travel of the crosshead, m, increasing  @param energies of all shells, J, always in the same order
    void sample(double travel, const std::vector<double>& energies);
    /// Starts a new loading branch: falls do not reach across branches.
    void restart() { recent_.clear(); }
    [[nodiscard]] double largest() const { return largest_; } ///< J

    /// Calls `archive` with all that changes, for saving and loading.
    template <class Self, class Archive>
    static void state(Self& self, Archive& archive) {
        archive(self.largest_, self.recent_);
    }

private:
    using RecentMaxima = std::deque<std::pair<double, double>>; ///< travel and energy; energies decrease

    double window_; ///< m
    double largest_ = 0.0;
    std::vector<RecentMaxima> recent_;
};

} // namespace supercircle::lab
