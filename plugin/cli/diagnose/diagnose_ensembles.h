#pragma once
// The verb `diagnose` on ensembles of stacks (schema stack-ensembles/1).

#include "plugin/cli/verbs.h"

#include <optional>

namespace supercircle::cli {

/// The exit code, or nothing if the file does not call itself one of ensembles.
std::optional<int> diagnoseEnsembleFile(const DiagnoseArguments& arguments);

} // namespace supercircle::cli
