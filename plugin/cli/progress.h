#pragma once
// Progress of long work: one living line with the time left on a terminal, plain lines elsewhere.

#include "plugin/lab/runner.h"

#include <chrono>

namespace supercircle::cli {

class ProgressLine {
public:
    explicit ProgressLine(bool quiet);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    void show(const lab::Progress& p);

private:
    bool quiet_;
    bool terminal_;
    bool dirty_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

} // namespace supercircle::cli
