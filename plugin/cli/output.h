#pragma once
// Where results go, and saying so.

#include <string>

namespace supercircle::cli {

/// A folder for results: made, and proved to be writable, before any work is done. Folders it had to make are taken
/// away again unless something is kept in them.
class Folder {
public:
    /// Not yet made.
    explicit Folder(std::string path) : path_(std::move(path)) {}
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    /// Empty, or why nothing can be written there.
    std::string prepare();
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_;
    std::string made_; ///< outermost folder that was not there before; empty: none
};

/// Flushes stdout; false (after a message) if what was printed did not arrive, as on a full disk.
bool printed();

} // namespace supercircle::cli
