#pragma once
// Starts the built program as a shell does, and reads what it writes.

#include "tests/support/text.h"

#include <filesystem>
#include <string>
#include <vector>

namespace supercircle::test {

/// How the program ended.
struct CommandResult {
    int code = -1; ///< exit code; 128 + signal if a signal ended it
    std::string out;
    std::string err;
};

/// Options of a start.
struct Start {
    std::string directory{};      ///< working directory; empty: ours
    long fileSizeLimit = -1;      ///< bytes, RLIMIT_FSIZE; -1: none
    std::string standardOutput{}; ///< file that takes stdout, such as /dev/full; empty: captured
    bool terminal = false;        ///< stderr is a terminal
    int signal = 0;               ///< sent once the program printed something or `signalAfter` has passed
    double signalAfter = 0.3;     ///< s
};

/// Runs the program with these arguments to its end.
CommandResult start(const std::vector<std::string>& arguments, const Start& how = {});

/// Path of a scene of the project.
std::string scene(const std::string& name);

/// A temporary directory, removed at the end.
class Folder {
public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Writes a file and returns its path.
    std::string write(const std::string& name, const std::string& text) const;
    /// Names of everything in it, whatever the depth, sorted.
    [[nodiscard]] std::vector<std::string> entries() const;

private:
    std::string path_;
};

} // namespace supercircle::test
