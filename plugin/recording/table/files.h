#pragma once
// Files that are either the old ones or the complete new ones, whenever the machine stops.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supercircle/support/result.h"

namespace supercircle::record {

/// Name inside the directory and content.
using NamedText = std::pair<std::string, std::string>;

/// Writes all files into `directory` (made if missing): each to a temporary name beside its place, flushed to the disk,
/// and only when all of them are there are they renamed into place. On failure nothing old is touched and the temporary
/// files are gone.
/// The error names what could not be written and why. Never throws.
[[nodiscard]] Status writeAtomically(const std::string& directory, const std::vector<NamedText>& files) noexcept;

/// Whole content of a regular file of at most `mostBytes`, or why it cannot be read.
[[nodiscard]] Result<std::string> readText(const std::string& path,
                                           std::uintmax_t mostBytes = std::uintmax_t{512} << 20);

} // namespace supercircle::record
