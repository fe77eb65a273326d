#pragma once
// The sound of a running world: snaps and hits of its events, friction of its energy balance.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/graphics/sound/synthesiser.h"

#include <vector>

namespace supercircle::live {

class SoundWatch {
public:
    /// After each frame. Does nothing before the first make(): worlds without listeners pay nothing.
    void frame(const Shells& shells);
    /// The samples since the last one; `seconds` of them (0 to sound::kMostSeconds), in which what the frames since
    /// then did is heard. Good until the next one.
    [[nodiscard]] std::span<const float> make(const Shells& shells, double seconds);
    /// Of the last make().
    [[nodiscard]] std::span<const float> samples() const { return samples_; }
    [[nodiscard]] bool on() const { return on_; }

private:
    struct Event {
        double time = 0.0, strength = 0.0, radius = 0.0; ///< s, 1, m
        bool snap = false;
    };
    sound::Synthesiser synthesiser_;
    std::vector<Event> events_;
    std::span<const float> samples_;
    double from_ = 0.0;                        ///< time of the last make(), s
    double friction_ = 0.0, frictionAt_ = 0.0; ///< dissipated until then, J and s
    double power_ = 0.0, speed_ = 0.0;         ///< of friction in the last frame, 1
    bool on_ = false;
};

} // namespace supercircle::live
