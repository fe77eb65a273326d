#pragma once
// Report of a run: page and pictures.

#include <string>
#include <vector>

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// report.html and its pictures by name and content, drawn but not written. Never throws.
[[nodiscard]] Result<std::vector<record::NamedText>> reportFiles(const record::Recording& recording) noexcept;

/// Removes from `directory` the files of an earlier report that `files` does not replace, so that no old picture stays
/// beside a new page.
/// @return empty, or what could not be removed. Never throws.
[[nodiscard]] std::string removeOldReport(const std::string& directory,
                                          const std::vector<record::NamedText>& files) noexcept;

/// Writes report.html and, for those without a browser, force.png, energy.png, before.png, peak.png, after.png
/// (start.png and end.png where the run names no key frames) and overview.png into `directory`, all of them or none.
/// Pictures without data are left out, and those of an earlier run in the same place are removed.
/// @return empty, or why not. Never throws.
[[nodiscard]] std::string writeReport(const record::Recording& recording, const std::string& directory) noexcept;

} // namespace supercircle::pages
