#pragma once
// The arrows between folders as a checker over #include lines (docs/architecture.md). A linker cannot check them: the
// libraries' headers lie in the system's include path, where every file can reach them.

#include <string>
#include <vector>

namespace supercircle::architecture {

struct Offence {
    std::string file; ///< from the project root
    int line = 0;     ///< from 1
    std::string why;  ///< what is included and which rule forbids it
};

/// Checks the #include lines of one file. `file` is its path from the project root; it decides which rules hold.
std::vector<Offence> checkIncludes(const std::string& file, const std::vector<std::string>& lines);

} // namespace supercircle::architecture
