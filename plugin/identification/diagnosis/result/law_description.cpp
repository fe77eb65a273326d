#include "plugin/identification/diagnosis/result/law_description.h"

#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

/// A value of the state with its unit, small lengths in millimetres.
std::string stateText(const LearnedLaw& law, double v) {
    if (law.stateUnit == "m" || law.stateUnit == "m/s")
        return rounded(1e3 * v, 2) + (law.stateUnit == "m" ? " mm" : " mm/s");
    return rounded(v, 2) + " " + law.stateUnit;
}

std::string amount(const LearnedLaw& law, double v, double sigma) {
    const bool share = law.responseUnit == "1";
    const double f = share ? 100.0 : 1.0;
    return rounded(f * std::abs(v), 2) + " +- " + rounded(f * sigma, 2) + (share ? " %" : " " + law.responseUnit);
}

std::string usualName(const LearnedLaw& law, bool falls) {
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

std::string describeLaw(const LearnedLaw& law) {
    const auto n = law.states.size();
    std::size_t a = 0, b = n;
    while (a < n && !law.inStateRange[a])
        ++a;
    while (b > a && !law.inStateRange[b - 1])
        --b;
    if (b < a + 3)
        return "these runs do not determine " + law.response + " as a function of " + law.state;
    --b;
    const double total = law.change;
    if (std::abs(total) < 2.0 * law.changeSigma) {
        std::size_t far = a;
        for (std::size_t i = a; i <= b; ++i)
            if (std::abs(law.value[i] - law.value[a]) > std::abs(law.value[far] - law.value[a]))
                far = i;
        const double most = law.value[far] - law.value[a];
        if (std::abs(most) < 2.0 * law.sigma[far])
            return law.response + " is nearly constant between " + stateText(law, law.states[a]) + " and " +
                   stateText(law, law.states[b]);
        return law.response + (most > 0.0 ? " has a maximum" : " has a minimum") + " near " +
               stateText(law, law.states[far]) + ", " + amount(law, most, law.sigma[far]) +
               (most > 0.0 ? " above" : " below") + " its ends";
    }
    const bool falls = total < 0.0;
    std::size_t half = a;
    while (half < b && (law.value[half] - law.value[a]) / total < 0.5)
        ++half;
    const std::size_t quarter = b - (b - a) / 4;
    const double late = (law.value[b] - law.value[quarter]) / total;
    std::string text = law.response + (falls ? " falls by " : " rises by ") + amount(law, total, law.changeSigma) +
                       " from " + stateText(law, law.states[a]) + " to " + stateText(law, law.states[b]) + " (" +
                       law.state + ")";
    text += ", half of it by " + stateText(law, law.states[half]);
    text += late < 0.08 ? ", then flat" : late > 0.4 ? ", with increasing slope" : "";
    const std::string name = usualName(law, falls);
    return text + (name.empty() ? "" : ": " + name);
}

} // namespace supercircle::diagnosis
