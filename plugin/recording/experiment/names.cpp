#include "plugin/recording/experiment/experiment.h"

#include <algorithm>
#include <filesystem>

namespace supercircle::experiment {

namespace {

namespace fs = std::filesystem;

std::string bare(const std::string& file, bool extension) {
    return extension ? fs::path(file).filename().string() : fs::path(file).stem().string();
}

/// With its folders; as a name of a file where there is no extension.
std::string whole(const std::string& file, bool extension) {
    std::string name = extension ? file : fs::path(file).replace_extension().generic_string();
    if (!extension)
        std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

std::ptrdiff_t times(const std::vector<std::string>& names, const std::string& name) {
    return std::count(names.begin(), names.end(), name);
}

} // namespace

std::vector<std::string> runNames(const Experiment& e, bool extension) {
    std::vector<std::string> names, out;
    for (const Run& run : e.runs)
        names.push_back(bare(run.file, extension));
    for (const Run& run : e.runs) {
        std::string name = bare(run.file, extension);
        if (times(names, name) > 1)
            name = whole(run.file, extension);
        const std::string first = name;
        for (int n = 2; times(out, name) > 0; ++n)
            name = first + "_" + std::to_string(n);
        out.push_back(name);
    }
    return out;
}

} // namespace supercircle::experiment
