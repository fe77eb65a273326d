#pragma once
// Encodings of one or two bytes a character: which one a text has, and its characters.

#include <optional>
#include <string>
#include <string_view>

namespace supercircle::importing {

enum class Encoding { Windows1252, Windows1251, ShiftJis };

/// "Windows-1252", "Windows-1251", "Shift-JIS"
const char* name(Encoding encoding);
/// "windows-1252", "windows-1251", "shift-jis": values of --encoding
const char* optionName(Encoding encoding);
/// By its value of --encoding.
std::optional<Encoding> encodingOf(std::string_view optionName);

/// The most probable encoding of a text that is not UTF-8.
struct EncodingGuess {
    Encoding best = Encoding::Windows1252, second = Encoding::Windows1251;
    double odds = 0.0; ///< of the best against the second
};

/// Weighs what each encoding makes of the bytes beyond ASCII: whether they are characters, words of one script, and
/// frequent ones. Without evidence it is Windows-1252, which contains Latin-1, ten times as probable as the others.
EncodingGuess guessEncoding(std::string_view bytes);

/// UTF-8; U+FFFD for bytes that are no character.
/// @return the text; empty for a text that is not, if this system cannot convert
std::string toUtf8(std::string_view bytes, Encoding encoding);

/// Appends a character.
void appendUtf8(std::string& out, unsigned long character);

} // namespace supercircle::importing
