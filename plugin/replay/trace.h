#pragma once
// What a simulated run shows at its steps, and what is to be thought of it (private to replay/).
//
// Why means over steps of another length than the one before are doubtful says the essay in rig.cpp.

#include "supercircle/rod/model.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace supercircle::replay {

/// What a step's force is: a mean over a step as long as the one before, one over a step that was not, anything else.
enum class Step : std::uint8_t { Steady, Doubtful, Other };

/// Forces have times of their own: means belong to the middles of steps.
struct Trace {
    std::vector<double> forceTime;               ///< s
    std::vector<double> force;                   ///< on the head, upwards, N
    std::vector<Step> step;                      ///< of each force
    std::vector<double> way;                     ///< of the head in the step, m
    std::vector<double> time;                    ///< of the markers, s
    std::vector<std::vector<rod::Vec2>> markers; ///< per marker, m

    void addForce(double at, double value, Step kind = Step::Other, double headWay = 0.0);

    struct Line {
        double time, force, slope; ///< s, N, N/s
        [[nodiscard]] double at(double t) const { return force + slope * (t - time); }
    };
    /// Through the last two forces that are not doubtful; none where they are not both steady. Doubtful ones behind
    /// them are dropped then.
    std::optional<Line> endTangent();

    /// Puts what the steady means on either side say in the place of doubtful ones: a specimen that begins to slide
    /// there has a kink, where the tangents meet (their chord was 7 mN of 300 off in an arch), and a smooth curve is as
    /// near to their corner as to the chord. Where the tangents do not meet in between, the chord stands if it is
    /// closer to them than the doubtful ones are to it: else something happens there, and those stay.
    void mend();

private:
    [[nodiscard]] std::optional<Line> tangentAt(std::size_t i, bool ahead) const;
    void mend(std::size_t from, std::size_t to);
    void erase(std::size_t from, std::size_t to);
};

} // namespace supercircle::replay
