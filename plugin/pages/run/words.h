#pragma once
// Keys of the summary as words and units for people.

#include <string>

#include "plugin/recording/table/recording.h"

namespace supercircle::report {

/// "work_in_J" -> "work in", "peak_force_R2_over_B" -> "peak force": the key without its unit, in words.
[[nodiscard]] std::string plainName(const std::string& key);

/// Unit that a key's suffix means ("N", "B/R²", "m/s", "R", ...); empty if it has none.
[[nodiscard]] std::string unitOf(const std::string& key);

/// Unit of a scene parameter by its customary name; empty for pure numbers and unknown ones.
[[nodiscard]] std::string parameterUnit(const std::string& name);

/// Any value for people.
[[nodiscard]] std::string shown(const record::Value& value);

/// Number under a key of the summary, NaN if there is none.
[[nodiscard]] double summaryNumber(const record::Recording& recording, const std::string& key);

/// One plain sentence that says what happened.
[[nodiscard]] std::string sentence(const record::Recording& recording);

} // namespace supercircle::report
