#pragma once
// Bytes of an export as lines of UTF-8, and cells of a line.

#include "plugin/recording/import/reading/encoding.h"
#include "supercircle/support/result.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// A file as text.
struct Text {
    std::string utf8;          ///< without byte order mark
    std::string encoding;      ///< "UTF-8", "UTF-8 with byte order mark", "UTF-16 (little-endian)", "Windows-1252"
    std::string otherEncoding; ///< the next most probable one; empty: it is certain
    double encodingOdds = 0.0; ///< of the encoding against the other one
    std::string lineEnds;      ///< "LF", "CRLF", "CR", "mixed"
};

/// Recognises the encoding: byte order marks, UTF-16 without one (zero bytes), valid UTF-8, else the most probable one
/// of a byte or two a character (encoding.h).
/// @param stated of texts without a mark
/// @return the text, or why it is none (a spreadsheet, a zip, an image), or which encodings are to be decided between
Result<Text> decode(std::string bytes, std::optional<Encoding> stated = {});

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
