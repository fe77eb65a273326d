#pragma once
// LU factorisation of a matrix in envelope (skyline) storage: rows only as wide as their entries.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Doolittle LU in an envelope: row i and column i have entries from first[i] to i only (structurally symmetric).
/// Without pivoting, for nearly positive definite matrices; `factor` reports a failure.
class EnvelopeLu {
public:
    struct IndexRange {
        std::size_t begin = 0;
        std::size_t end = 0;
    };

    /// Sets the shape, first[i] <= i, and clears all entries.
    void shape(std::span<const std::int32_t> first);

    /// Entry (i, j), inside the envelope; valid until `factor`.
    double& at(std::int32_t i, std::int32_t j) {
        if (j < i)
            return lower_[start_[i] + static_cast<std::size_t>(j - first_[i])];
        if (j > i)
            return upper_[start_[j] + static_cast<std::size_t>(i - first_[j])];
        return diagonal_[i];
    }

    /// Factors in place. False if a pivot lost more than about twelve digits against its diagonal entry.
    [[nodiscard]] bool factor();

    /// Solves in place.
    void solve(double* x) const;

    /// Solves in place if entries of x before `begin` are zero and most of the solution is negligible. Entries below
    /// round-off of the largest are set to zero. Returns the range outside which x is exactly zero.
    IndexRange solveLocal(double* x, std::size_t begin) const;

    std::size_t size() const { return first_.size(); }

    /// Multiply-adds of a factorisation of this shape.
    static double cost(std::span<const std::int32_t> first);

private:
    std::vector<std::int32_t> first_;
    std::vector<std::int32_t> reach_; ///< smallest first of this row and all later ones
    std::vector<std::size_t> start_;
    std::vector<double> lower_, upper_, diagonal_, inverse_;
};

} // namespace supercircle::coulomb
