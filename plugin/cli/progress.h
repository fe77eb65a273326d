#pragma once
// Progress of long work: one living line with the time left on a terminal, plain lines elsewhere.

#include "plugin/lab/session/runner.h"

#include <chrono>
#include <string>

namespace supercircle::cli {

class ProgressLine {
public:
    explicit ProgressLine(bool quiet);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    void show(const lab::Progress& p);
    /// The same for work that is no simulation of its own: share done and what is going on.
    void show(double fraction, const std::string& words);
    /// Takes the living line away before something else is printed.
    void clear();

private:
    [[nodiscard]] bool due();
    [[nodiscard]] std::string left(double fraction) const;
    void print(const std::string& text);

    bool quiet_;
    bool terminal_;
    bool dirty_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

} // namespace supercircle::cli
