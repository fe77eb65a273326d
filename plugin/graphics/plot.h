#pragma once
// The frame of a diagram: grid, axes, ticks, labels, and free places for texts.

#include <optional>
#include <string>
#include <vector>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/canvas.h"
#include "plugin/graphics/theme.h"

namespace supercircle::graphics {

/// An axis as shown: number on it = data value * factor.
struct AxisStyle {
    std::string label;
    double factor = 1.0;
};

struct PlotStyle {
    AxisStyle x, y;
    std::optional<AxisStyle> top, right; ///< second scales
    int xTicks = 8, yTicks = 7;
    Colour ink = theme::ink, muted = theme::muted, grid = theme::grid, axis = theme::axis;
};

/// A diagram whose inner area is `area`; ranges are in data units.
class Plot {
public:
    Plot(Rect inner, AxisRange xRange, AxisRange yRange) : area(inner), x(xRange), y(yRange) {}

    [[nodiscard]] Point at(double dataX, double dataY) const {
        return {area.x + (dataX - x.lo) / x.span() * area.width,
                area.bottom() - (dataY - y.lo) / y.span() * area.height};
    }
    /// Grid, zero line, frame, ticks and labels.
    void drawFrame(Canvas& canvas, const PlotStyle& style) const;
    /// One polyline through the rows of two columns, thinned for this area's width; gaps where values are missing.
    void drawLine(Canvas& canvas, const std::vector<double>& xs, const std::vector<double>& ys,
                  const Stroke& stroke) const;

    Rect area;
    AxisRange x, y;

private:
    void drawGrid(Canvas& canvas, const PlotStyle& style) const;
    void drawSecondAxes(Canvas& canvas, const PlotStyle& style) const;
};

/// Finds places for texts that overlap nothing placed before.
class LabelPlacer {
public:
    explicit LabelPlacer(Rect limits) : bounds_(limits) {}
    /// Marks an area as occupied.
    void reserve(const Rect& r) { taken_.push_back(r); }
    /// Draws `text` at the nearest free place of several around `anchor`; nothing if there is none.
    /// @return whether it was drawn
    bool place(Canvas& canvas, Point anchor, double distance, std::string_view text, const TextStyle& style);

private:
    [[nodiscard]] bool free(const Rect& r) const;
    Rect bounds_;
    std::vector<Rect> taken_;
};

} // namespace supercircle::graphics
