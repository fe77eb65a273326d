#pragma once
// The figures of a report. Each draws into a rectangle of a sheet and returns whether there was something to draw.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/canvas.h"
#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// Area and axis ranges of a drawn diagram, for markers that move over it.
struct PlotFrame {
    graphics::Rect area;
    graphics::AxisRange x, y; ///< data units (m, s, N, J)
};

/// Whether anything was driven or measured: a force or displacement that is not the same all the time.
[[nodiscard]] bool hasForceCurve(const record::Recording& recording);

/// Force against displacement: loading warm, unloading cool, events marked, second axes in R and B/R^2.
/// Needs a curve (hasForceCurve).
[[nodiscard]] std::optional<PlotFrame> drawForce(graphics::Canvas& canvas, const record::Recording& recording,
                                                 const graphics::Rect& sheet, const std::string& title = {});

/// Energy balance over time: every column that ends in `_J`; the residual below on its own scale.
[[nodiscard]] std::optional<PlotFrame> drawEnergy(graphics::Canvas& canvas, const record::Recording& recording,
                                                  const graphics::Rect& sheet, const std::string& title = {});

/// A frame with a picture of its own.
struct KeyView {
    std::string id;    ///< "before", "peak", "after", "start", "end"
    std::string title; ///< shown above the picture
    std::size_t frame = 0;
};

/// The key frames of a recording. Where it names none, or has no force curve: its start, the frame with the largest
/// bending energy, its end.
[[nodiscard]] std::vector<KeyView> keyViews(const record::Recording& recording);

/// Part of the plane, m, y upwards.
struct View {
    graphics::AxisRange x, y;
};

/// The region of the frames: all shells, and the bodies near them.
[[nodiscard]] View viewOf(const record::Recording& recording, const std::vector<std::size_t>& frames);

/// Largest bending energy of one shell in any frame, J: the end of the colour scale. 0 if there is none.
[[nodiscard]] double largestBendingEnergy(const record::Recording& recording);

/// Bodies driven by the crosshead, by index; where no outline says so, those that moved by its travel.
[[nodiscard]] std::vector<bool> drivenBodies(const record::Recording& recording);

/// Shells with their true thickness and round ends, coloured by bending energy (0 .. energyScale), bodies grey.
void drawConfiguration(graphics::Canvas& canvas, const record::Recording& recording, std::size_t frame,
                       const View& view, double energyScale, const graphics::Rect& sheet,
                       const std::string& title = {});

/// Colour scale of drawConfiguration().
void drawColourBar(graphics::Canvas& canvas, double energyScale, const graphics::Rect& sheet);

} // namespace supercircle::pages
