#pragma once
// A canvas that draws into a list: plots, titles and panels beside the picture of a world.

#include "plugin/graphics/picture/draw_list.h"

#include <vector>

namespace supercircle::picture {

/// Dashes become pieces of a line.
class ListCanvas final : public graphics::Canvas {
public:
    ListCanvas(DrawList& list, double width, double height) : list_(&list), clips_{{0.0, 0.0, width, height}} {}

    void path(const std::vector<Point>& points, bool closed, const graphics::Paint& paint) override;
    void circle(Point centre, double radius, const graphics::Paint& paint) override;
    void text(Point at, std::string_view text, const graphics::TextStyle& style) override;
    void pushClip(const Rect& area) override;
    void popClip() override;
    [[nodiscard]] DrawList& list() const { return *list_; }

private:
    void stroke(const std::vector<Point>& points, bool closed, const graphics::Stroke& stroke);
    DrawList* list_;
    std::vector<Rect> clips_;
};

} // namespace supercircle::picture
