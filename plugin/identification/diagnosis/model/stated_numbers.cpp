#include "plugin/identification/diagnosis/model/stated_numbers.h"

#include "plugin/identification/diagnosis/result.h"
#include "supercircle/support/elementary.h"

#include <algorithm>

namespace supercircle::diagnosis {

namespace {

/// Of a number of one sign, where half-widths reach farther. A friction was 0.17 of the stated one: at a factor of five
/// it ended at its bound, and wear of a short way took its place. Half still holds it; double costs nothing where
/// half-widths end before.
constexpr double kFactor = 25.0;
constexpr double kProbe = 3.0; ///< half-widths

} // namespace

void addStatedNumbers(const std::vector<Scalar>& nominal, CandidateEffects& all) {
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        if (!nominal[i].doubtful)
            continue;
        Scalar s = nominal[i];
        s.amplitude = true;
        s.precision = 0.0;
        s.specimen = -1;
        s.upper = s.value + kFarthestNumber * s.step;
        s.lower = s.value - kFarthestNumber * s.step;
        if (s.scale == Scale::Logarithm) {
            s.lower = std::max(s.lower, s.value - math::log(kFactor));
            s.upper = std::min(s.upper, s.value + math::log(kFactor));
        } else if (nominal[i].lower > 0.0)
            s.lower = std::max(s.lower, s.value / kFactor);
        else if (nominal[i].lower == 0.0)
            s.lower = 0.0;
        CandidateEffect c;
        c.label = "stated_" + s.name;
        c.slot = kDescription;
        c.law = "the number is another one than stated";
        c.number = static_cast<std::ptrdiff_t>(i);
        c.corrects = true;
        c.parameters = {s};
        c.probes = {{s.value + kProbe * s.step}};
        all.candidates.push_back(c);
        all.mappings.emplace_back();
    }
}

} // namespace supercircle::diagnosis
