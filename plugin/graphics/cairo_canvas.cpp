#include "plugin/graphics/cairo_canvas.h"

#include <cairo.h>
#include <cmath>
#include <numbers>

namespace supercircle::report {

namespace {

void setColour(cairo_t* context, const Colour& colour) {
    cairo_set_source_rgba(context, colour.r, colour.g, colour.b, colour.a);
}

cairo_status_t appendBytes(void* out, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

} // namespace

CairoCanvas::CairoCanvas(double width, double height, double scale) {
    surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(width * scale)),
                                         static_cast<int>(std::lround(height * scale)));
    context = cairo_create(surface);
    cairo_set_source_rgb(context, 1.0, 1.0, 1.0);
    cairo_paint(context);
    cairo_scale(context, scale, scale);
    cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    // Hinted glyphs would depend on the pixel grid and be as wide as the machine's settings say.
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(context, options);
    cairo_font_options_destroy(options);
}

CairoCanvas::~CairoCanvas() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
}

void CairoCanvas::apply(const Paint& paint) {
    if (paint.fill) {
        setColour(context, *paint.fill);
        cairo_fill_preserve(context);
    }
    if (paint.stroke) {
        setColour(context, paint.stroke->colour);
        cairo_set_line_width(context, paint.stroke->width);
        cairo_set_dash(context, paint.stroke->dash.data(), static_cast<int>(paint.stroke->dash.size()), 0.0);
        cairo_stroke_preserve(context);
    }
    cairo_new_path(context);
}

void CairoCanvas::path(const std::vector<Point>& points, bool closed, const Paint& paint) {
    cairo_new_path(context);
    for (const Point& p : points)
        cairo_line_to(context, p.x, p.y);
    if (closed)
        cairo_close_path(context);
    apply(paint);
}

void CairoCanvas::circle(Point centre, double radius, const Paint& paint) {
    cairo_new_path(context);
    cairo_arc(context, centre.x, centre.y, radius, 0.0, 2.0 * std::numbers::pi);
    cairo_close_path(context);
    apply(paint);
}

void CairoCanvas::text(Point at, std::string_view content, const TextStyle& style) {
    const std::string terminated(content);
    cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context, style.size);
    cairo_text_extents_t extents;
    cairo_text_extents(context, terminated.c_str(), &extents);
    const double shift = style.anchor == Anchor::Start ? 0.0 : style.anchor == Anchor::Middle ? 0.5 : 1.0;
    cairo_save(context);
    cairo_translate(context, at.x, at.y);
    cairo_rotate(context, style.turn * std::numbers::pi / 180.0);
    cairo_move_to(context, -shift * extents.x_advance, 0.0);
    setColour(context, style.colour);
    cairo_show_text(context, terminated.c_str());
    cairo_restore(context);
    cairo_new_path(context);
}

void CairoCanvas::pushClip(const Rect& area) {
    cairo_save(context);
    cairo_rectangle(context, area.x, area.y, area.width, area.height);
    cairo_clip(context);
}

void CairoCanvas::popClip() {
    cairo_restore(context);
}

CairoCanvas::Pixels CairoCanvas::pixels() const {
    cairo_surface_flush(surface);
    return {cairo_image_surface_get_data(surface), cairo_image_surface_get_width(surface),
            cairo_image_surface_get_height(surface), cairo_image_surface_get_stride(surface)};
}

void CairoCanvas::touched() const {
    cairo_surface_mark_dirty(surface);
}

record::Result<std::string> CairoCanvas::png() {
    record::Result<std::string> result;
    cairo_status_t status = cairo_status(context); // also carries a failed surface
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_write_to_png_stream(surface, appendBytes, &result.value);
    if (status != CAIRO_STATUS_SUCCESS)
        return record::Result<std::string>::fail(std::string("cannot draw the PNG: ") + cairo_status_to_string(status));
    return result;
}

} // namespace supercircle::report
