#include "plugin/cli/progress.h"

#include <cmath>
#include <cstdio>
#include <sys/ioctl.h>
#include <unistd.h>

namespace supercircle::cli {

namespace {

constexpr double kTerminalInterval = 0.1; ///< s
constexpr double kPlainInterval = 5.0;    ///< s

/// Columns of the terminal: a longer line would wrap and could not be overwritten.
std::size_t terminalWidth() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

} // namespace

ProgressLine::ProgressLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()), last_(start_) {}

ProgressLine::~ProgressLine() {
    clear();
}

void ProgressLine::clear() {
    if (dirty_)
        std::fprintf(stderr, "\r\033[K");
    dirty_ = false;
}

bool ProgressLine::due() {
    if (quiet_)
        return false;
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - last_).count() < (terminal_ ? kTerminalInterval : kPlainInterval))
        return false;
    last_ = now;
    return true;
}

std::string ProgressLine::left(double fraction) const {
    const double spent = std::chrono::duration<double>(last_ - start_).count();
    return fraction > 0.02 ? ", about " + graphics::readableDuration(spent * (1.0 - fraction) / fraction) + " left"
                           : "";
}

void ProgressLine::print(const std::string& text) {
    const std::string line = terminal_ ? "\r\033[K" + text.substr(0, terminalWidth() - 1) : text + '\n';
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
    dirty_ = terminal_;
}

void ProgressLine::show(const lab::RunProgress& p) {
    if (!due())
        return;
    char text[160];
    std::snprintf(text, sizeof text, "%3.0f %%  %-9s t = %.2f s  F = %.3f N  travel = %.1f mm%s", 100.0 * p.fraction,
                  p.phase.c_str(), p.simulated, p.force, 1e3 * p.displacement, left(p.fraction).c_str());
    print(text);
}

void ProgressLine::show(double fraction, const std::string& description) {
    if (!due())
        return;
    char text[160];
    std::snprintf(text, sizeof text, "%3.0f %%  %s%s", 100.0 * fraction, description.c_str(), left(fraction).c_str());
    print(text);
}

} // namespace supercircle::cli
