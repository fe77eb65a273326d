#pragma once
// The programs that stand beside this one.

#include <string>
#include <vector>

namespace supercircle::cli {

/// Replaces this process by `program` of the same folder with these arguments. Returns only if that fails: prints why
/// `subcommand` cannot be carried out, and returns the exit code.
int startSibling(const std::string& subcommand, const std::string& program, const std::vector<std::string>& arguments);

} // namespace supercircle::cli
