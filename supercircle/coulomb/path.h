#pragma once
// Path following: from a guess that is made exact by moving the right-hand side, back to the true right-hand side.

#include "supercircle/coulomb/iterate.h"
#include "supercircle/coulomb/piece_system.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Counts of one solve, added to by every path.
struct PathCounts {
    int pivots = 0;
    int factorisations = 0;
};

struct PathSettings {
    double eps = 1e-6;      ///< proximal term relative to d_c, 1
    double slack = 1.0;     ///< size of the non-degeneracy slacks relative to the error of the guess, 1
    std::uint32_t seed = 0; ///< chooses other slacks
    int maxPivots = 600;
    int maxOuter = 12; ///< proximal repeats
};

class Path {
public:
    enum class Outcome : std::uint8_t { Solved, Stalled, Ray, Wandered, Pivots, Singular };

    /// Solves the contacts `island` (closed under shared bodies) starting from x.r and x.piece until
    /// sum d |F|^2 <= allowed (J). On return x.r, x.w and x.piece hold the last proximal solution, unless the path
    /// failed.
    Outcome run(const Whitened& problem, std::span<const std::int32_t> island, const PathSettings& settings,
                double allowed, Iterate& x, PathCounts& counts);

private:
    enum class Event : std::uint8_t { None, Close, Open, Stick, SlipPlus, SlipMinus };
    struct Breakpoint {
        double step = 0.0;
        std::size_t k = 0;
        Event event = Event::None;
    };

    void begin(const Whitened& problem, const PathSettings& settings, const Iterate& x);
    double errorOf(const Whitened& problem) const;
    Outcome follow(const Whitened& problem, const PathSettings& settings, PathCounts& counts);
    bool direction(const Whitened& problem);
    Breakpoint nextBreakpoint(double sign) const;
    double enteringRate(std::size_t k, Event event) const;
    void flip(const Whitened& problem, const Breakpoint& at);
    void refreshVelocities(const Whitened& problem);
    bool refactor(const Whitened& problem, const PathSettings& settings, PathCounts& counts);
    bool polish(const Whitened& problem);
    void store(Iterate& x) const;

    std::span<const std::int32_t> contacts_;
    std::vector<std::int32_t> bodies_;
    std::vector<Piece> piece_;
    std::vector<double> r_, u_, anchor_, shift_, dr_, du_, trial_;
    std::vector<double> w_, dw_, mu_, prox_;
    double edge_ = 0.0; ///< slip sign of the edge through which a contact last began to stick
    double tau_ = 0.0;
    double errorAtStart_ = 0.0;
    PieceSystem system_;
};

} // namespace supercircle::coulomb
