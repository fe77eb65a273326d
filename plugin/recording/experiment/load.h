#pragma once
// Loads experiment.json (schema "rod-recordings/1", experiment.schema.json) and its CSV files. Everything is checked,
// and every problem has file:line:column, JSON pointer, what is wrong, what was expected, nearest known name.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/problem.h"
#include "supercircle/support/result.h"

#include <string>
#include <vector>

namespace supercircle::experiment {

inline constexpr const char* schemaName = "rod-recordings/1";

/// Whether a description may name files outside of its folder.
enum class Outside { Refused, Allowed };

/// Loads description and runs. All problems are appended to `problems`; the call fails, with the text of the errors,
/// exactly if one is an error.
Result<Experiment> load(const std::string& path, std::vector<scene::Problem>& problems,
                        Outside outside = Outside::Refused);

/// The same without the list.
Result<Experiment> load(const std::string& path);

/// Loads the description alone from a text; `file` is its name in messages.
Result<Experiment> loadText(const std::string& text, const std::string& file, std::vector<scene::Problem>& problems);

/// Reports files that the description names outside of its folder.
void refuseOutside(const Experiment& experiment, std::vector<scene::Problem>& problems);

/// Reads the CSV files of all runs beside experiment.file.
void readRuns(Experiment& experiment, std::vector<scene::Problem>& problems);

} // namespace supercircle::experiment
