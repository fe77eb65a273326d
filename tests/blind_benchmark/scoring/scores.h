#pragma once
// Scores of a set of cases, as text, JSON and a page.

#include "tests/blind_benchmark/scoring/case_score.h"
#include "tests/blind_benchmark/scoring/statistics.h"

#include <string>
#include <vector>

namespace supercircle::blind_benchmark {

struct Score {
    std::string name, target; ///< name and target, as text
    double value = 0.0, low = 0.0, high = 0.0;
    std::size_t of = 0; ///< number of values
    int met = -1;       ///< 1: the value meets the target, 0: not, -1: no target
};

std::vector<Score> scoresOf(const std::vector<CaseScore>& all);
std::string asText(const std::vector<CaseScore>& all, const std::string& title);
std::string asJson(const std::vector<CaseScore>& all, const std::string& title);
/// @param folder of the diagnoses, relative to the page
std::string asPage(const std::vector<CaseScore>& all, const std::string& title, const std::string& folder);

} // namespace supercircle::blind_benchmark
