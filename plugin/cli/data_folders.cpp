#include "plugin/cli/data_folders.h"

#include <filesystem>

namespace supercircle::cli {

namespace {

/// PREFIX/share/supercircle/NAME beside PREFIX/bin/supercircle, wherever that prefix was moved to; else `built`.
std::string folder(const char* name, const char* built) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path installed = program.parent_path().parent_path() / "share" / "supercircle" / name;
        if (fs::is_directory(installed, error))
            return installed.string();
    }
    return built;
}

} // namespace

std::string scenesFolder() {
    return folder("scenes", SC_SCENES_DIR);
}

std::string referenceFolder() {
    return folder("reference", SC_REFERENCE_DIR);
}

} // namespace supercircle::cli
