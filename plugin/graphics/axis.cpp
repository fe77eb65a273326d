#include "plugin/graphics/axis.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "plugin/graphics/svg_canvas.h"

namespace supercircle::graphics {

namespace {

std::string withMinus(std::string text) {
    std::string out;
    for (const char c : text)
        out += c == '-' ? std::string("\u2212") : std::string(1, c);
    return out;
}

std::string superscript(const std::string& digits) {
    static const std::array<const char*, 10> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string out;
    for (const char c : digits)
        if (c >= '0' && c <= '9')
            out += raised[static_cast<std::size_t>(c - '0')];
        else if (c == '-')
            out += "⁻";
    return out;
}

} // namespace

std::string Ticks::label(double value) const {
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 12);
    std::string text;
    appendFixed(text, std::abs(value) < 1e-9 * step ? 0.0 : value, decimals);
    // Equal numbers of decimals on one axis.
    if (decimals > 0) {
        const std::size_t point = text.find('.');
        const std::size_t have = point == std::string::npos ? 0 : text.size() - point - 1;
        if (point == std::string::npos)
            text += '.';
        text.append(static_cast<std::size_t>(decimals) - have, '0');
    }
    return withMinus(text);
}

Ticks niceTicks(const AxisRange& range, int most) {
    Ticks ticks;
    const double span = range.span();
    if (!std::isfinite(span) || span <= 0.0 || !(span > 1e-12 * std::max(std::abs(range.lo), std::abs(range.hi))))
        return ticks;
    const double raw = span / std::max(most, 2);
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    const auto valuesAt = [&](double step) {
        std::vector<double> values;
        const double last = std::floor(range.hi / step + 1e-9);
        for (double i = std::ceil(range.lo / step - 1e-9); i <= last; i += 1.0)
            values.push_back(i * step);
        return values;
    };
    for (const double multiple : {1.0, 2.0, 5.0, 10.0, 20.0}) {
        std::vector<double> values = valuesAt(multiple * power);
        if (values.size() < 2 && ticks.values.size() >= 2)
            break;
        ticks = {multiple * power, std::move(values)};
        if (ticks.values.size() <= static_cast<std::size_t>(std::max(most, 2)))
            break;
    }
    return ticks;
}

AxisRange padded(AxisRange range, double pad) {
    if (!std::isfinite(range.lo) || !std::isfinite(range.hi) || range.lo > range.hi)
        return {0.0, 1.0};
    double extra = pad * range.span();
    const double size = std::max(std::abs(range.lo), std::abs(range.hi));
    if (range.span() <= 1e-9 * size || size == 0.0)
        extra = size == 0.0 ? 1.0 : 0.1 * size;
    return {range.lo - extra, range.hi + extra};
}

AxisRange rangeOf(const std::vector<const std::vector<double>*>& columns) {
    AxisRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const std::vector<double>* c : columns)
        for (const double v : *c)
            if (std::isfinite(v))
                range = {std::min(range.lo, v), std::max(range.hi, v)};
    return padded(range, 0.05);
}

DisplayUnit readableUnit(double largest, const std::string& unit) {
    const double size = std::abs(largest);
    if (!std::isfinite(size) || size == 0.0)
        return {1.0, unit};
    if (size < 0.9e-12)
        return {1e15, "f" + unit};
    if (size < 0.9e-9)
        return {1e12, "p" + unit};
    if (size < 0.9e-6)
        return {1e9, "n" + unit};
    if (size < 0.9e-3)
        return {1e6, "µ" + unit};
    if (size < 0.9)
        return {1e3, "m" + unit};
    if (size >= 1e4)
        return {1e-3, "k" + unit};
    return {1.0, unit};
}

std::string significant(double value, int digits) {
    if (std::isnan(value))
        return "–";
    if (std::isinf(value))
        return value > 0.0 ? "∞" : "\u2212∞";
    if (value == 0.0)
        return "0";
    std::array<char, 64> buffer{};
    const auto scientific =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific, digits - 1);
    const std::string text(buffer.data(), scientific.ptr);
    const std::size_t e = text.find('e');
    int exponent = 0; // after rounding: 9.9996 is 10.00 with four digits
    const char* start = text.data() + e + 1;
    std::from_chars(*start == '+' ? start + 1 : start, text.data() + text.size(), exponent);
    if (exponent >= -3 && exponent < 6) {
        const auto fixed = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed,
                                         std::max(0, digits - 1 - exponent));
        return withMinus(std::string(buffer.data(), fixed.ptr));
    }
    return withMinus(text.substr(0, e)) + " × 10" + superscript(std::to_string(exponent));
}

std::string trimmed(double value, int digits) {
    std::string text = significant(value, digits);
    const std::size_t point = text.find('.');
    if (point == std::string::npos)
        return text;
    const std::size_t end = std::min(text.find(' '), text.size()); // of the digits, before a power of ten
    std::size_t keep = end;
    while (keep > point + 1 && text[keep - 1] == '0')
        --keep;
    if (keep == point + 1)
        keep = point;
    return text.substr(0, keep) + text.substr(end);
}

std::string readableDuration(double seconds) {
    const long long s = std::llround(std::min(std::max(0.0, seconds), 1e9));
    char text[64];
    if (s < 100)
        std::snprintf(text, sizeof text, "%lld s", s);
    else if (s < 3600)
        std::snprintf(text, sizeof text, "%lld min %02lld s", s / 60, s % 60);
    else
        std::snprintf(text, sizeof text, "%lld h %02lld min", s / 3600, s % 3600 / 60);
    return text;
}

} // namespace supercircle::graphics
