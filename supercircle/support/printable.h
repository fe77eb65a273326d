#pragma once
// Text from a file for a terminal: what a file says must not move the cursor or change colours.

#include <string>
#include <string_view>

namespace supercircle {

/// Control characters as \xNN, those of Unicode too; tabs and ends of lines stay.
inline std::string printable(std::string_view text) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
        const bool wide = c == 0xC2 && next >= 0x80 && next < 0xA0; // U+0080 to U+009F
        if ((c >= 0x20 && c != 0x7F && !wide) || c == '\n' || c == '\t') {
            out += text[i];
            continue;
        }
        const unsigned char shown = wide ? next : c;
        out += "\\x";
        out += kDigits[shown >> 4];
        out += kDigits[shown & 15];
        i += wide ? 1 : 0;
    }
    return out;
}

} // namespace supercircle
