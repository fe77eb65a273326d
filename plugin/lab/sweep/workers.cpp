// Processes by fork (decision 0174). A child has the scene in memory and returns its result through a pipe.
// PR_SET_PDEATHSIG ends the children with their parent: a sweep that is killed and resumed meets no old worker.

#include "plugin/lab/sweep/workers.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace supercircle::sweep {

namespace {

using Clock = std::chrono::steady_clock;

struct Process {
    pid_t id = 0;
    int pipe = -1;
    Task task;
    std::string result;
    Clock::time_point start;
};

bool writeAll(int file, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = ::write(file, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        done += static_cast<std::size_t>(n);
    }
    return true;
}

[[noreturn]] void runInChild(const WorkPlan& work, const Task& task, pid_t parent, int pipe) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) // the parent died before prctl
        ::_exit(kExitInterrupted);
    if (work.onFork)
        work.onFork();
    int code = kExitException;
    try {
        code = writeAll(pipe, work.runTask(task)) ? 0 : kExitException;
    } catch (const TaskInterrupted&) {
        code = kExitInterrupted;
    } catch (const std::exception& e) {
        writeAll(pipe, e.what());
    } catch (...) {
        code = kExitException;
    }
    ::_exit(code); // the parent's buffers and handles must not be flushed or destroyed twice
}

class Workers {
public:
    explicit Workers(const WorkPlan& work) : work_(work) {}
    ~Workers() {
        for (const Process& p : processes_) {
            ::kill(p.id, SIGKILL);
            ::close(p.pipe);
            int status = 0;
            ::waitpid(p.id, &status, 0);
        }
    }
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    [[nodiscard]] std::size_t busy() const { return processes_.size(); }

    std::string start(const Task& task) {
        std::array<int, 2> ends{};
        if (::pipe(ends.data()) != 0)
            return std::string("cannot make a pipe: ") + std::strerror(errno);
        std::fflush(nullptr);
        const pid_t parent = ::getpid();
        const pid_t id = ::fork();
        if (id < 0) {
            ::close(ends[0]);
            ::close(ends[1]);
            return std::string("cannot start a process: ") + std::strerror(errno);
        }
        if (id == 0) {
            ::close(ends[0]);
            for (const Process& p : processes_)
                ::close(p.pipe);
            runInChild(work_, task, parent, ends[1]);
        }
        ::close(ends[1]);
        processes_.push_back({id, ends[0], task, {}, Clock::now()});
        return {};
    }

    /// Reads the output of the processes for 0.1 s; stores those that ended.
    std::string poll() {
        std::vector<pollfd> polls;
        for (const Process& p : processes_)
            polls.push_back({p.pipe, POLLIN, 0});
        ::poll(polls.data(), polls.size(), 100);
        for (std::size_t i = polls.size(); i-- > 0;)
            if (polls[i].revents != 0 && !read(processes_[i]))
                if (std::string error = finish(i); !error.empty())
                    return error;
        return {};
    }

private:
    /// False at the end of the stream.
    static bool read(Process& p) {
        std::array<char, 65536> buffer{};
        const ssize_t n = ::read(p.pipe, buffer.data(), buffer.size());
        if (n > 0)
            p.result.append(buffer.data(), static_cast<std::size_t>(n));
        return n > 0 || (n < 0 && errno == EINTR);
    }

    std::string finish(std::size_t i) {
        Process p = std::move(processes_[i]);
        processes_.erase(processes_.begin() + static_cast<std::ptrdiff_t>(i));
        ::close(p.pipe);
        int status = 0;
        rusage usage{};
        ::wait4(p.id, &status, 0, &usage);
        FinishedTask f;
        f.task = p.task;
        f.result = std::move(p.result);
        f.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
        f.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        f.wall = std::chrono::duration<double>(Clock::now() - p.start).count();
        const auto seconds = [](const timeval& t) {
            return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        };
        f.cpu = seconds(usage.ru_utime) + seconds(usage.ru_stime);
        return f.exitCode == kExitInterrupted ? std::string() : work_.onFinished(f);
    }

    const WorkPlan& work_;
    std::vector<Process> processes_;
};

} // namespace

std::string runTasks(const std::vector<Task>& tasks, const WorkPlan& work) {
    Workers workers(work);
    std::size_t next = 0;
    while (next < tasks.size() || workers.busy() > 0) {
        if (work.interrupt != nullptr && *work.interrupt)
            return {};
        while (next < tasks.size() && workers.busy() < static_cast<std::size_t>(std::max(1, work.jobs)))
            if (std::string error = workers.start(tasks[next++]); !error.empty())
                return error;
        if (std::string error = workers.poll(); !error.empty())
            return error;
        if (work.onPoll)
            work.onPoll();
    }
    return {};
}

} // namespace supercircle::sweep
