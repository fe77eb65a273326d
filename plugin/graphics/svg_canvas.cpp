#include "plugin/graphics/svg_canvas.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace supercircle::graphics {

namespace {

void attribute(std::string& out, std::string_view name, double value) {
    ((out += ' ') += name) += "=\"";
    appendFixed(out, value);
    out += '"';
}

} // namespace

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

void appendFixed(std::string& out, double value, int decimals) {
    if (!std::isfinite(value))
        value = 0.0;
    std::array<char, 400> buffer{};
    const auto end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals).ptr;
    std::string_view digits(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
    if (digits.find('.') != std::string_view::npos) {
        digits = digits.substr(0, digits.find_last_not_of('0') + 1);
        if (digits.back() == '.')
            digits.remove_suffix(1);
    }
    out += digits == "-0" ? "0" : digits;
}

SvgCanvas::SvgCanvas(double width, double height, std::string id, std::string label) : name_(std::move(id)) {
    body_ =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"" + name_ + "\" role=\"img\" aria-label=\"" + escaped(label);
    body_ += "\" viewBox=\"0 0 ";
    appendFixed(body_, width);
    body_ += ' ';
    appendFixed(body_, height);
    body_ += "\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
}

void SvgCanvas::paintAttributes(const Paint& paint) {
    body_ += " fill=\"" + (paint.fill ? hexText(*paint.fill) : std::string("none")) + '"';
    if (paint.fill && paint.fill->a < 1.0)
        attribute(body_, "fill-opacity", paint.fill->a);
    if (!paint.stroke)
        return;
    body_ += " stroke=\"" + hexText(paint.stroke->colour) + '"';
    if (paint.stroke->colour.a < 1.0)
        attribute(body_, "stroke-opacity", paint.stroke->colour.a);
    attribute(body_, "stroke-width", paint.stroke->width);
    if (!paint.stroke->dash.empty()) {
        body_ += " stroke-dasharray=\"";
        for (const double length : paint.stroke->dash) {
            appendFixed(body_, length);
            body_ += ' ';
        }
        body_.back() = '"';
    }
}

void SvgCanvas::path(const std::vector<Point>& points, bool closed, const Paint& paint) {
    if (points.empty())
        return;
    body_ += "<path d=\"M";
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0)
            body_ += i == 1 ? 'L' : ' ';
        appendFixed(body_, points[i].x);
        body_ += ' ';
        appendFixed(body_, points[i].y);
    }
    body_ += closed ? "Z\"" : "\"";
    paintAttributes(paint);
    body_ += "/>\n";
}

void SvgCanvas::circle(Point centre, double radius, const Paint& paint) {
    body_ += "<circle";
    attribute(body_, "cx", centre.x);
    attribute(body_, "cy", centre.y);
    attribute(body_, "r", radius);
    paintAttributes(paint);
    body_ += "/>\n";
}

void SvgCanvas::text(Point at, std::string_view content, const TextStyle& style) {
    body_ += "<text";
    attribute(body_, "x", at.x);
    attribute(body_, "y", at.y);
    attribute(body_, "font-size", style.size);
    body_ += " fill=\"" + hexText(style.colour) + '"';
    if (style.anchor != Anchor::Start)
        body_ += style.anchor == Anchor::Middle ? " text-anchor=\"middle\"" : " text-anchor=\"end\"";
    if (style.bold)
        body_ += " font-weight=\"600\"";
    if (style.rotation != 0.0) {
        body_ += " transform=\"rotate(";
        appendFixed(body_, style.rotation);
        body_ += ' ';
        appendFixed(body_, at.x);
        body_ += ' ';
        appendFixed(body_, at.y);
        body_ += ")\"";
    }
    body_ += '>';
    body_ += escaped(content);
    body_ += "</text>\n";
}

void SvgCanvas::pushClip(const Rect& area) {
    const std::string id = name_ + "-clip" + std::to_string(clips_++);
    body_ += "<clipPath id=\"" + id + "\"><rect";
    attribute(body_, "x", area.x);
    attribute(body_, "y", area.y);
    attribute(body_, "width", area.width);
    attribute(body_, "height", area.height);
    body_ += "/></clipPath><g clip-path=\"url(#" + id + ")\">\n";
}

void SvgCanvas::popClip() {
    body_ += "</g>\n";
}

std::string SvgCanvas::finish() {
    return std::move(body_ += "</svg>\n");
}

} // namespace supercircle::graphics
