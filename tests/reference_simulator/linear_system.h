#pragma once
// Linear systems of a step: banded for one rod, sparse for two rods whose nodes may touch anywhere.

#include <Eigen/Core>
#include <memory>

namespace supercircle::reference_simulator {

class LinearSystem {
public:
    LinearSystem() = default;
    LinearSystem(const LinearSystem&) = delete;
    LinearSystem& operator=(const LinearSystem&) = delete;
    virtual ~LinearSystem() = default;
    virtual void clear() = 0;
    virtual void add(int row, int column, double value) = 0;
    /// Replaces a row by that of the identity.
    virtual void fix(int row) = 0;
    /// @return whether the matrix is regular
    virtual bool factor() = 0;
    [[nodiscard]] virtual Eigen::VectorXd solve(const Eigen::VectorXd& right) const = 0;
};

/// @param reach largest distance of an entry from the diagonal; 0: sparse
std::unique_ptr<LinearSystem> linearSystem(int size, int reach);

} // namespace supercircle::reference_simulator
