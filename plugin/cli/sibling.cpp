#include "plugin/cli/sibling.h"

#include "plugin/cli/subcommands.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <unistd.h>

namespace supercircle::cli {

int startSibling(const std::string& subcommand, const std::string& name, const std::vector<std::string>& arguments) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    const fs::path program = folder / name;
    if (!fs::exists(program, error)) {
        const fs::path build = folder.parent_path();
        std::string remedy = "install the whole package";
        if (fs::exists(build / "CMakeCache.txt", error))
            remedy = "build it with: cmake --build " + build.string() + " --target " + name;
        std::fprintf(stderr, "supercircle %s: the program %s is missing; %s\n", subcommand.c_str(), name.c_str(),
                     remedy.c_str());
        return kBadInput;
    }
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    std::fprintf(stderr, "%s cannot be started: %s\n", program.c_str(), std::strerror(errno));
    return kBadInput;
}

} // namespace supercircle::cli
