#pragma once
// Linear systems of a step: a band for one rod, a sparse matrix for two whose nodes meet anywhere.

#include <Eigen/Core>
#include <memory>

namespace supercircle::oracle {

class LinearSystem {
public:
    LinearSystem() = default;
    LinearSystem(const LinearSystem&) = delete;
    LinearSystem& operator=(const LinearSystem&) = delete;
    virtual ~LinearSystem() = default;
    virtual void clear() = 0;
    virtual void add(int row, int column, double value) = 0;
    /// Makes a row that of the identity.
    virtual void fix(int row) = 0;
    /// @return whether the matrix is regular
    virtual bool factor() = 0;
    [[nodiscard]] virtual Eigen::VectorXd solve(const Eigen::VectorXd& right) const = 0;
};

/// @param reach largest distance of an entry from the diagonal; 0: anywhere
std::unique_ptr<LinearSystem> linearSystem(int size, int reach);

} // namespace supercircle::oracle
