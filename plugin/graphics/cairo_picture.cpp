#include "plugin/graphics/cairo_picture.h"

#include <algorithm>
#include <cairo.h>
#include <cmath>
#include <cstring>
#include <numbers>

namespace supercircle::graphics {

namespace {

using picture::Item;
using picture::Operation;

constexpr int kGlowStops = 8; ///< as canvas.js has them

class Drawing {
public:
    explicit Drawing(CairoCanvas& canvas) : canvas_(canvas), c_(canvas.context()) {}

    void operator()(const Item& item) {
        n_ = item.numbers;
        switch (item.operation) {
        case Operation::Polygon:
            return polygon();
        case Operation::Band:
            return band();
        case Operation::Disc:
            return disc();
        case Operation::Glow:
            return glow();
        case Operation::Text:
            return text(item.text);
        case Operation::Clip:
            cairo_reset_clip(c_);
            cairo_rectangle(c_, at(0), at(1), at(2), at(3));
            return cairo_clip(c_);
        }
    }

private:
    [[nodiscard]] double at(std::size_t i) const { return static_cast<double>(n_[i]); }
    void source(std::size_t colour, double alpha) {
        const Colour k = picture::unpacked(n_[colour]);
        cairo_set_source_rgba(c_, k.r, k.g, k.b, alpha);
    }
    void polygon() {
        source(0, at(1));
        for (std::size_t i = picture::kPolygonHead; i + 1 < n_.size(); i += picture::kPolygonStep)
            cairo_line_to(c_, at(i), at(i + 1));
        cairo_close_path(c_);
        cairo_fill(c_);
    }
    /// Pieces of one colour and width are one stroke.
    void band() {
        const std::size_t vertices = (n_.size() - picture::kBandHead) / picture::kBandStep;
        const std::size_t pieces = n_[1] != 0.0F ? vertices : vertices - 1;
        const auto place = [&](std::size_t i) { return picture::kBandHead + picture::kBandStep * (i % vertices); };
        for (std::size_t i = 0; i < pieces;) {
            const std::size_t begin = i, a = place(i);
            source(a + 3, at(0));
            if (n_[place(i + 1) + 2] != n_[a + 2]) {
                taper(a, place(i + 1));
                ++i;
                continue;
            }
            cairo_move_to(c_, at(a), at(a + 1));
            for (std::size_t b = a; i < pieces && n_[b + 3] == n_[a + 3] && n_[b + 2] == n_[a + 2]; ++i) {
                b = place(i + 1);
                if (n_[b + 2] != n_[a + 2])
                    break;
                cairo_line_to(c_, at(b), at(b + 1));
            }
            if (i - begin == vertices)
                cairo_close_path(c_);
            cairo_set_line_width(c_, 2.0 * at(a + 2));
            cairo_stroke(c_);
        }
    }
    /// A piece whose width changes: the hull of the discs at its ends.
    void taper(std::size_t a, std::size_t b) {
        const double dx = at(b) - at(a), dy = at(b + 1) - at(a + 1), length = std::hypot(dx, dy);
        const double p = at(a + 2), q = at(b + 2);
        if (length <= std::abs(p - q)) {
            const std::size_t larger = p > q ? a : b;
            cairo_arc(c_, at(larger), at(larger + 1), at(larger + 2), 0.0, 2.0 * std::numbers::pi);
        } else {
            const double along = std::atan2(dy, dx), side = std::acos((p - q) / length);
            cairo_arc(c_, at(a), at(a + 1), p, along + side, along - side + 2.0 * std::numbers::pi);
            cairo_arc(c_, at(b), at(b + 1), q, along - side, along + side);
        }
        cairo_close_path(c_);
        cairo_fill(c_);
    }
    void disc() {
        source(3, at(4));
        cairo_arc(c_, at(0), at(1), at(2), 0.0, 2.0 * std::numbers::pi);
        cairo_fill(c_);
    }
    void glow() {
        const Colour k = picture::unpacked(n_[3]);
        cairo_pattern_t* const light = cairo_pattern_create_radial(at(0), at(1), 0.0, at(0), at(1), at(2));
        for (int i = 0; i <= kGlowStops; ++i) {
            const double t = static_cast<double>(i) / kGlowStops, share = (1.0 - t * t) * (1.0 - t * t);
            cairo_pattern_add_color_stop_rgba(light, t, k.r, k.g, k.b, share * at(4));
        }
        cairo_set_operator(c_, CAIRO_OPERATOR_ADD);
        cairo_set_source(c_, light);
        cairo_rectangle(c_, at(0) - at(2), at(1) - at(2), 2.0 * at(2), 2.0 * at(2));
        cairo_fill(c_);
        cairo_set_operator(c_, CAIRO_OPERATOR_OVER);
        cairo_pattern_destroy(light);
    }
    void text(std::string_view what) {
        const Anchor anchor = n_[5] == 0.0F ? Anchor::Start : n_[5] == 1.0F ? Anchor::Middle : Anchor::End;
        canvas_.text({at(0), at(1)}, what, {at(2), picture::unpacked(n_[3], n_[4]), anchor, n_[6] != 0.0F, at(7)});
    }

    CairoCanvas& canvas_;
    cairo_t* c_;
    std::span<const float> n_;
};

} // namespace

void draw(CairoCanvas& canvas, const picture::DrawList& list) {
    cairo_save(canvas.context());
    Drawing drawing(canvas);
    list.each([&](const Item& item) { drawing(item); });
    cairo_restore(canvas.context());
}

void drawOver(CairoCanvas& canvas, const CairoCanvas& over) {
    cairo_t* const c = canvas.context();
    cairo_save(c);
    cairo_set_source_surface(c, cairo_get_target(over.context()), 0.0, 0.0);
    cairo_paint(c);
    cairo_restore(c);
}

TextCoverage textCoverage(std::string_view text, double size, bool bold) {
    TextCoverage out;
    const std::string terminated(text);
    CairoCanvas probe(1.0, 1.0, 1.0);
    const auto setFont = [&](cairo_t* c) {
        cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                               bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
        cairo_set_font_size(c, size);
    };
    setFont(probe.context());
    cairo_text_extents_t extents;
    cairo_text_extents(probe.context(), terminated.c_str(), &extents);
    out.advance = extents.x_advance;
    out.left = std::floor(extents.x_bearing) - 1.0;
    out.top = std::floor(extents.y_bearing) - 1.0;
    const double right = extents.x_bearing + extents.width, bottom = extents.y_bearing + extents.height;
    out.width = static_cast<int>(std::clamp(std::ceil(right) + 1.0 - out.left, 1.0, 8192.0));
    out.height = static_cast<int>(std::clamp(std::ceil(bottom) + 1.0 - out.top, 1.0, 4096.0));
    CairoCanvas canvas(out.width, out.height, 1.0, CairoCanvas::Ground::Transparent);
    canvas.text({-out.left, -out.top}, text, {size, Colour::hex(0xffffff), Anchor::Start, bold});
    const CairoCanvas::Pixels p = canvas.pixels();
    if (p.data == nullptr)
        return {};
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            std::uint32_t pixel = 0;
            std::memcpy(&pixel, p.data + static_cast<std::ptrdiff_t>(y) * p.stride + 4 * x, 4);
            out.alpha.push_back(static_cast<unsigned char>(pixel >> 24));
        }
    return out;
}

} // namespace supercircle::graphics
