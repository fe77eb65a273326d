#pragma once
// What the corners and faces of an outline are in the union with the outlines it touches (seams.h finds it).

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace supercircle::contact {

enum class VertexRole : std::uint8_t {
    Alone, ///< answers as the corner of its own outline
    Cone,  ///< a corner of the union: answers in directions w with w . c1 >= 0 and w . c2 >= 0
    Hidden ///< no corner of the union, or another outline's vertex answers there
};

struct VertexSeam {
    VertexRole role = VertexRole::Alone;
    Eigen::Vector2d c1 = Eigen::Vector2d::Zero(); ///< unit
    Eigen::Vector2d c2 = Eigen::Vector2d::Zero(); ///< unit
    bool operator==(const VertexSeam&) const = default;
};

/// A stretch of a face that lies inside another outline.
struct HiddenSpan {
    std::int32_t face = 0; ///< face i starts at point i; of a two-sided segment 0 is the left side, 1 the right side
    double from = 0.0;     ///< m from the start of the face
    double to = 0.0;       ///< m
    bool operator==(const HiddenSpan&) const = default;
};

/// Empty for an outline that stands alone.
struct OutlineSeams {
    std::vector<VertexSeam> vertices; ///< one per point, or none
    std::vector<HiddenSpan> hidden;   ///< by face
    [[nodiscard]] bool empty() const { return vertices.empty() && hidden.empty(); }
    void clear() {
        vertices.clear();
        hidden.clear();
    }
    bool operator==(const OutlineSeams&) const = default;
};

} // namespace supercircle::contact
