#pragma once
// How abruptly single shells let go: the largest fall of one shell's bending energy within a short way of the machine.
//
// What was considered: the machine's force, which falls as far in stacks of shells that snap smoothly, because
// neighbours let go what they had stored together (docs/paper.md); kinetic energy, of which an implicit step keeps a
// half at best. The energy of one shell cannot fall faster than its tips slide, unless it unfolds.

#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

namespace supercircle::lab {

class Release {
public:
    explicit Release(double within) : within_(within) {}

    /// @param way of the machine, m, increasing  @param energies of all shells, J, always in the same order
    void sample(double way, const std::vector<double>& energies);
    /// A new branch: nothing falls from the one before it.
    void restart() { recent_.clear(); }
    [[nodiscard]] double largest() const { return largest_; } ///< J

private:
    using Recent = std::deque<std::pair<double, double>>; ///< way and energy, energies falling

    double within_; ///< m
    double largest_ = 0.0;
    std::vector<Recent> recent_;
};

} // namespace supercircle::lab
