#pragma once
// The subcommand `diagnose` on ensembles of stacks (schema stack-ensembles/1).

#include "plugin/cli/subcommands.h"

#include <optional>

namespace supercircle::cli {

/// The exit code, or nothing if the file has another schema.
[[nodiscard]] std::optional<int> diagnoseEnsembleFile(const DiagnoseArguments& arguments);

} // namespace supercircle::cli
