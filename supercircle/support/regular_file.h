#pragma once
// Whether a path names a file that can be read into memory: a device or a pipe may never end, or block.

#include <cstdint>
#include <filesystem>
#include <string>

namespace supercircle {

/// Why the file cannot be read: missing, no regular file, or larger than `limit` bytes. Empty if it can. Opens nothing.
inline std::string whyUnreadable(const std::string& path, std::uintmax_t limit) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status))
        return status.type() == fs::file_type::not_found ? "there is no such file"
                                                         : "cannot be read: " + error.message();
    if (fs::is_directory(status))
        return "this is a directory, not a file";
    if (!fs::is_regular_file(status))
        return std::string("this is a ") +
               (fs::is_fifo(status)     ? "pipe"
                : fs::is_socket(status) ? "socket"
                                        : "device") +
               "; copy its content into a file";
    if (fs::file_size(path, error) > limit && !error)
        return "larger than " + std::to_string(limit >> 20) + " MiB";
    return {};
}

} // namespace supercircle
