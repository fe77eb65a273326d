#pragma once
// Scores of a set of judged cases, as text, JSON and a page.

#include "tests/blind_benchmark/prove/judge.h"
#include "tests/blind_benchmark/prove/statistics.h"

#include <string>
#include <vector>

namespace supercircle::oracle {

struct Score {
    std::string name, target; ///< in words
    double value = 0.0, low = 0.0, high = 0.0;
    std::size_t of = 0;
    int met = -1; ///< 1 the value meets the target, 0 not, -1 no target
};

std::vector<Score> scoresOf(const std::vector<Judged>& all);
std::string asText(const std::vector<Judged>& all, const std::string& title);
std::string asJson(const std::vector<Judged>& all, const std::string& title);
/// @param pictures folders of the diagnoses, relative to the page, by case
std::string asPage(const std::vector<Judged>& all, const std::string& title, const std::string& folder);

} // namespace supercircle::oracle
