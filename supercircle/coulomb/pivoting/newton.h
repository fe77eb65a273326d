#pragma once
// Proximal active-set (semismooth) Newton with a line search on the judge's residual: the net behind the path.

#include "supercircle/coulomb/pivoting/piece_system.h"
#include "supercircle/coulomb/strategy/iterate.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

class Newton {
public:
    /// Improves x on the contacts of `island` until sum d |F|^2 <= allowed (J) or no step helps; at most `most` steps.
    /// Never makes the residual worse. Returns the number of factorisations.
    int run(const Whitened& problem, std::span<const std::int32_t> island, double eps, int most, double allowed,
            Iterate& x);

private:
    double errorOf(const Whitened& problem, std::span<const std::int32_t> island, const std::vector<double>& r);
    void choosePieces(const Whitened& problem, std::span<const std::int32_t> island, const Iterate& x, double eps);

    std::vector<Piece> piece_;
    std::vector<double> rhs_, step_, trial_, trialW_;
    PieceSystem system_;
};

} // namespace supercircle::coulomb
