#pragma once
// What precompiled headers hide: a header may use a name whose own #include is missing, and every source still
// compiles.

#include <map>
#include <set>
#include <string>
#include <vector>

namespace supercircle::architecture {

/// Files of the project by path from its root, as lines.
using Files = std::map<std::string, std::vector<std::string>>;

/// Precompiled headers (plugin/cmake/Modules.cmake) that declare names which `file` uses and that neither it nor a
/// header of the project that it includes brings; each with the first such name.
std::map<std::string, std::string> hiddenIncludes(const std::string& file, const Files& files);

/// Precompiled headers whose names hiddenIncludes() knows.
std::set<std::string> headersWithKnownNames();

} // namespace supercircle::architecture
