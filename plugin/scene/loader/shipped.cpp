#include "plugin/scene/loader/shipped.h"

#include <algorithm>
#include <filesystem>
#include <vector>

namespace supercircle::scene {

namespace fs = std::filesystem;

/// PREFIX/share/supercircle/NAME beside PREFIX/bin/PROGRAM, wherever that prefix was moved to; else `built`.
std::string dataFolder(const char* name, const char* built) {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path installed = program.parent_path().parent_path() / "share" / "supercircle" / name;
        if (fs::is_directory(installed, error))
            return installed.string();
    }
    return built;
}

std::string shippedFolder() {
    return dataFolder("scenes", SC_SCENES_DIR);
}

std::string shippedScene(const std::string& name) {
    std::error_code error;
    for (const char* folder : {"", "experiments"})
        if (const fs::path file = fs::path(shippedFolder()) / folder / (name + ".json");
            fs::is_regular_file(file, error))
            return file.string();
    return {};
}

std::string shippedNames() {
    std::error_code error;
    std::vector<std::string> names{"pendulum"};
    for (const auto& entry : fs::directory_iterator(fs::path(shippedFolder()) / "experiments", error))
        names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    std::string all;
    for (const std::string& n : names)
        all += (all.empty() ? "" : ", ") + n;
    return all;
}

} // namespace supercircle::scene
