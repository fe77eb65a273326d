#include "plugin/cli/output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <unistd.h>

namespace supercircle::cli {

namespace fs = std::filesystem;

std::string OutputFolder::prepare() {
    const std::string advice = "; choose another with --out";
    std::error_code error;
    fs::path missing = fs::absolute(path_, error).lexically_normal();
    if (!missing.has_filename()) // written with a slash at the end
        missing = missing.parent_path();
    std::string outermost;
    for (; !missing.empty() && !fs::exists(fs::symlink_status(missing, error)); missing = missing.parent_path())
        outermost = missing.string();
    fs::create_directories(path_, error);
    if (error)
        return "cannot create the folder " + path_ + ": " + error.message() + advice;
    if (!fs::is_directory(path_, error))
        return path_ + " is not a folder" + advice;
    created_ = outermost;
    std::string probe = (fs::path(path_) / ".supercircle.XXXXXX").string();
    const int file = ::mkstemp(probe.data());
    if (file < 0)
        return "cannot write into the folder " + path_ + ": " + std::strerror(errno) + advice;
    ::close(file);
    ::unlink(probe.c_str());
    return {};
}

OutputFolder::~OutputFolder() {
    if (created_.empty())
        return;
    std::error_code error; // rmdir fails on a folder that is not empty, which ends the loop
    fs::path last = fs::absolute(path_, error).lexically_normal();
    if (!last.has_filename())
        last = last.parent_path();
    for (; last.string().size() >= created_.size() && ::rmdir(last.c_str()) == 0; last = last.parent_path())
        continue;
}

bool printed() {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)
        return true;
    std::fprintf(stderr, "cannot write to the standard output: %s\n", std::strerror(errno));
    return false;
}

int complain(int code, const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return code;
}

} // namespace supercircle::cli
