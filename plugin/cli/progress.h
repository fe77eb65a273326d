#pragma once
// Progress of long work: one line with the time left that is updated on a terminal, plain lines elsewhere.

#include "plugin/graphics/axis.h"
#include "plugin/lab/session/run_scene.h"

#include <chrono>
#include <string>

namespace supercircle::cli {

class ProgressLine {
public:
    explicit ProgressLine(bool quiet);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    void show(const lab::RunProgress& p);
    /// The same for other work: fraction done and a description.
    void show(double fraction, const std::string& description);
    /// Removes the line before something else is printed.
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
