#include "plugin/identification/diagnosis/result/verdict.h"

#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/identification/diagnosis/result/specimens.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"
#include "plugin/recording/table/rounded.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

constexpr double kSuggestive = 0.75; ///< a smaller probability of "adequate" is a hint, as is p <= kFamilyWise

constexpr double kMentioned = 0.03; ///< smallest probability that is mentioned

std::string joined(const std::vector<std::string>& labels, std::size_t from = 0) {
    std::string out;
    for (std::size_t i = from; i < labels.size(); ++i)
        out += (i == from ? "" : i + 1 == labels.size() ? " and " : ", ") + plainWords(labels[i]);
    return out;
}

/// Effects that could act at a relevant amplitude without being detected.
std::string undetectableSentence(const Diagnosis& d) {
    std::vector<std::string> labels;
    for (const ScreenedEffect& s : d.screening)
        if (s.detectable > 1.0)
            labels.push_back(s.label);
    return labels.empty()
               ? ""
               : " These effects could act at a relevant amplitude without being detected: " + joined(labels) + ".";
}

/// The best learned law, if it is probable.
std::string learnedSentence(const Diagnosis& d) {
    if (d.learned.empty() || d.learned.front().probability < 0.05)
        return {};
    const LearnedLaw& law = d.learned.front();
    return " A law learned from the runs (" + plainWords(law.label) + "): " + law.description + ".";
}

std::string withValues(const FittedEffect& e) {
    std::string text = plainWords(e.label) + (e.variant.empty() ? "" : " (" + e.variant + ")");
    const auto write = [&](const FittedParameter& p) {
        return p.name + " = " + rounded(p.value, 3) + (p.unit == "1" ? "" : " " + p.unit) +
               (p.ci90.signAmbiguous ? " (or with the opposite sign, which these runs do not resolve)" : "");
    };
    for (std::size_t i = 0; i < e.parameters.size() && i < 4; ++i)
        text += (i == 0 ? ": " : ", ") + write(e.parameters[i]);
    for (std::size_t i = 0; i < e.derived.size(); ++i)
        text += (i == 0 ? ", derived: " : ", ") + write(e.derived[i]);
    return text;
}

/// Parameters that one run alone identifies: its held-out error is not a forecast.
std::string identifiedOnlyBySentence(const FittedEffect& e) {
    std::map<std::string, std::string> names; // by run
    for (const FittedParameter& p : e.parameters)
        if (!p.identifiedOnlyBy.empty())
            names[p.identifiedOnlyBy] += (names[p.identifiedOnlyBy].empty() ? "" : ", ") + p.name;
    std::string text;
    for (const auto& [run, numbers] : names)
        text += " " + run + " alone identifies " + numbers + ": its error is that of a fit, not of a prediction.";
    return text;
}

/// Which readings a held-out error is of: free runs are forecast from their beginnings, others are left out.
std::string heldOutReadings(const Diagnosis& d) {
    return d.forecast.runs.empty() ? "on held-out runs" : "in forecasts of the later part of each run";
}

/// Change of the held-out error by the effect. A weak effect, or one visible in markers, hardly changes the error of a
/// single reading; its evidence is the sum over many readings.
std::string heldOutSentence(const Diagnosis& d, const FittedEffect& e) {
    const std::string before = rounded(d.baselineHeldOut, 3), after = rounded(d.improvedHeldOut, 3);
    const std::string noise = " (sensor noise " + rounded(d.noise.total(), 3) + " " + d.unit + ")";
    const double tens = std::round(std::max(0.0, e.gain) / math::log(10.0));
    const std::string change = before == after                         ? "stays at "
                               : d.improvedHeldOut < d.baselineHeldOut ? "falls from " + before + " to "
                                                                       : "rises from " + before + " to ";
    std::string text = heldOutReadings(d) + " the error of a reading " + change + after + " " + d.unit + noise;
    if (!(d.improvedHeldOut < d.baselineHeldOut && before != after) && tens >= 1.0)
        text += ", but all readings together are 10^" + rounded(tens, 6) + " times as probable with it";
    return text + ".";
}

