#pragma once
// Page of the subcommand `import`.

#include "plugin/recording/import/import.h"

#include <string>

namespace supercircle::cli {

/// One self-contained page: what the files say and what was understood, rows that were left out marked, every decision
/// with its runner-up, and the command that repeats the import with every decision stated.
/// @param command the command without the decisions: "supercircle import FILE --out DIR"
std::string importPage(const importing::Imported& imported, const std::string& command);

} // namespace supercircle::cli
