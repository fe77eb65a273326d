#pragma once
// Which program this is: results are bitwise identical for the same program only.

#include <string>
#include <string_view>

namespace supercircle::cli {

/// Version and checksum of this program.
std::string buildName();
/// FNV-1a of a text in hexadecimal digits.
std::string checksum(std::string_view text);

} // namespace supercircle::cli
