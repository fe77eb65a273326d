#include "plugin/lab/sweep/slurm.h"

#include "plugin/recording/table/text.h"
#include "supercircle/support/hash.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace supercircle::sweep {

namespace {

void readBoth(std::array<int, 2> files, ProgramOutput& captured) {
    std::array<pollfd, 2> polls{pollfd{files[0], POLLIN, 0}, pollfd{files[1], POLLIN, 0}};
    while (polls[0].fd >= 0 || polls[1].fd >= 0) {
        if (::poll(polls.data(), polls.size(), -1) < 0 && errno != EINTR)
            return;
        for (std::size_t i = 0; i < polls.size(); ++i) {
            if (polls[i].fd < 0 || polls[i].revents == 0)
                continue;
            std::array<char, 4096> buffer{};
            const ssize_t n = ::read(polls[i].fd, buffer.data(), buffer.size());
            if (n > 0)
                (i == 0 ? captured.out : captured.err).append(buffer.data(), static_cast<std::size_t>(n));
            else if (n == 0 || errno != EINTR)
                polls[i].fd = -1;
        }
    }
}

std::string errorOf(const std::string& program, const ProgramOutput& c) {
    if (c.code == 127)
        return program + ": not found; Slurm's commands are in Debian's package slurm-client";
    const std::size_t end = c.err.find('\n');
    return program + " ended with code " + std::to_string(c.code) + (c.err.empty() ? "" : ": " + c.err.substr(0, end));
}

} // namespace

ProgramOutput runCommand(const std::vector<std::string>& command) {
    ProgramOutput captured;
    std::array<int, 2> out{}, err{};
    if (::pipe2(out.data(), O_CLOEXEC) != 0)
        return captured;
    if (::pipe2(err.data(), O_CLOEXEC) != 0) {
        ::close(out[0]);
        ::close(out[1]);
        return captured;
    }
    std::vector<char*> arguments;
    for (const std::string& a : command)
        arguments.push_back(const_cast<char*>(a.c_str()));
    arguments.push_back(nullptr);
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        if (::dup2(out[1], STDOUT_FILENO) >= 0 && ::dup2(err[1], STDERR_FILENO) >= 0)
            ::execvp(arguments[0], arguments.data());
        ::_exit(127);
    }
    ::close(out[1]);
    ::close(err[1]);
    if (child > 0) {
        readBoth({out[0], err[0]}, captured);
        int status = 0;
        ::waitpid(child, &status, 0);
        captured.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    ::close(out[0]);
    ::close(err[0]);
    return captured;
}

std::string arrayName(const std::string& folder) {
    char text[48];
    std::snprintf(text, sizeof text, "supercircle-%016llx-", static_cast<unsigned long long>(checkSum(folder)));
    return text;
}

Result<std::optional<ArrayJob>> findArray(const std::string& name) {
    const ProgramOutput c = runCommand({"squeue", "--me", "--noheader", "--format=%F %j"});
    if (c.code != 0)
        return Result<std::optional<ArrayJob>>::failure(errorOf("squeue", c));
    std::optional<ArrayJob> found;
    std::istringstream lines(c.out);
    for (std::string id, job; lines >> id >> job;)
        if (job.rfind(name, 0) == 0) {
            ArrayJob array{id, job, 0};
            const std::string parts = job.substr(name.size());
            std::from_chars(parts.data(), parts.data() + parts.size(), array.parts);
            found = array;
        }
    return found;
}

std::string arrayScript(const std::vector<std::string>& command, int parts, const std::string& log) {
    std::string script = "#!/bin/sh\n#SBATCH --output=" + record::shellQuoted(log) + "\n#SBATCH --ntasks=1\nexec";
    for (const std::string& argument : command) {
        std::string text = record::shellQuoted(argument);
        const auto replace = [&text](const std::string& what, const std::string& by) {
            for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
                text.replace(at, what.size(), by);
        };
        replace("@TASKS@", std::to_string(parts));
        replace("@TASK@", "'\"$SLURM_ARRAY_TASK_ID\"'");
        script += " " + text;
    }
    return script + "\n";
}

Result<std::string> submitArray(const std::string& script, const std::string& name, int parts,
                                const std::vector<std::string>& options) {
    std::vector<std::string> command = {"sbatch", "--parsable", "--array=1-" + std::to_string(parts),
                                        "--job-name=" + name + std::to_string(parts)};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(script);
    const ProgramOutput c = runCommand(command);
    if (c.code != 0)
        return Result<std::string>::failure(errorOf("sbatch", c));
    return c.out.substr(0, c.out.find_first_of(";\n")); // "12" or "12;cluster"
}

} // namespace supercircle::sweep
