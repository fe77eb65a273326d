#pragma once
// Japanese text of spreadsheets and machines.

#include <string>
#include <string_view>

namespace supercircle::record {

/// UTF-8 of a text in Shift-JIS (code page 932), by the system's iconv; U+FFFD for bytes that are no character.
/// @return empty for a text that is not, if this system cannot convert
std::string fromShiftJis(std::string_view bytes);

} // namespace supercircle::record
