#pragma once
// A draw list as what OpenGL takes: pieces of bands (and discs, glows) as instances, polygons as triangles with a seam
// of one pixel that fades, both smooth without multisampling.

#include "plugin/graphics/picture/draw_list.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::frame {

/// The hull of two discs, cut where the neighbouring pieces begin. A glow is a disc that adds light.
struct GlPiece {
    std::array<float, 2> a{}, b{};       ///< px
    std::array<float, 2> radii{};        ///< px
    std::array<float, 2> cutA{}, cutB{}; ///< directions forward of the cuts through a and b; 0: none
    std::array<std::uint8_t, 4> colour{};
    float glow = 0.0F; ///< 1: a glow
};

struct GlCorner {
    std::array<float, 2> at{};
    std::array<std::uint8_t, 4> colour{};
};

struct GlText {
    std::string text;
    picture::Point at{};
    double size = 0.0;
    graphics::Colour colour{};
    int anchor = 0;
    bool bold = false;
    double angle = 0.0; ///< clockwise, degrees
};

/// Consecutive shapes of one kind.
struct GlBatch {
    enum class Kind { Pieces, Triangles, Text, Clip } kind = Kind::Pieces;
    std::size_t first = 0, count = 0; ///< pieces, corners or texts
    picture::Rect clip{};             ///< px
};

struct GlShapes {
    std::vector<GlPiece> pieces;
    std::vector<GlCorner> corners; ///< three a triangle
    std::vector<GlText> texts;
    std::vector<GlBatch> batches;
};

[[nodiscard]] GlShapes shapesOf(const picture::DrawList& list);

} // namespace supercircle::frame
