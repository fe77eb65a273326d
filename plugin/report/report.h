#pragma once
// Pictures of a run.

#include <string>

#include "plugin/record/recording.h"

namespace supercircle::report {

/// Writes report.html and, for those without a browser, force.png, energy.png, before.png, peak.png, after.png
/// (start.png and end.png where the run names no key frames) and overview.png into `directory`, all of them or none.
/// Pictures without data are left out, and those of an earlier run in the same place are removed.
/// @return empty, or why not. Never throws.
[[nodiscard]] std::string writeReport(const record::Recording& recording, const std::string& directory) noexcept;

} // namespace supercircle::report
