#include "tests/blind_benchmark/scoring/scores.h"
#include "tests/reference_simulator/json_text.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

namespace supercircle::blind_benchmark {

namespace {

Score scoreOf(const std::string& name, const Proportion& s, const std::string& target, double least,
              bool atMost = false) {
    Score out{name, target, s.value(), s.low(), s.high(), static_cast<std::size_t>(s.of), -1};
    if (!target.empty() && s.of > 0)
        out.met = (atMost ? s.value() <= least : s.value() >= least) ? 1 : 0;
    return out;
}

Score scoreOf(const std::string& name, const Estimate& m, const std::string& target, double bound, bool atMost) {
    Score out{name, target, m.value, m.low, m.high, m.of, -1};
    if (!target.empty() && m.of > 0)
        out.met = (atMost ? m.value <= bound : m.value >= bound) ? 1 : 0;
    return out;
}

std::string number(double v, const char* format = "%.3f") {
    char text[40];
    std::snprintf(text, sizeof text, format, v);
    return text;
}

std::string padded(std::string s, std::size_t width) {
    s.resize(std::max(width, s.size() + 1), ' ');
    return s;
}

std::string joined(const std::vector<std::string>& all, const char* between = " + ") {
    std::string out;
    for (const std::string& s : all)
        out += (out.empty() ? "" : between) + s;
    return out;
}

/// Short answer of the diagnosis.
std::string diagnosed(const CaseScore& j) {
    if (j.verdict == "identified")
        return j.firstLabel;
    return j.verdict == "ambiguous" && !j.firstLabel.empty() ? "ambiguous: " + j.firstLabel : j.verdict;
}

std::string hidden(const CaseScore& j) {
    if (j.kind == "removed" || j.kind == "outside")
        return "(" + j.kind + ") " + joined(j.truth);
    return j.kind == "nothing" ? "nothing" : joined(j.truth);
}

std::string escaped(const std::string& s) {
    std::string out;
    for (const char c : s)
        out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

using Confusion = std::map<std::string, std::map<std::string, int>>;

Confusion confusionOf(const std::vector<CaseScore>& all) {
    Confusion c;
    for (const CaseScore& j : all)
        ++c[hidden(j)][diagnosed(j)];
    return c;
}

/// "plasticity 2; adequate 1"
std::string counted(const std::map<std::string, int>& row) {
    std::string out;
    for (const auto& [answer, n] : row)
        out += (out.empty() ? "" : "; ") + answer + " " + std::to_string(n);
    return out;
}

/// Reliability: probability of the first effect against how often it was true.
std::string reliability(const std::vector<CaseScore>& all) {
    const double edges[] = {0.0, 0.5, 0.8, 0.95, 1.0001};
    std::string out =
        "reliability: probability of the first effect and how often it was true (single effects, first label):\n";
    for (int b = 0; b < 4; ++b) {
        Proportion s;
        double sum = 0.0;
        for (const CaseScore& j : all)
            if (j.kind == "single" && j.pFirst >= edges[b] && j.pFirst < edges[b + 1]) {
                s.count(j.firstLabelRight);
                sum += j.pFirst;
            }
        if (s.of > 0)
            out += "  stated " + number(sum / s.of, "%.2f") + ", true " + number(s.value(), "%.2f") + " [" +
                   number(s.low(), "%.2f") + ", " + number(s.high(), "%.2f") + "], " + std::to_string(s.of) +
                   " cases\n";
    }
    return out;
}

/// How often an effect was detected and right, by detectability.
std::string power(const std::vector<CaseScore>& all) {
    const double edges[] = {0.0, 4.0, 6.0, 8.0, 10.0, 12.5, 50.0, 1e9};
    std::string out =
        "signal to the best possible test (standard deviations of its statistic), and what was detected and "
        "right:\n";
    for (int b = 0; b < 7; ++b) {
        Proportion detected, right;
        for (const CaseScore& j : all)
            if (j.kind != "nothing" && j.detectable >= edges[b] && j.detectable < edges[b + 1]) {
                detected.count(j.detected);
                right.count(j.right);
            }
        if (detected.of > 0)
            out +=
                "  " +
                padded(number(edges[b], "%.3g") + (b < 6 ? " to " + number(edges[b + 1], "%.3g") : " and more"), 14) +
                "detected " + std::to_string(detected.hits) + ", right " + std::to_string(right.hits) + " of " +
                std::to_string(detected.of) + "\n";
    }
    return out;
}

} // namespace

std::vector<Score> scoresOf(const std::vector<CaseScore>& all) {
    Proportion strong, weak, falseAlarms, identified, group, first, pairs, outside, outsideOrAmbiguous, covered,
        variants;
    std::vector<double> overlaps, overlapsStrong, overlapsForce, overlapsVisible, amplitudes, amplitudesStrong, noise,
        trueModel, brier, places, seconds;
    for (const CaseScore& j : all) {
        const bool hasEffect = j.kind != "nothing", one = j.kind == "single";
        const bool isWeak = j.strength == "weak" || j.strength == "limit";
        if (hasEffect)
            (isWeak ? weak : strong).count(j.detected);
        else
            falseAlarms.count(j.detected);
        if (one && j.verdict == "identified")
            identified.count(j.right);
        if (one && j.detected) {
            group.count(j.right);
            first.count(j.firstLabelRight);
        }
        if (j.kind == "pair" && j.detected)
            pairs.count(j.right);
        if (j.kind == "removed" || j.kind == "outside") {
            outside.count(j.verdict == "outside_catalogue");
            outsideOrAmbiguous.count(j.verdict == "outside_catalogue" || j.verdict == "ambiguous");
        }
        covered.hits += j.covered;
        covered.of += j.intervals;
        if (j.otherVariant)
            variants.count(!*j.otherVariant);
        const auto put = [](std::vector<double>& to, double v) {
            if (v >= 0.0)
                to.push_back(v);
        };
        put(overlaps, j.overlap);
        put(overlapsStrong, isWeak ? -1.0 : j.overlap);
        put(overlapsForce, j.overlapForce);
        put(overlapsVisible, j.overlapVisible);
        put(amplitudes, one ? j.amplitudeError : -1.0);
        put(amplitudesStrong, one && !isWeak ? j.amplitudeError : -1.0);
        put(places, j.positionError);
        put(noise, one && j.right ? j.overNoise : -1.0);
        put(trueModel, one && j.detected ? j.overTrueModel : -1.0);
        put(brier, j.kind == "pair" ? -1.0 : j.brier);
        put(seconds, j.seconds);
    }
    return {
        scoreOf("detected, strong effects", strong, ">= 0.95", 0.95),
        scoreOf("detected, weak effects (near the detection limit)", weak, "", 0.0),
        scoreOf("false alarms, nothing hidden", falseAlarms, "<= 0.05", 0.05, true),
        scoreOf("identified: effect or confounded group right", identified, ">= 0.90", 0.9),
        scoreOf("detected singles: first effect or confounded group right", group, ">= 0.90", 0.9),
        scoreOf("detected singles: first label right", first, "", 0.0),
        scoreOf("detected pairs: the first is one of the two", pairs, "", 0.0),
        scoreOf("overlap of misfit and true visible intervals, median IoU", median(overlaps), ">= 0.65", 0.65, false),
        scoreOf("the same, strong effects", median(overlapsStrong), "", 0.0, false),
        scoreOf("the same, force alone", median(overlapsForce), "", 0.0, false),
        scoreOf("overlap of stated and true visible intervals, median IoU", median(overlapsVisible), ">= 0.65", 0.65,
                false),
        scoreOf("relative error of the amplitude, median", median(amplitudes), "<= 0.10", 0.10, true),
        scoreOf("the same, strong effects", median(amplitudesStrong), "", 0.0, true),
        scoreOf("variant of the law right, of laws with several", variants, "", 0.0),
        scoreOf("90 % intervals that hold the truth, right variant", covered, "0.85 - 0.95", 0.85),
        scoreOf("position on the specimen, median error of the arc fraction", median(places), "", 0.0, true),
        scoreOf("held-out error over noise floor, median", median(noise), "<= 1.15", 1.15, true),
        scoreOf("held-out error over that of the true effect, median", median(trueModel), "<= 1.05", 1.05, true),
        scoreOf("not in the catalogue: outside_catalogue", outside, ">= 0.80", 0.8),
        scoreOf("not in the catalogue: outside_catalogue or ambiguous", outsideOrAmbiguous, "", 0.0),
        scoreOf("Brier score, mean", mean(brier), "<= 0.10", 0.10, true),
        scoreOf("seconds per case, median", median(seconds), "", 0.0, true)};
}

std::string asText(const std::vector<CaseScore>& all, const std::string& title) {
    std::string out = title + ": " + std::to_string(all.size()) + " cases; 90 % intervals\n\n";
    for (const Score& s : scoresOf(all))
        out += padded(s.name, 62) + padded(s.of > 0 ? number(s.value) : "-", 8) +
               padded(s.of > 0 ? "[" + number(s.low) + ", " + number(s.high) + "]" : "", 18) +
               padded("n " + std::to_string(s.of), 8) + padded(s.target, 13) +
               (s.met < 0    ? ""
                : s.met == 1 ? "met"
                             : "MISSED") +
               "\n";
    out += "\n" + reliability(all) + "\n" + power(all) + "\nhidden: diagnosed\n";
    for (const auto& [truth, row] : confusionOf(all))
        out += "  " + padded(truth, 48) + counted(row) + "\n";
    out += "\ncases\n";
    for (const CaseScore& j : all)
        out += "  " + padded(j.name, 12) + padded(j.protocol, 4) + padded(j.strength, 8) + padded(hidden(j), 44) +
               (j.right ? "ok    " : "MISS  ") + padded(diagnosed(j), 40) + "detectable " +
               number(j.detectable, "%.1f") + ", P(truth) " + number(j.pTruth, "%.2f") + ", error/noise " +
               number(j.overNoise, "%.2f") + (j.overlap < 0.0 ? "" : ", IoU " + number(j.overlap, "%.2f")) +
               (j.overlapVisible < 0.0 ? "" : " (" + number(j.overlapVisible, "%.2f") + ")") +
               (j.amplitudeError < 0.0 ? "" : ", amplitude error " + number(100.0 * j.amplitudeError, "%.0f") + " %") +
               ", " + number(j.seconds, "%.0f") + " s\n";
    return out;
}

std::string asJson(const std::vector<CaseScore>& all, const std::string& title) {
    using OrderedJson = nlohmann::ordered_json;
    OrderedJson scores = OrderedJson::array(), cases = OrderedJson::array();
    for (const Score& s : scoresOf(all)) {
        OrderedJson one = {{"name", s.name}, {"n", s.of}, {"target", s.target}};
        if (s.of > 0) {
            one["value"] = s.value;
            one["ci90"] = {s.low, s.high};
        }
        if (s.met >= 0)
            one["met"] = s.met == 1;
        scores.push_back(one);
    }
    for (const CaseScore& j : all)
        cases.push_back({{"case", j.name},
                         {"kind", j.kind},
                         {"strength", j.strength},
                         {"protocol", j.protocol},
                         {"hidden", j.truth},
                         {"verdict", j.verdict},
                         {"first_label", j.firstLabel},
                         {"confounded_with", j.confounded},
                         {"right", j.right},
                         {"probability_of_truth", j.pTruth},
                         {"brier", j.brier},
                         {"overlap", j.overlap},
                         {"overlap_force", j.overlapForce},
                         {"overlap_visible", j.overlapVisible},
                         {"amplitude_error", j.amplitudeError},
                         {"heldout_over_noise", j.overNoise},
                         {"detectable", j.detectable},
                         {"elapsed_s", j.seconds}});
    return reference_simulator::jsonText(OrderedJson{{"title", title}, {"scores", scores}, {"cases", cases}}) + "\n";
}

std::string asPage(const std::vector<CaseScore>& all, const std::string& title, const std::string& folder) {
    std::string out = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escaped(title) +
                      "</title><style>body{font:15px/1.45 sans-serif;max-width:1200px;margin:2em auto;padding:0 1em}"
                      "td,th{padding:2px 10px;text-align:left;border-bottom:1px solid #ddd}table{border-collapse:"
                      "collapse}img{max-width:100%}.miss{color:#b00}.ok{color:#070}</style><h1>" +
                      escaped(title) +
                      "</h1><table><tr><th>score</th><th>value</th><th>90 % interval</th><th>n</th>"
                      "<th>target</th><th></th></tr>";
    for (const Score& s : scoresOf(all))
        out += "<tr><td>" + escaped(s.name) + "</td><td>" + (s.of > 0 ? number(s.value) : "-") + "</td><td>" +
               number(s.low) + " to " + number(s.high) + "</td><td>" + std::to_string(s.of) + "</td><td>" +
               escaped(s.target) + "</td><td>" +
               (s.met < 0    ? ""
                : s.met == 1 ? "<span class=ok>met</span>"
                             : "<span class=miss>missed</span>") +
               "</td></tr>";
    out += "</table><h2>Hidden and diagnosed</h2><table><tr><th>hidden</th><th>diagnosed</th></tr>";
    for (const auto& [truth, row] : confusionOf(all))
        out += "<tr><td>" + escaped(truth) + "</td><td>" + escaped(counted(row)) + "</td></tr>";
    out += "</table><pre>" + escaped(reliability(all)) + "</pre><h2>Cases, without and with the effect</h2>";
    for (const CaseScore& j : all)
        out += "<h3>" + j.name + " (" + j.protocol + " " + j.strength + "): hidden " + escaped(hidden(j)) +
               ", diagnosed <span class=" + (j.right ? "ok>" : "miss>") + escaped(diagnosed(j)) + "</span></h3><p>" +
               escaped(j.statement) + " <a href=\"" + folder + j.name +
               "/report.html\">report</a></p><img loading=lazy "
               "src=\"" +
               folder + j.name + "/run_1_diagnosis.png\" alt=\"forces and residuals of the first run\">";
    return out + "</html>\n";
}

} // namespace supercircle::blind_benchmark
