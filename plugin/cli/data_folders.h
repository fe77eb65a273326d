#pragma once
// Folders of data files that come with the program.

#include <string>

namespace supercircle::cli {

/// Folder of the project's scenes: of the installation this program belongs to, else of the source tree it was built
/// in.
std::string scenesFolder();
/// Folder of the solved references, found in the same way.
std::string referenceFolder();

} // namespace supercircle::cli
