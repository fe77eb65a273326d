#pragma once
// Colour maps.

#include "plugin/graphics/canvas.h"

namespace supercircle::graphics {

/// Sequential map for t in 0 .. 1 (clamped; NaN: grey): light blue over violet to dark red. Lightness falls strictly
/// and equal steps of t are equal steps in OKLab. The map is readable in grey, has no false edges and a visible light
/// end.
[[nodiscard]] Colour energyColour(double t);

/// Diverging map for t in -1 .. 1 (clamped): blue, grey, red, of equal lightness at equal distance from 0.
[[nodiscard]] Colour signedColour(double t);

/// Lightness of OKLab, 0 .. 1 (B. Ottosson, "A perceptual color space for image processing", 2020).
[[nodiscard]] double lightness(const Colour& colour);

/// Distance of two colours in OKLab.
[[nodiscard]] double colourDistance(const Colour& a, const Colour& b);

} // namespace supercircle::graphics
