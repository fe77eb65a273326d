#include "plugin/identification/diagnosis/result/words.h"

#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

/// A state with its unit, small lengths in millimetres.
std::string state(const LearnedLaw& law, double v) {
    if (law.overUnit == "m" || law.overUnit == "m/s")
        return rounded(1e3 * v, 2) + (law.overUnit == "m" ? " mm" : " mm/s");
    return rounded(v, 2) + " " + law.overUnit;
}

std::string amount(const LearnedLaw& law, double v, double deviation) {
    const bool share = law.ofUnit == "1";
    const double f = share ? 100.0 : 1.0;
    return rounded(f * std::abs(v), 2) + " +- " + rounded(f * deviation, 2) + (share ? " %" : " " + law.ofUnit);
}

std::string alsoCalled(const LearnedLaw& law, bool falls) {
    if (law.label == "learned_moment")
        return falls ? "softening" : "stiffening";
    if (law.label == "learned_friction_speed")
        return falls ? "like Stribeck's law" : "strengthening with speed";
    if (law.label == "learned_friction_slip")
        return falls ? "running in" : "wear that roughens";
    if (law.label == "learned_contact")
        return falls ? "adhesion" : "repulsion at a distance";
    return {};
}

} // namespace

std::string inWords(const LearnedLaw& law) {
    const auto n = law.at.size();
    std::size_t a = 0, b = n;
    while (a < n && !law.visited[a])
        ++a;
    while (b > a && !law.visited[b - 1])
        --b;
    if (b < a + 3)
        return "these runs show too little of it: " + law.of + " against " + law.over + " stays unknown";
    --b;
    const double total = law.change;
    if (std::abs(total) < 2.0 * law.changeDeviation) {
        std::size_t far = a;
        for (std::size_t i = a; i <= b; ++i)
            if (std::abs(law.value[i] - law.value[a]) > std::abs(law.value[far] - law.value[a]))
                far = i;
        const double most = law.value[far] - law.value[a];
        if (std::abs(most) < 2.0 * law.deviation[far])
            return law.of + " hardly changes between " + state(law, law.at[a]) + " and " + state(law, law.at[b]);
        return law.of + (most > 0.0 ? " has a maximum" : " has a minimum") + " near " + state(law, law.at[far]) + ", " +
               amount(law, most, law.deviation[far]) + (most > 0.0 ? " above" : " below") + " its ends";
    }
    const bool falls = total < 0.0;
    std::size_t half = a;
    while (half < b && (law.value[half] - law.value[a]) / total < 0.5)
        ++half;
    const std::size_t quarter = b - (b - a) / 4;
    const double late = (law.value[b] - law.value[quarter]) / total;
    std::string text = law.of + (falls ? " falls by " : " rises by ") + amount(law, total, law.changeDeviation) +
                       " from " + state(law, law.at[a]) + " to " + state(law, law.at[b]) + " (" + law.over + ")";
    text += ", half of it by " + state(law, law.at[half]);
    text += late < 0.08 ? ", then flat" : late > 0.4 ? ", ever steeper" : "";
    const std::string name = alsoCalled(law, falls);
    return text + (name.empty() ? "" : ": " + name);
}

} // namespace supercircle::diagnosis
