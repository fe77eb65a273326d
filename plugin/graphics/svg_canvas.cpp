#include "plugin/graphics/svg_canvas.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace supercircle::report {

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

SvgCanvas::SvgCanvas(double width, double height, std::string id, std::string label) : name(std::move(id)) {
    body = "<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"" + name + "\" role=\"img\" aria-label=\"" + escaped(label);
    body += "\" viewBox=\"0 0 ";
    appendFixed(body, width);
    body += ' ';
    appendFixed(body, height);
    body += "\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
}

void SvgCanvas::paintAttributes(const Paint& paint) {
    body += " fill=\"" + (paint.fill ? hexText(*paint.fill) : std::string("none")) + '"';
    if (paint.fill && paint.fill->a < 1.0)
        attribute(body, "fill-opacity", paint.fill->a);
    if (!paint.stroke)
        return;
    body += " stroke=\"" + hexText(paint.stroke->colour) + '"';
    if (paint.stroke->colour.a < 1.0)
        attribute(body, "stroke-opacity", paint.stroke->colour.a);
    attribute(body, "stroke-width", paint.stroke->width);
    if (!paint.stroke->dash.empty()) {
        body += " stroke-dasharray=\"";
        for (const double length : paint.stroke->dash) {
            appendFixed(body, length);
            body += ' ';
        }
        body.back() = '"';
    }
}

void SvgCanvas::path(const std::vector<Point>& points, bool closed, const Paint& paint) {
    if (points.empty())
        return;
    body += "<path d=\"M";
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0)
            body += i == 1 ? 'L' : ' ';
        appendFixed(body, points[i].x);
        body += ' ';
        appendFixed(body, points[i].y);
    }
    body += closed ? "Z\"" : "\"";
    paintAttributes(paint);
    body += "/>\n";
}

void SvgCanvas::circle(Point centre, double radius, const Paint& paint) {
    body += "<circle";
    attribute(body, "cx", centre.x);
    attribute(body, "cy", centre.y);
    attribute(body, "r", radius);
    paintAttributes(paint);
    body += "/>\n";
}

void SvgCanvas::text(Point at, std::string_view content, const TextStyle& style) {
    body += "<text";
    attribute(body, "x", at.x);
    attribute(body, "y", at.y);
    attribute(body, "font-size", style.size);
    body += " fill=\"" + hexText(style.colour) + '"';
    if (style.anchor != Anchor::Start)
        body += style.anchor == Anchor::Middle ? " text-anchor=\"middle\"" : " text-anchor=\"end\"";
    if (style.bold)
        body += " font-weight=\"600\"";
    if (style.turn != 0.0) {
        body += " transform=\"rotate(";
        appendFixed(body, style.turn);
        body += ' ';
        appendFixed(body, at.x);
        body += ' ';
        appendFixed(body, at.y);
        body += ")\"";
    }
    body += '>';
    body += escaped(content);
    body += "</text>\n";
}

void SvgCanvas::pushClip(const Rect& area) {
    const std::string id = name + "-clip" + std::to_string(clips++);
    body += "<clipPath id=\"" + id + "\"><rect";
    attribute(body, "x", area.x);
    attribute(body, "y", area.y);
    attribute(body, "width", area.width);
    attribute(body, "height", area.height);
    body += "/></clipPath><g clip-path=\"url(#" + id + ")\">\n";
}

void SvgCanvas::popClip() {
    body += "</g>\n";
}

std::string SvgCanvas::finish() {
    return std::move(body += "</svg>\n");
}

} // namespace supercircle::report
