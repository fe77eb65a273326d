#pragma once
// What emscripten's libc++ 13 lacks of C++20: std::bit_cast, and from_chars and to_chars of double. Included before
// every source of the web build, so that the core stays plain C++20. A library that has them keeps its own.

#include <bit>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>

#if !defined(__cpp_lib_bit_cast)
namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}

} // namespace std
#endif

#if !defined(__cpp_lib_to_chars)
namespace std {

/// Decimal numbers as in JSON; musl's strtod rounds correctly. Out of range: errc::result_out_of_range, `value` stays.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    const char* end = first;
    while (end != last &&
           (('0' <= *end && *end <= '9') || *end == '-' || *end == '+' || *end == '.' || *end == 'e' || *end == 'E'))
        ++end;
    if (first == end || *first == '+')
        return {first, errc::invalid_argument};
    const string text(first, end);
    char* read = nullptr;
    const double number = strtod(text.c_str(), &read);
    if (read == text.c_str())
        return {first, errc::invalid_argument};
    const char* stop = first + (read - text.c_str());
    if (number - number != 0.0 || (number == 0.0 && text.find_first_of("123456789") < text.find_first_of("eE")))
        return {stop, errc::result_out_of_range};
    value = number;
    return {stop, errc()};
}

/// Fixed notation only.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format, int decimals) {
    const int room = static_cast<int>(last - first);
    const int written = snprintf(first, static_cast<size_t>(room), "%.*f", decimals, value);
    if (written < 0 || written >= room) // the terminating zero needs a place, too
        return {last, errc::value_too_large};
    return {first + written, errc()};
}

} // namespace std
#endif
