#pragma once
// A recording as files: summary.json, series.csv, trajectory.json. The same recording gives the same bytes.

#include <string>

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/recording.h"
#include "supercircle/support/result.h"

namespace supercircle::record {

/// One flat object: the summary in its order, then `parameters`, `timing`, `energy` and `cycles` (left out when empty).
/// Numbers are the shortest text that reads back exactly; what is not finite is `null`. An error if a key appears
/// twice.
[[nodiscard]] Result<std::string> summaryJson(const Recording& recording);

/// Everything needed to play the motion again: shells, outlines, phases, frames, events, key frames, scales. Times,
/// machine values and events are exact; poses, curvatures and contact forces are rounded to float (7 digits).
[[nodiscard]] std::string trajectoryJson(const Recording& recording);

/// The three files by name and content, to be written together with others (see writeAtomically()). Never throws.
[[nodiscard]] Result<std::vector<NamedText>> recordingFiles(const Recording& recording) noexcept;

/// Writes the three files into `directory` (made if missing), all of them or none, see writeAtomically().
/// Never throws.
[[nodiscard]] Status writeFiles(const Recording& recording, const std::string& directory) noexcept;

} // namespace supercircle::record
