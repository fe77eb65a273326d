#pragma once
// What somebody in a body feels: its acceleration against free fall, in g, the mean of two steps (a single step is a
// matter of numerics). The hardest moment decides games.

#include "examples/games/frame/stage.h"

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

class Feel {
public:
    static constexpr double kG = 9.81; ///< m/s^2
    /// From here on, for a body with this velocity.
    void reset(Point velocity) {
        last_ = velocity;
        before_ = {};
        steps_ = 0;
        hardest_ = 0.0;
    }
    void step(Point velocity, double dt = kStep) {
        const Point a{(velocity.x - last_.x) / dt, (velocity.y - last_.y) / dt + kG};
        last_ = velocity;
        if (++steps_ > 2) // the first ones know no past
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
