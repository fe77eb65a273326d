#include "plugin/recording/table/files.h"

#include "supercircle/support/regular_file.h"
#include "supercircle/support/texts_in_memory.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace supercircle::record {

namespace {

Status because(const std::string& what, int error) {
    return Status::failure(what + ": " + std::strerror(error));
}

/// Owns a temporary file until it is renamed; an abandoned one is removed.
class Staged {
public:
    Staged(const std::string& directory, const std::string& name)
        : target(directory + "/" + name), path(directory + "/." + name + ".XXXXXX") {}
    Staged(const Staged&) = delete;
    Staged& operator=(const Staged&) = delete;
    ~Staged() {
        if (file >= 0)
            ::close(file);
        if (exists)
            ::unlink(path.c_str());
    }

    Status write(std::string_view text) {
        file = ::mkstemp(path.data());
        if (file < 0)
            return because("cannot write " + target, errno);
        exists = true;
        const mode_t mask = ::umask(0);
        ::umask(mask);
        ::fchmod(file, 0666 & ~mask); // mkstemp makes files nobody else may read
        while (!text.empty()) {
            const ssize_t n = ::write(file, text.data(), text.size());
            if (n < 0 && errno == EINTR)
                continue;
            if (n <= 0)
                return because("cannot write " + target, n < 0 ? errno : ENOSPC);
            text.remove_prefix(static_cast<std::size_t>(n));
        }
        // Delayed allocation tells about a full disk only here or at close.
        if (::fsync(file) != 0 && errno != EINVAL && errno != ENOTSUP)
            return because("cannot write " + target, errno);
        const int closed = ::close(file);
        file = -1;
        return closed == 0 ? Status{} : because("cannot write " + target, errno);
    }

    Status commit() {
        if (::rename(path.c_str(), target.c_str()) != 0)
            return because("cannot put " + target + " in place", errno);
        exists = false;
        return {};
    }

private:
    std::string target, path;
    int file = -1;
    bool exists = false;
};

/// The renames themselves survive a power cut only once the directory is on the disk; best effort.
void flushDirectory(const std::string& directory) {
    const int handle = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle < 0)
        return;
    ::fsync(handle);
    ::close(handle);
}

Status writeAll(const std::string& directory, const std::vector<NamedText>& files) {
    const std::string folder = directory.empty() ? "." : directory;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        return Status::failure("cannot make the directory " + folder + ": " + error.message());
    if (!std::filesystem::is_directory(folder, error))
        return Status::failure("cannot write into " + folder + ": not a directory");

    std::vector<std::unique_ptr<Staged>> staged;
    for (const auto& [name, text] : files) {
        staged.push_back(std::make_unique<Staged>(folder, name));
        if (Status written = staged.back()->write(text); !written)
            return written;
    }
    for (const auto& file : staged)
        if (Status placed = file->commit(); !placed)
            return placed;
    flushDirectory(folder);
    return {};
}

} // namespace

Status writeAtomically(const std::string& directory, const std::vector<NamedText>& files) noexcept {
    try {
        return writeAll(directory, files);
    } catch (const std::exception& exception) {
        return Status::failure(std::string("cannot write files: ") + exception.what());
    }
}

Result<std::string> readText(const std::string& path, std::uintmax_t mostBytes) {
    if (const std::string* text = TextsInMemory::find(path)) {
        if (text->size() > mostBytes)
            return Result<std::string>::failure("cannot read " + path + ": larger than " +
                                                std::to_string(mostBytes >> 20) + " MiB");
        return *text;
    }
    if (const std::string why = whyUnreadable(path, mostBytes); !why.empty())
        return Result<std::string>::failure("cannot read " + path + ": " + why);
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr)
        return Result<std::string>::failure(because("cannot read " + path, errno).error());
    Result<std::string> result = std::string{};
    std::vector<char> buffer(1 << 16);
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file))
        result->append(buffer.data(), n);
    if (std::ferror(file) != 0)
        result = Result<std::string>::failure(because("cannot read " + path, errno).error());
    std::fclose(file);
    return result;
}

} // namespace supercircle::record
