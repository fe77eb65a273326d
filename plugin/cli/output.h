#pragma once
// Output folders and standard output.

#include <string>

namespace supercircle::cli {

/// A folder for results, created and tested for writing before any work. Folders that it created are removed again if
/// they stay empty.
class OutputFolder {
public:
    /// Creates nothing yet.
    explicit OutputFolder(std::string path) : path_(std::move(path)) {}
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    /// Creates the folder. Empty, or why nothing can be written there.
    [[nodiscard]] std::string prepare();
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_;
    std::string created_; ///< outermost folder that was created; empty: none
};

/// Flushes stdout; false (after a message) if printing failed, as on a full disk.
[[nodiscard]] bool printed();

/// Prints a message to stderr. @return `code`, the program's exit code
int complain(int code, const std::string& message);

} // namespace supercircle::cli
