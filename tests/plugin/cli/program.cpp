#include "tests/plugin/cli/program.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace supercircle::test {

namespace fs = std::filesystem;

namespace {

/// Both ends of where a stream of the program goes.
struct Stream {
    int ours = -1;
    int theirs = -1;
};

Stream makePipe() {
    std::array<int, 2> ends{};
    REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
    return {ends[0], ends[1]};
}

Stream makeTerminal() {
    INFO("a test with a terminal needs pseudo-terminals: is /dev/pts mounted?");
    const int ours = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    REQUIRE(ours >= 0);
    REQUIRE(::grantpt(ours) == 0);
    REQUIRE(::unlockpt(ours) == 0);
    const int theirs = ::open(::ptsname(ours), O_RDWR | O_NOCTTY | O_CLOEXEC);
    REQUIRE(theirs >= 0);
    const winsize size{24, 60, 0, 0};
    REQUIRE(::ioctl(theirs, TIOCSWINSZ, &size) == 0);
    return {ours, theirs};
}

[[noreturn]] void become(const std::vector<std::string>& arguments, const Start& how, int out, int err) {
    std::vector<char*> argv;
    for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (how.fileSizeLimit >= 0) {
        const auto bytes = static_cast<rlim_t>(how.fileSizeLimit);
        const rlimit limit{bytes, bytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    if ((!how.directory.empty() && ::chdir(how.directory.c_str()) != 0) || ::dup2(out, STDOUT_FILENO) < 0 ||
        ::dup2(err, STDERR_FILENO) < 0)
        ::_exit(127);
    ::execv(argv[0], argv.data());
    ::_exit(127);
}

/// Reads until both streams are closed; sends the signal in between.
void follow(pid_t child, const Start& how, int out, int err, CommandResult& ending) {
    std::array<pollfd, 2> both{pollfd{out, POLLIN, 0}, pollfd{err, POLLIN, 0}};
    const auto begin = std::chrono::steady_clock::now();
    bool sent = how.signal == 0;
    while (both[0].fd >= 0 || both[1].fd >= 0) {
        ::poll(both.data(), both.size(), 20);
        for (std::size_t i = 0; i < both.size(); ++i) {
            if (both[i].fd < 0 || both[i].revents == 0)
                continue;
            std::array<char, 4096> buffer{};
            const ssize_t n = ::read(both[i].fd, buffer.data(), buffer.size());
            if (n > 0)
                (i == 0 ? ending.out : ending.err).append(buffer.data(), static_cast<std::size_t>(n));
            else
                both[i].fd = -1; // a terminal answers EIO when the other end is closed
        }
        const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
        if (!sent && since.count() > how.signalAfter) {
            ::kill(child, how.signal);
            sent = true;
        }
    }
}

} // namespace

CommandResult start(const std::vector<std::string>& arguments, const Start& how) {
    std::vector<std::string> all{SC_PROGRAM};
    all.insert(all.end(), arguments.begin(), arguments.end());
    Stream out = makePipe();
    if (!how.standardOutput.empty()) {
        ::close(out.theirs);
        out.theirs = ::open(how.standardOutput.c_str(), O_WRONLY | O_CLOEXEC);
        REQUIRE(out.theirs >= 0);
    }
    const Stream err = how.terminal ? makeTerminal() : makePipe();
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0)
        become(all, how, out.theirs, err.theirs);
    ::close(out.theirs);
    ::close(err.theirs);
    CommandResult ending;
    follow(child, how, out.ours, err.ours, ending);
    ::close(out.ours);
    ::close(err.ours);
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    ending.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return ending;
}

std::string scene(const std::string& name) {
    return std::string(SC_SOURCE_DIR) + "/scenes/" + name + ".json";
}

Folder::Folder() {
    std::string name = (fs::temp_directory_path() / "sc-cli-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path_ = name;
}

Folder::~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string Folder::write(const std::string& name, const std::string& text) const {
    std::ofstream(*this / name, std::ios::binary) << text;
    return *this / name;
}

std::vector<std::string> Folder::entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
        names.push_back(fs::relative(entry.path(), path_).string());
    std::sort(names.begin(), names.end());
    return names;
}

} // namespace supercircle::test
