#pragma once
// Path following: from a guess that is made exact by moving the right-hand side, back to the true right-hand side.

#include "supercircle/coulomb/pivoting/piece_system.h"
#include "supercircle/coulomb/strategy/iterate.h"

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

    /// Solves `contacts` starting from x.r and x.piece until their sum d |F|^2 <= allowed (J). `outside` are the other
    /// contacts of the same bodies, whose impulses stay (none for a whole island). On return x.r, x.w and x.piece hold
    /// the last proximal solution, unless the path failed.
    Outcome run(const Whitened& problem, std::span<const std::int32_t> contacts, std::span<const std::int32_t> outside,
                const PathSettings& settings, double allowed, Iterate& x, PathCounts& counts);

private:
    enum class Event : std::uint8_t { None, Close, Open, Stick, SlipPlus, SlipMinus };
    struct Breakpoint {
        double step = 0.0;
        std::size_t k = 0;
        Event event = Event::None;
    };

    /// What bounds the normal velocity of an open contact: its bodies and the lengths of its rows.
    struct Watch {
        std::int32_t body[2] = {0, 0};
        double reach[2] = {0.0, 0.0};
    };

    void begin(const Whitened& problem, const PathSettings& settings, const Iterate& x);
    double errorOf(const Whitened& problem) const;
    Outcome follow(const Whitened& problem, const PathSettings& settings, PathCounts& counts);
    bool direction(const Whitened& problem);
    Breakpoint nextBreakpoint(const Whitened& problem, double sign);
    double openRate(const Whitened& problem, std::size_t k) const;
    double enteringRate(const Whitened& problem, std::size_t k, Event event) const;
    void flip(const Whitened& problem, const Breakpoint& at);
    void fixVelocities(const Whitened& problem, const Iterate& x);
    void copyBodies(const Whitened& problem, const std::vector<double>& from, std::vector<double>& to) const;
    void refreshVelocities(const Whitened& problem);
    bool refactor(const Whitened& problem, const PathSettings& settings, PathCounts& counts);
    bool polish(const Whitened& problem);
    void store(const Whitened& problem, Iterate& x) const;

    std::span<const std::int32_t> contacts_, outside_;
    std::vector<std::int32_t> bodies_;
    std::vector<Piece> piece_;
    std::vector<double> r_, u_, anchor_, shift_, dr_, du_, trial_;
    std::vector<double> w_, dw_, mu_, prox_;
    std::vector<double> fixed_; ///< whitened velocities without the impulses of `contacts_`
    std::vector<Watch> watch_;
    std::vector<double> bodyRate_;    ///< length of dw of each body
    std::vector<std::uint8_t> stale_; ///< u_n of this open contact is a lower bound only
    std::vector<std::uint8_t> tied_;  ///< bilateral: never leaves its piece
    double edge_ = 0.0;               ///< slip sign of the edge through which a contact last began to stick
    double tau_ = 0.0;
    double errorAtStart_ = 0.0;
    PieceSystem system_;
};

} // namespace supercircle::coulomb