std::string identifiedSentence(const Diagnosis& d) {
    const FittedEffect& e = d.effects.front();
    const bool all = d.residualAfterBest.p > kFamilyWise; // as the table of windows says
    std::string text = (all ? "The runs are explained by " : "Most of the misfit is explained by ") + withValues(e);
    for (const std::string& label : e.jointWith) {
        const auto other = std::find_if(d.effects.begin(), d.effects.end(), [&](const FittedEffect& o) {
            return o.label == label && std::find(o.jointWith.begin(), o.jointWith.end(), e.label) != o.jointWith.end();
        });
        // The values of another hypothesis would not be those of this one.
        text += "; jointly with " + (other != d.effects.end() ? withValues(*other) : plainWords(label));
    }
    text += "; " + heldOutSentence(d, e) + identifiedOnlyBySentence(e);
    if (!all)
        text +=
            " The remaining residual exceeds the noise: another effect acts too, or the law differs, and the fitted "
            "values compensate for it.";
    if (e.confoundedWith.size() > 1)
        text += " These runs cannot distinguish it from " + joined(e.confoundedWith, 1) + ".";
    return text;
}

std::string percent(double p) {
    return record::fixed(100.0 * p, 0) + " %";
}

std::string nextSentence(const Diagnosis& d) {
    if (d.next)
        return " Next experiment: " + describeNext(*d.next) + ".";
    return d.candidateRunsConsidered > 0 ? " " + noRunDiscriminates(d) : "";
}

/// The competing hypotheses with their probabilities.
std::string ambiguousSentence(const Diagnosis& d, const Evidence& e) {
    std::string hypotheses;
    const auto add = [&](const std::string& what, double p) {
        hypotheses += (hypotheses.empty() ? "" : ", ") + what + " " + percent(p);
    };
    std::vector<std::string> mentioned; // effects of one hypothesis are listed once
    for (std::size_t i = 0; i < d.effects.size() && i < 3; ++i) {
        const FittedEffect& f = d.effects[i];
        if ((i > 0 && f.probability <= kMentioned) ||
            std::find(mentioned.begin(), mentioned.end(), f.label) != mentioned.end())
            continue;
        add(plainWords(f.label) + (f.jointWith.empty() ? "" : " with " + joined(f.jointWith)), f.probability);
        mentioned.insert(mentioned.end(), f.jointWith.begin(), f.jointWith.end());
    }
    if (d.adequate > kMentioned)
        add("no missing effect", d.adequate);
    if (d.undetectable() > kMentioned)
        add("another effect too small to be detected", d.undetectable());
    if (d.outsideCatalogue > kMentioned)
        add("an effect outside the catalogue", d.outsideCatalogue);
    std::string text = std::string(e.numbers ? "An effect is missing or a stated number is wrong (p = "
                                             : "An effect is missing (p = ") +
                       rounded(e.p, 3) + "), but " +
                       (e.searched ? "these runs do not decide which: "
                                   : "the time limit ended the search before all effects were tried; so far: ") +
                       hypotheses + ".";
    if (!d.effects.empty() && d.effects.front().confoundedWith.size() > 1)
        text += " They cannot distinguish " + plainWords(d.effects.front().label) + " from " +
                joined(d.effects.front().confoundedWith, 1) + ".";
    return text + nextSentence(d);
}

} // namespace

std::string plainWords(std::string label) {
    std::replace(label.begin(), label.end(), '_', ' ');
    return label;
}

std::string titleOf(const Diagnosis& d) {
    return d.wrongNumber ? "A stated number is wrong" : verdictTitle(d.verdict);
}

std::string verdictTitle(const std::string& verdict) {
    if (verdict == "adequate")
        return "The simulation is adequate";
    if (verdict == "identified")
        return "A missing effect is identified";
    if (verdict == "outside_catalogue")
        return "An effect outside the catalogue is missing";
    return verdict == "ambiguous" ? "An effect is missing, but these runs do not decide which"
                                  : "These runs are inconclusive";
}

double screeningP(const ScreenedEffect& effect) {
    return math::erfc(std::sqrt(0.5 * std::max(0.0, effect.gain)));
}

double undetectableShare(const std::vector<ScreenedEffect>& screening) {
    constexpr double kNoticeable = 5.0; // sigma
    double relevant = 0.0, undetectable = 0.0;
    for (const ScreenedEffect& s : screening)
        if (s.signatureNorm > kNoticeable) {
            relevant += 1.0;
            undetectable += s.detectable > 1.0 ? 1.0 : 0.0;
        }
    return relevant > 0.0 ? undetectable / relevant : 1.0;
}

