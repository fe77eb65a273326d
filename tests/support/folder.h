#pragma once
// A temporary folder for a test, and running the program.

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace supercircle::test {

/// A folder that is removed at the end of its test.
class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "supercircle-test.XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    /// Writes a file into it; its path.
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path + "/" + name, std::ios::binary) << text;
        return path + "/" + name;
    }
    [[nodiscard]] bool has(const std::string& name) const { return std::filesystem::exists(path + "/" + name); }
    [[nodiscard]] std::size_t entries() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(path), std::filesystem::directory_iterator()));
    }
    std::string path;
};

struct CommandResult {
    int code = -1;
    std::string text; ///< standard output and error
};

/// Runs `command`, through a shell.
inline CommandResult start(const std::string& command) {
    CommandResult end;
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    REQUIRE(pipe != nullptr);
    char block[4096];
    for (std::size_t n = 0; (n = std::fread(block, 1, sizeof block, pipe)) > 0;)
        end.text.append(block, n);
    const int status = ::pclose(pipe);
    end.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return end;
}

} // namespace supercircle::test
