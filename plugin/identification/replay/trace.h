#pragma once
// Forces of a simulated run at its steps, with their reliability (private to replay/; decision 0151).

#include "plugin/identification/replay/track.h"
#include "supercircle/effects/model.h"
#include "supercircle/rod/model.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace supercircle::replay {

/// Mean over a step as long as the one before, mean over another step, or an end force.
enum class MeanForceKind : std::uint8_t { Steady, Uncertain, Other };

struct ForceSample {
    double time = 0.0;  ///< s, middle of the step for means
    double force = 0.0; ///< N, on the crosshead, positive upwards
    MeanForceKind kind = MeanForceKind::Other;
    double travel = 0.0; ///< m, of the crosshead in the step, unsigned
};

struct Trace {
    std::vector<ForceSample> forces;
    std::vector<double> time;                    ///< s, of the markers and of `observed`
    Track observed;                              ///< m or rad, of a scene that observes a shell
    std::vector<Track> further;                  ///< of channels beside the first one; empty: not of a shell
    std::vector<std::vector<rod::Vec2>> markers; ///< m, per marker
};

struct Tangent {
    double time = 0.0, force = 0.0, slope = 0.0; ///< s, N, N/s
    [[nodiscard]] double at(double t) const { return force + slope * (t - time); }
};

/// Tangent through the last two certain forces; uncertain ones after them are removed. None (and nothing removed) if
/// those two are not both steady.
[[nodiscard]] std::optional<Tangent> endTangent(std::vector<ForceSample>& forces);

/// Replaces uncertain means by the tangents of steady ones on either side: a specimen that begins to slide has a kink
/// where the tangents meet. If they do not meet in between, the chord is used where it is closer to the tangents than
/// the uncertain means are to it. Otherwise those stay.
std::vector<ForceSample> despiked(const std::vector<ForceSample>& forces);

/// Replaces values at `times`, s, by what a sensor with a zero reads. Missing ones stay missing.
void readBy(const effects::SensorModel& sensor, const std::vector<double>& times, double zero,
            std::vector<double>& values);

} // namespace supercircle::replay
