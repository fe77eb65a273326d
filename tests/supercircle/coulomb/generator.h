#pragma once
// Random contact problems with a guaranteed solution. Every gap is open or closed, never overlapping, and no surface is
// driven (w_n >= 0, w_t = 0). Then u(v = 0) lies in the dual cone and a solution exists (Acary, Cadoux, Lemarechal &
// Malick 2011). Own random numbers: the standard distributions differ between libraries.

#include "supercircle/coulomb/problem.h"

#include <cstdint>

namespace generator {

/// SplitMix64 (Steele, Lea & Flood 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits();
    double uniform(double from = 0.0, double to = 1.0); ///< [from, to)
    int index(int count);                               ///< 0 .. count - 1

private:
    std::uint64_t state_;
};

/// Bodies of `freedoms` with random SPD A of the given condition, contacts between random pairs or to the ground;
/// `duplicates` is the share of contacts copied from an earlier one.
struct Cloud {
    int bodies = 10;
    int contacts = 30;
    int freedoms = 6;
    double condition = 100.0;
    double massRatio = 1.0; ///< heaviest to lightest body
    double mu = 0.35;
    double duplicates = 0.0;
    double self = 0.0; ///< share of contacts of a body with itself
};
supercircle::coulomb::Problem cloud(const Cloud& options, Random& random);

/// Boxes of 3 freedoms on top of each other, two corner contacts an interface, gravity and a random sideways push.
supercircle::coulomb::Problem tower(int boxes, double mu, double massRatio, double dt, Random& random);

/// Open shells of the paper, nested in each other like spoons and squeezed by `force` (N). Each has 18 freedoms,
/// ordered [left | right | middle, x, y, theta], with A = M + dt^2 K of circular arcs. `perPair` nearly parallel
/// contacts an interface.
struct Nest {
    int shells = 5;
    int perPair = 25;
    double mu = 0.35;
    double dt = 1e-3;     ///< s
    double force = 1.0;   ///< N, downwards on the top shell's middle
    double jitter = 1e-6; ///< m, scatter of the gaps
    int side = 1;         ///< nests next to each other, neighbours in contact
};
supercircle::coulomb::Problem nest(const Nest& options, Random& random);

} // namespace generator
