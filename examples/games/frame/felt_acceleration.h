#pragma once
// Acceleration that an occupant of a body feels: against free fall, in g, mean of two steps. (That of a single step
// depends on the step size.) Its largest value decides games.

#include "examples/games/frame/game_world.h"

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

class FeltAcceleration {
public:
    static constexpr double kG = 9.81; ///< m/s^2
    /// Starts anew for a body with this velocity, m/s.
    void reset(Point velocity) {
        last_ = velocity;
        before_ = {};
        steps_ = 0;
        hardest_ = 0.0;
    }
    void step(Point velocity, double dt = kStep) {
        const Point a{(velocity.x - last_.x) / dt, (velocity.y - last_.y) / dt + kG};
        last_ = velocity;
        if (++steps_ > 2) // the first ones have no past
            hardest_ = std::max(hardest_, std::hypot(0.5 * (a.x + before_.x), 0.5 * (a.y + before_.y)) / kG);
        before_ = a;
    }
    [[nodiscard]] double hardest() const { return hardest_; } ///< g

private:
    Point last_{}, before_{};
    double hardest_ = 0.0;
    int steps_ = 0;
};

} // namespace supercircle::frame
