#include "plugin/identification/diagnosis/model/stated_numbers.h"

#include "plugin/identification/diagnosis/result.h"

#include <algorithm>
#include <cctype>

namespace supercircle::diagnosis {

namespace {

/// Farthest from the stated value, in half-widths of its interval. Half of it misses a decimal lost from a number known
/// to 5 %; twice as much makes no difference to numbers that are farther off by a factor of two.
constexpr double kFarthest = 20.0;
constexpr double kSmallest = 0.2; ///< of a number of one sign
constexpr double kProbe = 3.0;    ///< half-widths

/// Names of what only one run has end in _runN.
bool ofOneRun(const std::string& name) {
    const std::size_t at = name.rfind("_run");
    return at != std::string::npos && at + 4 < name.size() &&
           std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at) + 4, name.end(),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool mayBeWrong(const Scalar& s) {
    return s.batch < 0 && s.name != "series_compliance" && s.name != "touch_compliance" &&
           s.name.rfind("reading_zero", 0) != 0 && !ofOneRun(s.name);
}

} // namespace

void addStatedNumbers(const std::vector<Scalar>& nominal, CandidateEffects& all) {
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        if (!mayBeWrong(nominal[i]))
            continue;
        Scalar s = nominal[i];
        s.amplitude = true;
        s.specimen = -1;
        s.upper = s.value + kFarthest * s.step;
        s.lower = s.value - kFarthest * s.step;
        if (nominal[i].lower > 0.0)
            s.lower = std::max(s.lower, kSmallest * s.value);
        else if (nominal[i].lower == 0.0)
            s.lower = 0.0;
        CandidateEffect c;
        c.label = "stated_" + s.name;
        c.slot = kDescription;
        c.law = "the number is another one than stated";
        c.number = static_cast<std::ptrdiff_t>(i);
        c.corrects = true;
        c.parameters = {s};
        c.probes = {{std::min(s.value + kProbe * s.step, s.upper)}};
        all.candidates.push_back(c);
        all.mappings.emplace_back();
    }
}

} // namespace supercircle::diagnosis
