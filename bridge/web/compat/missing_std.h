#pragma once
// What emscripten's libc++ 13 lacks of C++20: std::bit_cast, and from_chars and to_chars of double. Included before
// every source of the web build, so that the core stays plain C++20. A library that has them keeps its own.

#include <bit>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
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

/// "nan", "inf" or "infinity" in any case, with or without a minus; {first, ...} if it is none of them.
inline from_chars_result not_finite_from_chars(const char* first, const char* last, double& value) {
    const char* begin = first != last && *first == '-' ? first + 1 : first;
    for (const char* word : {"infinity", "inf", "nan"}) {
        const char* at = begin;
        while (at != last && *word != '\0' && (*at | 0x20) == *word)
            ++at, ++word;
        if (*word != '\0')
            continue;
        value = word[-1] == 'n' ? __builtin_nan("") : __builtin_inf();
        value = begin != first ? -value : value;
        return {at, errc()};
    }
    return {first, errc::invalid_argument};
}

/// Decimal numbers as in JSON, and those that are not finite; musl's strtod rounds correctly. Out of range:
/// errc::result_out_of_range, `value` stays.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    if (const auto read = not_finite_from_chars(first, last, value); read.ptr != first)
        return read;
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

/// A notation with so many digits, as printf writes it.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format format, int digits) {
    const int room = static_cast<int>(last - first);
    const char* how = format == chars_format::fixed ? "%.*f" : format == chars_format::scientific ? "%.*e" : "%.*g";
    const int written = snprintf(first, static_cast<size_t>(room), how, digits, value);
    if (written < 0 || written >= room) // the terminating zero needs a place, too
        return {last, errc::value_too_large};
    return {first + written, errc()};
}

/// The shortest text that is read as the same number, fixed where that is not longer than scientific.
template <class T>
to_chars_result shortest_to_chars(char* first, char* last, T value) {
    char text[64];
    int digits = 0; // behind the first
    do
        snprintf(text, sizeof text, "%.*e", digits, static_cast<double>(value));
    while (static_cast<T>(strtod(text, nullptr)) != value && ++digits < 17 && value - value == T{});
    const string scientific(text);
    const size_t e = scientific.find('e');
    if (e == string::npos) // not finite
        return scientific.copy(first, static_cast<size_t>(last - first)),
               to_chars_result{first + scientific.size(), errc()};
    const int decimals = digits - atoi(scientific.c_str() + e + 1);
    string fixed(400, ' ');
    fixed.resize(static_cast<size_t>(
        snprintf(fixed.data(), fixed.size(), "%.*f", decimals > 0 ? decimals : 0, static_cast<double>(value))));
    const string& shortest = fixed.size() <= scientific.size() ? fixed : scientific;
    if (shortest.size() > static_cast<size_t>(last - first))
        return {last, errc::value_too_large};
    shortest.copy(first, shortest.size());
    return {first + shortest.size(), errc()};
}
inline to_chars_result to_chars(char* first, char* last, double value) {
    return shortest_to_chars(first, last, value);
}
inline to_chars_result to_chars(char* first, char* last, float value) {
    return shortest_to_chars(first, last, value);
}

} // namespace std
#endif
