#pragma once
// Numbers and strings as text, the same bytes on every machine and in every locale.

#include <string>
#include <string_view>
#include <vector>

namespace supercircle::record {

/// Shortest decimal text that reads back as exactly `value` (std::to_chars); "nan", "inf", "-inf" for the rest.
void appendNumber(std::string& out, double value);
void appendNumber(std::string& out, float value);

/// The same for JSON: numbers that are not finite become `null`, whole doubles keep a ".0" so that they read back as
/// doubles.
void appendJsonNumber(std::string& out, double value);

/// `text` as one argument for a POSIX shell, in single quotes.
std::string shellQuoted(const std::string& text);
/// `text` in double quotes with JSON's escapes. Bytes that are not UTF-8 become U+FFFD.
void appendJsonString(std::string& out, std::string_view text);

/// The parts of `text` between separators, as they are; one more than there are separators.
[[nodiscard]] std::vector<std::string> splitAt(std::string_view text, char separator);

/// Number from text: whole, locale-free; false if `text` is not exactly one number. "nan", "inf" and a leading '+' are
/// understood.
[[nodiscard]] bool parseNumber(std::string_view text, double& value);

} // namespace supercircle::record
