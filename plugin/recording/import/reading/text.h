#pragma once
// Bytes of an export as lines of UTF-8, and cells of a line.

#include "supercircle/support/result.h"

#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// A file as text.
struct Text {
    std::string utf8;     ///< without byte order mark
    std::string encoding; ///< "UTF-8", "UTF-8 with byte order mark", "UTF-16 (little-endian)", "Windows-1252"
    std::string lineEnds; ///< "LF", "CRLF", "CR", "mixed"
};

/// Recognises the encoding: byte order marks, UTF-16 without one (zero bytes), valid UTF-8, else Windows-1252 (which
/// contains Latin-1).
/// @return the text, or why it is none (a spreadsheet, a zip, an image)
Result<Text> decode(std::string bytes);

/// Lines without their ends; "\n", "\r\n" and "\r" end one.
std::vector<std::string_view> linesOf(std::string_view text);

/// Without blanks at either end (space, tab, no-break spaces).
std::string_view trimmed(std::string_view text);

/// Cells of a line. ' ' separates at runs of blanks; other separators at each occurrence outside double quotes. Blanks
/// around cells and quotes are taken off; doubled quotes inside quotes are one. Exports break the rules that
/// record::parseCsv() insists on, so this reader refuses nothing.
std::vector<std::string> cellsOf(std::string_view line, char separator);

/// Cells of a line without quotes, as views of it; ' ' separates at runs of blanks.
void splitCells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Column, from 1, at which a cell (from 0) of a line begins; 1 if there is no such cell.
std::size_t columnOf(std::string_view line, char separator, std::size_t cell);

/// Lower case without accents, for comparing words: "Prüf-Kraft" gives "pruf-kraft".
std::string folded(std::string_view utf8);

} // namespace supercircle::importing