std::string verdictOf(const Evidence& e) {
    // The model weights contain the family-wise p-value, held-out gains and the residual of the best hypothesis.
    if (!(e.adequate >= 0.0 && e.outsideCatalogue >= 0.0)) // numerical failure
        return "outside_catalogue";
    if (e.adequate >= 0.5)
        return e.undetectable > 0.5 || e.adequate < kSuggestive || e.p <= kFamilyWise || !e.forecastHolds
                   ? "inconclusive"
                   : "adequate";
    if (e.p > kFamilyWise) // the misfit is not significant
        return "inconclusive";
    if (e.outsideCatalogue >= 0.5 || !e.any)
        return e.searched ? "outside_catalogue" : "ambiguous"; // an effect that was not tried may explain it
    const bool gains = (e.gainLow > 0.0 && e.gain > 3.0) || e.gain > kBeyondChance;
    if (!(e.groupProbability >= 0.9 && gains && e.forecastHolds))
        return "ambiguous";
    return e.numbersOnly ? "inconclusive" : e.numbers ? "ambiguous" : "identified";
}

bool isWrongNumber(Evidence e) {
    if (!e.numbersOnly)
        return false;
    e.numbersOnly = e.numbers = false;
    return verdictOf(e) == "identified";
}

namespace {

/// Amplitudes of the nearest hypothesis at the end of their plausible range.
std::string amplitudesBeyondRange(const Diagnosis& d) {
    const FittedEffect& first = d.effects.front();
    std::string text;
    for (const FittedEffect& e : d.effects) {
        if (&e != &first && std::find(first.jointWith.begin(), first.jointWith.end(), e.label) == first.jointWith.end())
            continue;
        for (const FittedParameter& p : e.parameters)
            if (std::find(e.atBound.begin(), e.atBound.end(), p.name) != e.atBound.end())
                text += (text.empty() ? "" : ", ") + p.name + " beyond " + rounded(p.value, 3) +
                        (p.unit == "1" ? "" : " " + p.unit);
    }
    return text.empty() ? text : ", but only with an implausibly large amplitude (" + text + ")";
}

/// That the nearest law leaves more than noise, where a window shows it.
std::string leftSentence(const Diagnosis& d) {
    return d.residualAfterBest.significant.empty()
               ? std::string()
               : " What it leaves is more than noise (p = " + rounded(d.residualAfterBest.p, 3) +
                     "): its law differs, or something else acts too.";
}

/// Runs whose rest the law does not forecast from their beginning.
std::string forecastSentence(const Diagnosis& d) {
    std::string text;
    for (const RunForecast& run : d.forecast.runs)
        if (!run.holds)
            text += (text.empty() ? " The forecast does not hold for " : ", ") + run.run + " (squared error " +
                    rounded(run.squares, 3) + " a reading, at least " + rounded(run.atLeast, 3) +
                    "; a forecast that holds leaves 1)";
    return text.empty() ? text : text + ".";
}

/// The numbers that are wrong, and what they should be.
std::string wrongNumberSentence(const Diagnosis& d) {
    const FittedEffect& first = d.effects.front();
    const auto write = [&](const FittedEffect& e) {
        if (e.slot != kDescription)
            return withValues(e);
        const FittedParameter& p = e.parameters.front();
        const std::string unit = p.unit == "1" ? "" : " " + p.unit;
        const auto stated =
            std::find_if(d.nominal.begin(), d.nominal.end(), [&](const NominalResult& n) { return n.name == p.name; });
        return p.name + " is " + rounded(p.value, 3) + unit +
               (stated == d.nominal.end()
                    ? std::string()
                    : ", stated as " + rounded(stated->stated, 4) + " +- " + rounded(stated->uncertainty, 2) + unit);
    };
    const auto find = [&](const std::string& label) {
        return std::find_if(d.effects.begin(), d.effects.end(),
                            [&](const FittedEffect& e) { return e.label == label; });
    };
    std::string text = "A stated number is wrong: " + write(first);
    for (const std::string& label : first.jointWith)
        if (const auto other = find(label); other != d.effects.end()) {
            text += "; and " + write(*other);
            std::string instead;
            for (std::size_t i = 1; i < other->confoundedWith.size(); ++i)
                if (const auto third = find(other->confoundedWith[i]); third != d.effects.end())
                    instead += (instead.empty() ? " (or else " : ", or ") + write(*third);
            text += instead.empty() ? "" : instead + ")";
        }
    for (std::size_t i = 1; i < first.confoundedWith.size(); ++i)
        if (const auto other = find(first.confoundedWith[i]); other != d.effects.end())
            text += "; or else " + write(*other) +
                    (other->jointWith.empty() ? "" : " (with " + joined(other->jointWith) + ")");
    return text + "; " + heldOutSentence(d, first) + " Correct the description and diagnose again.";
}

/// That runs want different numbers, where nothing else explains them.
std::string homogeneitySentence(const Diagnosis& d) {
    const Homogeneity& h = d.homogeneity;
    if (!h.differ() || h.values.empty() || d.wrongNumber || d.verdict == "identified" || d.verdict == "ambiguous")
        return {};
    const auto [least, most] = std::minmax_element(h.values.begin(), h.values.end(),
                                                   [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::string unit = h.unit == "1" ? "" : " " + h.unit;
    return " The runs want different numbers (p = " + rounded(h.p, 2) + "): " + plainWords(h.number) + " " +
           rounded(least->second, 4) + unit + " in " + least->first + " and " + rounded(most->second, 4) + unit +
           " in " + most->first + " explain most of it.";
}

std::string verdictSentence(const Diagnosis& d, const Evidence& e) {
    if (d.wrongNumber)
        return wrongNumberSentence(d);
    if (d.verdict == "adequate")
        return "Inside the stated uncertainties the simulation agrees with all runs to within noise (p = " +
               rounded(e.p, 3) + " for the largest of " + std::to_string(d.misfit.familySize) +
               " statistics): no detectable effect is missing" +
               (d.undetectable() > kMentioned
                    ? " (probability " + rounded(d.adequate, 2) + " that none is missing, " +
                          rounded(d.undetectable(), 2) + " that one is too small to be detected)."
                    : ".") +
               undetectableSentence(d);
    if (d.verdict == "inconclusive" && (e.adequate < kSuggestive || e.p <= kFamilyWise)) {
        const std::string likely =
            d.effects.empty() ? std::string() : ", most probably " + plainWords(d.effects.front().label);
        return (e.adequate < kSuggestive ? "There is weak evidence of a missing effect (p = "
                                         : "The misfit is significant (p = ") +
               rounded(e.p, 3) + " for the largest of " + std::to_string(d.misfit.familySize) + " statistics)" +
               likely +
               (e.adequate < kSuggestive ? ", too weak to decide: "
                                         : ", but too small to conclude that an effect is missing: ") +
               "the probability that no detectable effect is missing is " + rounded(e.adequate, 3) + "." +
               nextSentence(d);
    }
    if (d.verdict == "inconclusive" && !e.forecastHolds)
        return "The simulation agrees with the runs to within noise, but a fit to their beginning does not forecast "
               "the rest: these runs do not decide." +
               nextSentence(d);
    if (d.verdict == "inconclusive")
        return "The simulation agrees with the runs, but most effects of the catalogue could act at a relevant "
               "amplitude "
               "without being detected: these runs do not decide." +
               nextSentence(d);
    if (d.verdict == "identified")
        return identifiedSentence(d) + nextSentence(d);
    if (d.verdict == "outside_catalogue")
        return "An effect is missing (p = " + rounded(e.p, 3) + "), and no effect of the catalogue explains it" +
               (d.effects.empty() ? std::string(".")
                                  : "; the nearest is " + plainWords(d.effects.front().label) + ", with an error of " +
                                        rounded(d.improvedHeldOut, 3) + " " + d.unit + " " + heldOutReadings(d) +
                                        " at a noise of " + rounded(d.noise.total(), 3) + " " + d.unit +
                                        amplitudesBeyondRange(d) + "." + leftSentence(d)) +
               learnedSentence(d);
    return ambiguousSentence(d, e);
}

} // namespace

std::string statementOf(const Diagnosis& d, const Evidence& e) {
    const std::string text =
        verdictSentence(d, e) + specimensSentence(d.batch) + homogeneitySentence(d) + forecastSentence(d);
    if (d.noise.disturbance <= 0.0)
        return text;
    return text +
           (d.noise.disturbanceInResidual ? " All runs contain a periodic disturbance with an amplitude of "
                                          : " Dwell intervals contain a periodic disturbance with an amplitude of ") +
           rounded(d.noise.disturbance, 3) + " " + d.unit + " and a period of " +
           rounded(d.noise.disturbancePeriod, 3) +
           " s. It is not caused by the specimen (check pumps, mains, building vibration).";
}

bool structurallyIndistinguishable(const RecordedData& data, const std::string& a, const std::string& b) {
    const auto bends = [](const std::string& label) {
        return label == "plasticity" || label == "nonlinear_elasticity";
    };
    if (a == b || !bends(a) || !bends(b))
        return false;
    return std::none_of(data.runs.begin(), data.runs.end(), [](const RecordedRun& run) {
        return std::any_of(run.segments.begin(), run.segments.end(),
                           [](const DriveSegment& l) { return l.phase == Phase::Unloading; });
    });
}

} // namespace supercircle::diagnosis
