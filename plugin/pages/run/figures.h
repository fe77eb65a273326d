#pragma once
// The figures of a report. Every one draws into a rectangle of a sheet and says whether there was something to draw.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/canvas.h"
#include "plugin/recording/table/recording.h"

namespace supercircle::report {

/// Where a diagram's data landed, for markers that move over it.
struct PlotFrame {
    Rect area;
    Range x, y; ///< data units (m, s, N, J)
};

/// Force against displacement: loading warm, unloading cool, events marked, second axes in R and B/R^2.
/// Needs columns displacement_m and force_N with something in them.
[[nodiscard]] std::optional<PlotFrame> drawForce(Canvas& canvas, const record::Recording& recording, const Rect& sheet,
                                                 const std::string& title = {});

/// Energy books over time: every column that ends in `_J`, the residual below on a scale of its own.
[[nodiscard]] std::optional<PlotFrame> drawEnergy(Canvas& canvas, const record::Recording& recording, const Rect& sheet,
                                                  const std::string& title = {});

/// A frame worth a picture.
struct KeyView {
    std::string id;    ///< "before", "peak", "after", "start", "end"
    std::string title; ///< for people
    std::size_t frame = 0;
};

/// The key frames of a recording; first and last frame where it names none.
[[nodiscard]] std::vector<KeyView> keyViews(const record::Recording& recording);

/// Part of the plane, m, y upwards.
struct View {
    Range x, y;
};

/// What the frames show: all shells, and the bodies as far as they stand near them.
[[nodiscard]] View viewOf(const record::Recording& recording, const std::vector<std::size_t>& frames);

/// Largest bending energy of one shell in any frame, J: the end of the colour scale. 0 if there is none.
[[nodiscard]] double largestBendingEnergy(const record::Recording& recording);

/// Bodies moved by the machine, by index; where no outline says so, those that moved by the machine's travel.
[[nodiscard]] std::vector<bool> drivenBodies(const record::Recording& recording);

/// Shells with their true thickness and round ends, coloured by bending energy (0 .. energyScale), bodies grey.
void drawConfiguration(Canvas& canvas, const record::Recording& recording, std::size_t frame, const View& view,
                       double energyScale, const Rect& sheet, const std::string& title = {});

/// Colour scale of drawConfiguration().
void drawColourBar(Canvas& canvas, double energyScale, const Rect& sheet);

} // namespace supercircle::report
