#include "plugin/scene/loader/problem.h"

#include "supercircle/support/printable.h"

#include <algorithm>

namespace supercircle::scene {

std::string Problem::toString() const {
    std::string s = file;
    if (line > 0)
        s += ":" + std::to_string(line) + ":" + std::to_string(column);
    s += ": ";
    if (severity == Severity::Note)
        s += "note: ";
    if (!pointer.empty())
        s += pointer + ": ";
    s += what;
    if (!expected.empty())
        s += "; expected " + expected;
    if (!nearest.empty())
        s += "; did you mean \"" + nearest + "\"?";
    return printable(s);
}

bool anyError(const std::vector<Problem>& problems) {
    return std::any_of(problems.begin(), problems.end(),
                       [](const Problem& p) { return p.severity == Problem::Severity::Error; });
}

std::string errorText(const std::vector<Problem>& problems, std::size_t first) {
    std::string all;
    for (std::size_t i = first; i < problems.size(); ++i)
        if (problems[i].severity == Problem::Severity::Error)
            all += (all.empty() ? "" : "\n") + problems[i].toString();
    return all;
}

} // namespace supercircle::scene
