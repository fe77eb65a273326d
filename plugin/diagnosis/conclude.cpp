#include "plugin/diagnosis/conclude.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::diagnosis {

namespace {

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", v);
    return text;
}

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

std::string named(const Diagnosis& d) {
    const FoundEffect& e = d.effects.front();
    std::string text = "The runs are explained by " + plainWords(e.label) + (e.form.empty() ? "" : " (" + e.form + ")");
    for (std::size_t i = 0; i < e.parameters.size() && i < 4; ++i) {
        const FittedParameter& p = e.parameters[i];
        text += (i == 0 ? ": " : ", ") + p.name + " = " + number(p.value) + (p.unit == "1" ? "" : " " + p.unit);
    }
    text += "; on runs it had not seen the error falls from " + number(d.baselineHeldOut) + " to " +
            number(d.improvedHeldOut) + " N (sensor noise " + number(d.noise.total()) + " N).";
    if (e.group.size() > 1)
        text += " These runs cannot tell it from " + joined(e.group, 1) + ".";
    return text;
}

} // namespace

std::string plainWords(std::string label) {
    std::replace(label.begin(), label.end(), '_', ' ');
    return label;
}

std::string verdictOf(const Evidence& e) {
    const bool gains = e.any && e.gainLow > 0.0 && e.gain > 3.0;
    const bool sure = gains && e.bestGroup >= 0.9;
    if (e.p > 0.05 && !(sure && e.bestGroup >= 0.95 && e.gain > 10.0))
        return e.blind > 0.5 ? "not_enough_information" : "nothing_missing";
    if (!sure && e.nothing >= 0.5 && e.perRow < 1.3)
        return "nothing_missing";
    // What the best effect leaves of the excess over noise.
    const double left = e.perRow > 1.0 ? (e.bestPerRow - 1.0) / (e.perRow - 1.0) : 0.0;
    if (e.unknown >= 0.5 || !e.any || (e.bestPerRow > 2.5 && left > 0.2))
        return "unexplained";
    return sure ? "named" : "ambiguous";
}

std::string statementOf(const Diagnosis& d, const Evidence& e) {
    if (d.verdict == "nothing_missing")
        return "Inside the stated uncertainties the simulation agrees with all runs to the noise (p = " + number(e.p) +
               " for the largest of " + std::to_string(d.mismatch.family) +
               " window statistics): nothing is missing that these runs could show." + blindSpots(d);
    if (d.verdict == "not_enough_information")
        return "The simulation agrees with the runs, but most effects of the catalogue could be there at a size that "
               "matters without being seen: these runs do not decide.";
    if (d.verdict == "named")
        return named(d);
    if (d.verdict == "unexplained")
        return "Something is missing (p = " + number(e.p) + "), and no effect of the catalogue accounts for it" +
               (d.effects.empty() ? std::string(".")
                                  : "; the nearest is " + plainWords(d.effects.front().label) + ", which leaves " +
                                        number(d.improvedHeldOut) + " N on unseen runs with a noise of " +
                                        number(d.noise.total()) + " N.");
    std::string text = "Something is missing (p = " + number(e.p) + "), but these runs do not decide between ";
    std::vector<std::string> rivals;
    for (std::size_t i = 0; i < d.effects.size() && i < 3; ++i)
        rivals.push_back(d.effects[i].label);
    text += joined(rivals) + ".";
    if (d.next)
        text += " Next: " + d.next->what + ".";
    return text;
}

} // namespace supercircle::diagnosis
