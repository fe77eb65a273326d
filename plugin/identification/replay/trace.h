#pragma once
// What a simulated run shows at its steps, and what is to be thought of it (private to replay/).
//
// Why means over steps of another length than the one before are doubtful says the essay in rig.cpp.

#include "supercircle/rod/model.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace supercircle::replay {

/// A mean over a step as long as the one before, one over a step that was not, any other force.
enum class Kind : std::uint8_t { Steady, Doubtful, Other };

struct Reading {
    double time = 0.0;  ///< s; means belong to the middles of steps
    double force = 0.0; ///< on the head, upwards, N
    Kind kind = Kind::Other;
    double way = 0.0; ///< of the head in the step, either direction, m
};

struct Trace {
    std::vector<Reading> forces;
    std::vector<double> time;                    ///< of the markers, s
    std::vector<std::vector<rod::Vec2>> markers; ///< per marker, m
};

struct Line {
    double time = 0.0, force = 0.0, slope = 0.0; ///< s, N, N/s
    [[nodiscard]] double at(double t) const { return force + slope * (t - time); }
};

/// Through the last two forces that are not doubtful, and drops the doubtful ones behind them; none (and nothing
/// dropped) where those are not both steady.
std::optional<Line> endTangent(std::vector<Reading>& forces);

/// Puts what the steady means on either side say in the place of doubtful ones: a specimen that begins to slide there
/// has a kink, where the tangents meet (their chord was 7 mN of 300 off in an arch), and a smooth curve is as near to
/// their corner as to the chord. Where the tangents do not meet in between, the chord stands if it is closer to them
/// than the doubtful ones are to it: else something happens there, and those stay.
std::vector<Reading> mended(const std::vector<Reading>& forces);

} // namespace supercircle::replay
