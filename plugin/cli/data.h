#pragma once
// Files that come with the program.

#include <string>

namespace supercircle::cli {

/// Folder of the project's scenes: of the installation this program belongs to, else of the source tree it was built
/// in.
std::string scenesFolder();
/// Folder of the solved references, found likewise.
std::string referenceFolder();

} // namespace supercircle::cli
