#include "supercircle/support/names.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace supercircle {

namespace {

/// Optimal string alignment distance in half units: 2 for an edit, 1 for a mere change of case.
int editDistance(std::string_view a, std::string_view b) {
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

std::string nearestName(std::string_view name, const std::vector<std::string>& known) {
    // The distance takes time quadratic in the length.
    if (name.empty() || name.size() > 64)
        return {};
    const int limit = name.size() == 1 ? 1 : std::max(2, static_cast<int>(name.size()) * 2 / 3);
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

std::string didYouMean(std::string_view name, const std::vector<std::string>& known) {
    const std::string near = nearestName(name, known);
    return near.empty() ? near : "; did you mean \"" + near + "\"?";
}

} // namespace supercircle
