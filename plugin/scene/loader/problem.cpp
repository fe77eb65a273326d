#include "plugin/scene/loader/problem.h"

#include <algorithm>
#include <cctype>

namespace supercircle::scene {

namespace {

/// Optimal string alignment distance in half units: 2 for an edit, 1 for a mere change of case.
int editDistance(const std::string& a, const std::string& b) {
    const std::size_t n = a.size();
    const std::size_t m = b.size();
    std::vector<std::vector<int>> d(n + 1, std::vector<int>(m + 1, 0));
    for (std::size_t i = 0; i <= n; ++i)
        d[i][0] = static_cast<int>(2 * i);
    for (std::size_t j = 0; j <= m; ++j)
        d[0][j] = static_cast<int>(2 * j);
    const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    for (std::size_t i = 1; i <= n; ++i) {
        for (std::size_t j = 1; j <= m; ++j) {
            const bool same = a[i - 1] == b[j - 1];
            const int replace = same ? 0 : (lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2);
            d[i][j] = std::min({d[i - 1][j] + 2, d[i][j - 1] + 2, d[i - 1][j - 1] + replace});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 2);
        }
    }
    return d[n][m];
}

} // namespace

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
    return s;
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

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
    // The distance takes time quadratic in the length.
    if (name.empty() || name.size() > 64)
        return {};
    const int limit = std::max(2, static_cast<int>(name.size()) * 2 / 3);
    int best = limit + 1;
    std::string result;
    for (const std::string& candidate : known) {
        const int d = editDistance(name, candidate);
        if (d < best) {
            best = d;
            result = candidate;
        }
    }
    return result;
}

} // namespace supercircle::scene
