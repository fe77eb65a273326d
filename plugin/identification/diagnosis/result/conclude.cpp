#include "plugin/identification/diagnosis/result/conclude.h"

#include "plugin/identification/diagnosis/next.h"
#include "plugin/identification/diagnosis/selection/weigh.h"
#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

constexpr double kSuggestive = 0.75; ///< less belief in "nothing" is a hint of something, as is p <= kFamilyWise

constexpr double kWorthAWord = 0.03; ///< a probability

std::string joined(const std::vector<std::string>& labels, std::size_t from = 0) {
    std::string out;
    for (std::size_t i = from; i < labels.size(); ++i)
        out += (i == from ? "" : i + 1 == labels.size() ? " and " : ", ") + plainWords(labels[i]);
    return out;
}

/// Effects that could be there at a size that matters without being seen.
std::string blindSpots(const Diagnosis& d) {
    std::vector<std::string> labels;
    for (const SeenEffect& s : d.seen)
        if (s.visible > 1.0)
            labels.push_back(s.label);
    return labels.empty() ? "" : " Of a size that matters these runs would not show " + joined(labels) + ".";
}

/// The best learned law, where it is believed.
std::string learnt(const Diagnosis& d) {
    if (d.learned.empty() || d.learned.front().probability < 0.05)
        return {};
    const LearnedLaw& law = d.learned.front();
    return " Learned from the runs (" + plainWords(law.label) + "): " + law.words + ".";
}

std::string withValues(const FoundEffect& e) {
    std::string text = plainWords(e.label) + (e.form.empty() ? "" : " (" + e.form + ")");
    const auto write = [&](const FittedParameter& p) {
        return p.name + " = " + rounded(p.value, 3) + (p.unit == "1" ? "" : " " + p.unit) +
               (p.ci90.eitherSide ? " (or to the other side, which these runs do not tell)" : "");
    };
    for (std::size_t i = 0; i < e.parameters.size() && i < 4; ++i)
        text += (i == 0 ? ": " : ", ") + write(e.parameters[i]);
    for (std::size_t i = 0; i < e.products.size(); ++i)
        text += (i == 0 ? ", in all " : ", ") + write(e.products[i]);
    return text;
}

/// Error on unseen runs, in noise units, up to which an effect that is there explains all there is: of single effects
/// in the proof's cases the largest is 1.27, of one of two that act it is 1.46 and more.
constexpr double kAll = 1.35;

/// Where the error on unseen runs is not one.
std::string shownOnlyBy(const FoundEffect& e) {
    std::map<std::string, std::string> names; // by run
    for (const FittedParameter& p : e.parameters)
        if (!p.only.empty())
            names[p.only] += (names[p.only].empty() ? "" : ", ") + p.name;
    std::string text;
    for (const auto& [run, numbers] : names)
        text += " Without " + run + " " + numbers + " would be open: its error is that of a fit, not of a forecast.";
    return text;
}

/// What the effect does for runs that its fit had not seen. A weak effect, or one that markers show, leaves the error
/// of a single force as it was: what speaks for it is many readings that agree.
std::string onUnseenRuns(const Diagnosis& d, const FoundEffect& e) {
    const std::string before = rounded(d.baselineHeldOut, 3), after = rounded(d.improvedHeldOut, 3);
    const std::string noise = " (sensor noise " + rounded(d.noise.total(), 3) + " " + d.unit + ")";
    const double tens = std::round(std::max(0.0, e.gain) / std::log(10.0));
    const std::string change = before == after                         ? "stays at "
                               : d.improvedHeldOut < d.baselineHeldOut ? "falls from " + before + " to "
                                                                       : "rises from " + before + " to ";
    std::string text = "on runs it had not seen the error of a reading " + change + after + " " + d.unit + noise;
    if (!(d.improvedHeldOut < d.baselineHeldOut && before != after) && tens >= 1.0)
        text += ", but together they are 10^" + rounded(tens, 6) + " times as probable as without";
    return text + ".";
}

