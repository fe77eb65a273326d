#pragma once

#include <string>

#include "plugin/graphics/canvas.h"
#include "supercircle/support/result.h"

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace supercircle::graphics {

/// Draws into pixels on white.
class CairoCanvas final : public Canvas {
public:
    enum class Ground { White, Transparent };
    /// Logical size in pixels; the picture has `scale` times as many pixels in either direction.
    CairoCanvas(double width, double height, double scale, Ground ground = Ground::White);
    ~CairoCanvas() override;

    void path(const std::vector<Point>& points, bool closed, const Paint& paint) override;
    void circle(Point centre, double radius, const Paint& paint) override;
    void text(Point at, std::string_view text, const TextStyle& style) override;
    void pushClip(const Rect& area) override;
    void popClip() override;

    /// The picture as the content of a PNG file, or Cairo's error.
    [[nodiscard]] Result<std::string> png();

    /// The finished picture in memory: rows of `stride` bytes, four bytes a pixel, 0xAARRGGBB in native order, with
    /// colours multiplied by A; on white A is anything. Valid until the next drawing call; null if Cairo failed.
    struct Pixels {
        unsigned char* data = nullptr;
        int width = 0, height = 0, stride = 0;
    };
    [[nodiscard]] Pixels pixels() const;
    /// To be called after drawing into pixels() directly.
    void markDirty() const;
    /// For drawing that Canvas has no call for.
    [[nodiscard]] cairo_t* context() const { return context_; }

private:
    void apply(const Paint& paint);
    cairo_surface_t* surface_ = nullptr;
    cairo_t* context_ = nullptr;
};

} // namespace supercircle::graphics
