#pragma once
// From experiment.json (schema "rod-recordings/1", experiment.schema.json) and its CSV files to plain data, with
// everything checked and every problem placed: file:line:column, JSON pointer, what is wrong, what was expected,
// nearest known name.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/problem.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::experiment {

inline constexpr const char* schemaName = "rod-recordings/1";

/// Loads description and runs. All problems are appended to `problems`; the result is empty exactly if one of them is
/// an error. Notes may accompany a good experiment (keys without meaning here, words not understood).
std::optional<Experiment> load(const std::string& path, std::vector<scene::Problem>& problems);

/// The same with all errors in one text, a line each; notes are left out.
Result<Experiment> load(const std::string& path);

/// The description alone, from a text; `file` is what messages call it. The runs have no readings.
std::optional<Experiment> loadText(const std::string& text, const std::string& file,
                                   std::vector<scene::Problem>& problems);

/// Reads the CSV files of all runs, which stand beside experiment.file.
void readRuns(Experiment& experiment, std::vector<scene::Problem>& problems);

} // namespace supercircle::experiment
