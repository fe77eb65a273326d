#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace supercircle::record {

namespace {

std::string text(double value, std::chars_format format, int precision) {
    std::array<char, 400> buffer{}; // the largest double has 309 digits ahead of its point
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision);
    return error == std::errc{} ? std::string(buffer.data(), end) : std::string("?");
}

} // namespace

std::string rounded(double value, int digits) {
    return text(value, std::chars_format::general, digits);
}

std::string fixed(double value, int decimals) {
    return text(value, std::chars_format::fixed, decimals);
}

std::string duration(double seconds) {
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

} // namespace supercircle::record
