#pragma once
// Labels and units of summary keys, and other texts of a report.

#include <string>

#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// "work_in_J" -> "work in", "peak_force_R2_over_B" -> "peak force": the key without its unit suffix.
[[nodiscard]] std::string keyLabel(const std::string& key);

/// Unit of a key's suffix ("N", "B/R²", "m/s", "R", ...); empty if it has none.
[[nodiscard]] std::string keyUnit(const std::string& key);

/// Unit of a scene parameter by its customary name; empty for pure numbers and unknown ones.
[[nodiscard]] std::string parameterUnit(const std::string& name);

/// A value as text.
[[nodiscard]] std::string valueText(const record::Value& value);

/// Number under a key of the summary or its timing, NaN if there is none.
[[nodiscard]] double summaryNumber(const record::Recording& recording, const std::string& key);

/// One sentence that describes the run.
[[nodiscard]] std::string summarySentence(const record::Recording& recording);

} // namespace supercircle::pages
