#pragma once
// Block Gauss-Seidel on the whitened velocities, with the exact law of one contact; plain and accelerated.

#include "supercircle/coulomb/strategy/iterate.h"

#include <span>

namespace supercircle::coulomb {

class GaussSeidel {
public:
    /// Prepares the local laws and the order of the contacts.
    void prepare(const Whitened& problem);

    /// One pass over all contacts; returns sum d |dr|^2 (J).
    double sweep(const Whitened& problem, Iterate& x) const;

    /// `sweeps` plain sweeps over some contacts only, in the order given.
    void sweepSome(const Whitened& problem, std::span<const std::int32_t> contacts, int sweeps, Iterate& x) const;

    /// Up to `sweeps` plain sweeps; judges now and then, offers to `best`, stops when `target` is reached.
    int run(const Whitened& problem, Iterate& x, int sweeps, const Target& target, Best& best) const;

    /// The same with nonlinear conjugate-gradient acceleration.
    int runAccelerated(const Whitened& problem, Iterate& x, int sweeps, const Target& target, Best& best);

private:
    double update(const Whitened& problem, std::int32_t c, Iterate& x) const;

    std::vector<LocalLaw> law_;
    std::vector<std::int32_t> order_;
    std::vector<std::int32_t> rank_;
    std::vector<std::int32_t> seen_;
    std::vector<double> previousR_, previousW_, directionR_, directionW_;
};

} // namespace supercircle::coulomb