std::string named(const Diagnosis& d) {
    const FoundEffect& e = d.effects.front();
    const bool all = d.improvedHeldOut <= kAll * d.noise.total();
    std::string text =
        (all ? "The runs are explained by " : "Most of what the runs show is explained by ") + withValues(e);
    for (const std::string& label : e.with) {
        const auto other = std::find_if(d.effects.begin(), d.effects.end(), [&](const FoundEffect& o) {
            return o.label == label && std::find(o.with.begin(), o.with.end(), e.label) != o.with.end();
        });
        // Shown by another hypothesis its values are not those that act here.
        text += "; together with " + (other != d.effects.end() ? withValues(*other) : plainWords(label));
    }
    text += "; " + onUnseenRuns(d, e) + shownOnlyBy(e);
    if (!all)
        text += " What is left is more than noise: something else acts beside it, or its law is another one, and its "
                "numbers carry a part of that.";
    if (e.group.size() > 1)
        text += " These runs cannot tell it from " + joined(e.group, 1) + ".";
    return text;
}

std::string percent(double p) {
    return record::fixed(100.0 * p, 0) + " %";
}

std::string nextOf(const Diagnosis& d) {
    if (d.next)
        return " Next: " + inWords(*d.next) + ".";
    return d.nextTried > 0 ? " " + noneTells(d) : "";
}

/// The rivals with their probabilities: effects, and what else has a share.
std::string undecided(const Diagnosis& d, const Evidence& e) {
    std::string rivals;
    const auto add = [&](const std::string& what, double p) {
        rivals += (rivals.empty() ? "" : ", ") + what + " " + percent(p);
    };
    std::vector<std::string> said; // effects that act together are one rival
    for (std::size_t i = 0; i < d.effects.size() && i < 3; ++i) {
        const FoundEffect& f = d.effects[i];
        if ((i > 0 && f.probability <= kWorthAWord) || std::find(said.begin(), said.end(), f.label) != said.end())
            continue;
        add(plainWords(f.label) + (f.with.empty() ? "" : " with " + joined(f.with)), f.probability);
        said.insert(said.end(), f.with.begin(), f.with.end());
    }
    if (d.nothing > kWorthAWord)
        add("nothing missing", d.nothing);
    if (d.unseen() > kWorthAWord)
        add("something else, too small to be seen here", d.unseen());
    if (d.unknown > kWorthAWord)
        add("none of these", d.unknown);
    std::string text =
        "Something seems to be missing (p = " + rounded(e.p, 3) + "), but these runs do not decide: " + rivals + ".";
    if (!d.effects.empty() && d.effects.front().group.size() > 1)
        text += " They cannot tell " + plainWords(d.effects.front().label) + " from " +
                joined(d.effects.front().group, 1) + ".";
    return text + nextOf(d);
}

} // namespace

std::string plainWords(std::string label) {
    std::replace(label.begin(), label.end(), '_', ' ');
    return label;
}

std::string verdictOf(const Evidence& e) {
    // Weights hold everything: the family-wise p-value, gains on unseen runs, and what the best model leaves.
    if (!(e.nothing >= 0.0 && e.unknown >= 0.0)) // numbers broke down: nothing may be claimed
        return "unexplained";
    if (e.nothing >= 0.5)
        return e.blind > 0.5 || e.nothing < kSuggestive || e.p <= kFamilyWise ? "not_enough_information"
                                                                              : "nothing_missing";
    if (e.p > kFamilyWise) // believed or not, nothing stands out of the noise
        return "not_enough_information";
    if (e.unknown >= 0.5 || !e.any)
        return "unexplained";
    const bool gains = (e.gainLow > 0.0 && e.gain > 3.0) || e.gain > kBeyondChance;
    return e.bestGroup >= 0.9 && gains ? "named" : "ambiguous";
}

