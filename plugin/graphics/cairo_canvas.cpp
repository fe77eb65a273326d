#include "plugin/graphics/cairo_canvas.h"

#include <cairo.h>
#include <cmath>
#include <numbers>

namespace supercircle::graphics {

namespace {

void setColour(cairo_t* context, const Colour& colour) {
    cairo_set_source_rgba(context, colour.r, colour.g, colour.b, colour.a);
}

cairo_status_t appendBytes(void* out, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

} // namespace

CairoCanvas::CairoCanvas(double width, double height, double scale, Ground ground) {
    const bool white = ground == Ground::White;
    surface_ = cairo_image_surface_create(white ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32,
                                          static_cast<int>(std::lround(width * scale)),
                                          static_cast<int>(std::lround(height * scale)));
    context_ = cairo_create(surface_);
    if (white) {
        cairo_set_source_rgb(context_, 1.0, 1.0, 1.0);
        cairo_paint(context_);
    }
    cairo_scale(context_, scale, scale);
    cairo_set_line_cap(context_, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(context_, CAIRO_LINE_JOIN_ROUND);
    // Without hinting: the width of hinted glyphs depends on the pixel grid and on settings of the computer.
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(context_, options);
    cairo_font_options_destroy(options);
}

CairoCanvas::~CairoCanvas() {
    cairo_destroy(context_);
    cairo_surface_destroy(surface_);
}

void CairoCanvas::apply(const Paint& paint) {
    if (paint.fill) {
        setColour(context_, *paint.fill);
        cairo_fill_preserve(context_);
    }
    if (paint.stroke) {
        setColour(context_, paint.stroke->colour);
        cairo_set_line_width(context_, paint.stroke->width);
        cairo_set_dash(context_, paint.stroke->dash.data(), static_cast<int>(paint.stroke->dash.size()), 0.0);
        cairo_stroke_preserve(context_);
    }
    cairo_new_path(context_);
}

void CairoCanvas::path(const std::vector<Point>& points, bool closed, const Paint& paint) {
    cairo_new_path(context_);
    for (const Point& p : points)
        cairo_line_to(context_, p.x, p.y);
    if (closed)
        cairo_close_path(context_);
    apply(paint);
}

void CairoCanvas::circle(Point centre, double radius, const Paint& paint) {
    cairo_new_path(context_);
    cairo_arc(context_, centre.x, centre.y, radius, 0.0, 2.0 * std::numbers::pi);
    cairo_close_path(context_);
    apply(paint);
}

void CairoCanvas::text(Point at, std::string_view content, const TextStyle& style) {
    const std::string terminated(content);
    cairo_select_font_face(context_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_, style.size);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, terminated.c_str(), &extents);
    const double shift = style.anchor == Anchor::Start ? 0.0 : style.anchor == Anchor::Middle ? 0.5 : 1.0;
    cairo_save(context_);
    cairo_translate(context_, at.x, at.y);
    cairo_rotate(context_, style.rotation * std::numbers::pi / 180.0);
    cairo_move_to(context_, -shift * extents.x_advance, 0.0);
    setColour(context_, style.colour);
    cairo_show_text(context_, terminated.c_str());
    cairo_restore(context_);
    cairo_new_path(context_);
}

void CairoCanvas::pushClip(const Rect& area) {
    cairo_save(context_);
    cairo_rectangle(context_, area.x, area.y, area.width, area.height);
    cairo_clip(context_);
}

void CairoCanvas::popClip() {
    cairo_restore(context_);
}

CairoCanvas::Pixels CairoCanvas::pixels() const {
    cairo_surface_flush(surface_);
    return {cairo_image_surface_get_data(surface_), cairo_image_surface_get_width(surface_),
            cairo_image_surface_get_height(surface_), cairo_image_surface_get_stride(surface_)};
}

void CairoCanvas::markDirty() const {
    cairo_surface_mark_dirty(surface_);
}

Result<std::string> CairoCanvas::png() {
    std::string result;
    cairo_status_t status = cairo_status(context_); // also carries a failed surface
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_write_to_png_stream(surface_, appendBytes, &result);
    if (status != CAIRO_STATUS_SUCCESS)
        return Result<std::string>::failure(std::string("cannot draw the PNG: ") + cairo_status_to_string(status));
    return result;
}

} // namespace supercircle::graphics
