#pragma once
// The snaps that a picture still shows: a text fades within 0.8 s, and at most three a second flash.

#include "plugin/graphics/canvas.h"

#include <cstddef>
#include <vector>

namespace supercircle::picture {

struct SnapMark {
    graphics::Point at{};  ///< m
    double released = 0.0; ///< J
    double age = 0.0;      ///< of its life, 0 to 1
    bool flash = false;    ///< with light
};

inline constexpr double kSnapLife = 0.8; ///< s
/// Between the starts of two flashes, s: three a second is the limit of WCAG 2.3.1. Half of it may harm viewers with
/// photosensitive epilepsy; twice of it leaves most snaps of a falling stack without light.
inline constexpr double kFlashInterval = 1.0 / 3.0;
inline constexpr std::size_t kMostMarks = 12; ///< shown at a time: 24 hide the shells, 6 drop some of a stack

class SnapMarks {
public:
    /// A shell has released energy (J) at a point (m) at a time of the world (s). The next picture shows it first,
    /// unless it comes too late.
    void add(graphics::Point at, double joules, double time);
    /// What a picture shows at `clock` and at the world's `time`, s. The clock is the viewer's, or the world's time
    /// again; one that runs backwards forgets everything that is shown.
    [[nodiscard]] std::vector<SnapMark> at(double clock, double time);

private:
    struct Entry {
        graphics::Point at{};
        double released = 0.0, since = 0.0; ///< since: time of the world while fresh, then of the clock
        bool fresh = true, flash = false;
    };
    std::vector<Entry> entries_;
    double last_ = 0.0, lastFlash_ = -1e300;
};

} // namespace supercircle::picture