namespace {

/// What the nearest hypothesis would have to be stretched to, if it is.
std::string stretched(const Diagnosis& d) {
    const FoundEffect& first = d.effects.front();
    std::string text;
    for (const FoundEffect& e : d.effects) {
        if (&e != &first && std::find(first.with.begin(), first.with.end(), e.label) == first.with.end())
            continue;
        for (const FittedParameter& p : e.parameters)
            if (std::find(e.pressed.begin(), e.pressed.end(), p.name) != e.pressed.end())
                text += (text.empty() ? "" : ", ") + p.name + " beyond " + rounded(p.value, 3) +
                        (p.unit == "1" ? "" : " " + p.unit);
    }
    return text.empty() ? text : ", but would have to be larger than is plausible (" + text + ")";
}

std::string judged(const Diagnosis& d, const Evidence& e) {
    if (d.verdict == "nothing_missing")
        return "Inside the stated uncertainties the simulation agrees with all runs to the noise (p = " +
               rounded(e.p, 3) + " for the largest of " + std::to_string(d.mismatch.family) +
               " statistics): nothing is missing that these runs could show" +
               (d.unseen() > kWorthAWord
                    ? " (nothing at all with a probability of " + rounded(d.nothing, 2) +
                          ", something that is too small for them with " + rounded(d.unseen(), 2) + ")."
                    : ".") +
               blindSpots(d);
    if (d.verdict == "not_enough_information" && (e.nothing < kSuggestive || e.p <= kFamilyWise)) {
        const std::string likely =
            d.effects.empty() ? std::string() : ", most likely " + plainWords(d.effects.front().label);
        return (e.nothing < kSuggestive ? "There is a hint that something is missing (p = "
                                        : "Something stands out of the noise (p = ") +
               rounded(e.p, 3) + " for the largest of " + std::to_string(d.mismatch.family) + " statistics)" + likely +
               (e.nothing < kSuggestive ? ", too weak to decide: " : ", too little to believe in extra physics: ") +
               "nothing that these runs could show is missing with a probability of " + rounded(e.nothing, 3) + "." +
               nextOf(d);
    }
    if (d.verdict == "not_enough_information")
        return "The simulation agrees with the runs, but most effects of the catalogue could be there at a size that "
               "matters without being seen: these runs do not decide." +
               nextOf(d);
    if (d.verdict == "named")
        return named(d) + nextOf(d);
    if (d.verdict == "unexplained")
        return "Something is missing (p = " + rounded(e.p, 3) + "), and no effect of the catalogue accounts for it" +
               (d.effects.empty()
                    ? std::string(".")
                    : "; the nearest is " + plainWords(d.effects.front().label) + ", which leaves " +
                          rounded(d.improvedHeldOut, 3) + " " + d.unit + " on unseen runs with a noise of " +
                          rounded(d.noise.total(), 3) + " " + d.unit + stretched(d) + ".") +
               learnt(d);
    return undecided(d, e);
}

} // namespace

std::string statementOf(const Diagnosis& d, const Evidence& e) {
    const std::string text = judged(d, e);
    if (d.noise.swing <= 0.0)
        return text;
    return text +
           (d.noise.swingInMisfit ? " Whatever the drive does the reading swings by "
                                  : " At rest the reading swings by ") +
           rounded(d.noise.swing, 3) + " " + d.unit + " with a period of " + rounded(d.noise.swingPeriod, 3) +
           " s: whatever does that, no specimen does.";
}

bool alikeByNature(const Data& data, const std::string& a, const std::string& b) {
    const auto bends = [](const std::string& label) {
        return label == "plasticity" || label == "nonlinear_elasticity";
    };
    if (a == b || !bends(a) || !bends(b))
        return false;
    return std::none_of(data.runs.begin(), data.runs.end(), [](const RecordedRun& run) {
        return std::any_of(run.legs.begin(), run.legs.end(), [](const Leg& l) { return l.phase == Phase::Unloading; });
    });
}

} // namespace supercircle::diagnosis
