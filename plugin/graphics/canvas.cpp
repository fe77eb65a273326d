#include "plugin/graphics/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace supercircle::graphics {

std::string hexText(const Colour& colour) {
    static constexpr std::string_view digits = "0123456789abcdef";
    std::string text = "#";
    for (const double channel : {colour.r, colour.g, colour.b}) {
        const auto value = static_cast<std::size_t>(std::lround(std::clamp(channel, 0.0, 1.0) * 255.0));
        (text += digits[value >> 4]) += digits[value & 15];
    }
    return text;
}

double textWidth(std::string_view text, double size, bool bold) {
    double em = 0.0;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xC0) == 0x80)
            continue; // inside a character of several bytes
        if (std::string_view("iljI.,:;'|!()[]ft ").find(c) != std::string_view::npos)
            em += 0.37;
        else if (std::string_view("mwMW%@").find(c) != std::string_view::npos)
            em += 0.96;
        else if (c >= 'A' && c <= 'Z')
            em += 0.70;
        else
            em += 0.62;
    }
    return em * size * (bold ? 1.1 : 1.0);
}

} // namespace supercircle::graphics
