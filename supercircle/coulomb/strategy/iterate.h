#pragma once
// What every method passes on: impulses, the whitened velocities that belong to them, and the best seen so far.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/strategy/whitened.h"

#include <vector>

namespace supercircle::coulomb {

/// Target shared by all methods of one solve.
struct Target {
    double eta = 1e-8;      ///< residual to reach, 1
    double impulse = 1e-13; ///< N s, solved as well if every natural-map error is below
    bool reached(const Residual& residual) const { return residual.eta <= eta || residual.impulseError <= impulse; }
};

struct Iterate {
    std::vector<double> r; ///< 2 per contact, N s
    std::vector<double> w; ///< whitened body velocities for r
    std::vector<Piece> piece;

    void start(const Whitened& problem, const Eigen::VectorXd& warm);
    /// The pieces the impulses (inside their cones) lie on.
    void findPieces(const Whitened& problem);
};

/// Keeps the impulses with the smallest residual; ties keep the earlier.
struct Best {
    std::vector<double> r;
    Residual residual;

    void reset() { r.clear(); }
    /// True if `candidate` is the new best.
    bool offer(const std::vector<double>& candidate, const Residual& value);
};

} // namespace supercircle::coulomb
