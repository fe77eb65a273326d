#include "plugin/recording/table/rounded.h"

#include <array>
#include <charconv>

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

} // namespace supercircle::record
