#pragma once
// Shells and bodies as points of the plane.

#include <vector>

#include "plugin/graphics/canvas.h"
#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// Lengths of a pose's elements, m: those of the shell, or equal parts of its length where it names none.
[[nodiscard]] std::vector<double> elementLengths(const record::ShellInfo& shell, std::size_t elements);

/// Centre line in world coordinates (m, y upwards); neighbouring points are so close that the chord leaves the arc by
/// at most `tolerance` (m). Empty if a number is not finite.
[[nodiscard]] std::vector<graphics::Point> centreLine(const record::ShellInfo& shell, const record::ShellPose& pose,
                                                      double tolerance);

/// Outline in world coordinates; a circle as its centre only. Untransformed where the frame has no such body.
[[nodiscard]] std::vector<graphics::Point> worldOutline(const record::OutlineInfo& outline, const record::Frame& frame);

} // namespace supercircle::pages
