#include "plugin/cli/progress.h"

#include <cstdio>
#include <unistd.h>

namespace supercircle::cli {

ProgressLine::ProgressLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()), last_(start_) {}

ProgressLine::~ProgressLine() {
    if (dirty_)
        std::fprintf(stderr, "\r\033[K");
}

void ProgressLine::show(const lab::Progress& p) {
    if (quiet_)
        return;
    const auto now = std::chrono::steady_clock::now();
    const double since = std::chrono::duration<double>(now - last_).count();
    if (since < (terminal_ ? 0.1 : 5.0))
        return;
    last_ = now;
    const double spent = std::chrono::duration<double>(now - start_).count();
    char left[32] = "";
    if (p.fraction > 0.02)
        std::snprintf(left, sizeof left, ", about %.0f s left", spent * (1.0 - p.fraction) / p.fraction);
    std::fprintf(stderr, "%s%3.0f %%  %-10s t = %.2f s  F = %.3f N  travel = %.1f mm%s%s", terminal_ ? "\r\033[K" : "",
                 100.0 * p.fraction, p.phase.c_str(), p.simulated, p.force, 1e3 * p.displacement, left,
                 terminal_ ? "" : "\n");
    std::fflush(stderr);
    dirty_ = terminal_;
}

} // namespace supercircle::cli
