#include "tests/blind_benchmark/scoring/case_score.h"
#include "tests/reference_simulator/json_text.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace supercircle::blind_benchmark {

namespace {

using Json = nlohmann::json;

Json read(const std::string& file) {
    std::ifstream in(file);
    if (!in)
        throw std::runtime_error(file + ": cannot be read");
    try {
        return reference_simulator::parseJson(in);
    } catch (const Json::exception& e) {
        throw std::runtime_error(file + ": " + e.what());
    }
}

bool has(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

/// The parameter that is the amplitude of an effect, and its value without the effect.
struct Amplitude {
    const char* name;
    double off;
};

const std::multimap<std::string, Amplitude>& amplitudes() {
    static const std::multimap<std::string, Amplitude> kAmplitudes = {
        {"viscoelastic_bending", {"eta_over_B_s", 0.0}},
        {"viscoelastic_bending", {"branch_over_B", 0.0}},
        {"nonlinear_elasticity", {"uc_1_m", 0.0}},
        {"plasticity", {"My_over_B_1_m", 0.0}},
        {"local_damage", {"stiffness_drop", 0.0}},
        {"natural_curvature_defect", {"curvature_change_1_m", 0.0}},
        {"stiffness_gradient", {"gradient", 0.0}},
        {"softening_over_time", {"drop", 0.0}},
        {"planar_drag", {"f_N_m", 0.0}},
        {"gravity", {"y_m_s2", 0.0}},
        {"static_friction_excess", {"mu_s_over_mu_k", 1.0}},
        {"rate_dependent_friction", {"strength", 0.0}},
        {"wear", {"change", 0.0}},
        {"adhesion", {"F_a_N_m", 0.0}},
        {"contact_compliance", {"tangential_m_N", 0.0}},
        {"machine_compliance", {"k_N_m", 0.0}},
        {"backlash", {"play_m", 0.0}},
        {"misalignment", {"offset_m", 0.0}},
        {"misalignment", {"tilt_rad", 0.0}},
        {"sensor_drift", {"a_N", 0.0}},
        {"sensor_gain", {"error", 0.0}},
        {"sensor_delay", {"delay_s", 0.0}},
    };
    return kAmplitudes;
}

struct TimeSpan {
    double from = 0.0, to = 0.0;
};

std::vector<TimeSpan> joined(std::vector<TimeSpan> all) {
    std::sort(all.begin(), all.end(), [](const TimeSpan& a, const TimeSpan& b) { return a.from < b.from; });
    std::vector<TimeSpan> out;
    for (const TimeSpan& s : all)
        if (!out.empty() && s.from <= out.back().to)
            out.back().to = std::max(out.back().to, s.to);
        else
            out.push_back(s);
    return out;
}

double length(const std::vector<TimeSpan>& all) {
    double sum = 0.0;
    for (const TimeSpan& s : all)
        sum += s.to - s.from;
    return sum;
}

using Reading = std::pair<std::string, std::string>; ///< run and channel

/// Joined intervals of each reading, of entries with a single run.
std::map<Reading, std::vector<TimeSpan>> intervalsOf(const Json& entries, bool forceOnly) {
    std::map<Reading, std::vector<TimeSpan>> out;
    for (const Json& w : entries) {
        const std::string channel = w.value("channel", "force");
        if (w.at("run") != "all" && (channel == "force" || !forceOnly))
            out[{w.at("run"), channel}].push_back({w.at("t_start_s"), w.at("t_end_s")});
    }
    for (auto& [reading, all] : out)
        all = joined(all);
    return out;
}

/// Intersection over union in seconds, all readings together; -1: no true interval.
double overlap(const Json& truth, const Json& marked, bool forceOnly) {
    auto a = intervalsOf(truth, forceOnly), b = intervalsOf(marked, forceOnly);
    if (a.empty())
        return -1.0;
    double both = 0.0, any = 0.0;
    for (const auto& [reading, all] : a)
        b[reading];
    for (const auto& [reading, of] : b) {
        std::vector<TimeSpan> together = a[reading];
        together.insert(together.end(), of.begin(), of.end());
        const double sum = length(joined(together));
        any += sum;
        both += length(a[reading]) + length(of) - sum;
    }
    return both / any;
}

/// Variant of the law of a hidden effect, as the diagnosis calls it. Empty: a single variant, or the names of the
/// parameters differ.
std::string variantOf(const Json& hidden) {
    static const std::map<std::string, std::vector<std::string>> kByIndex = {
        {"rate_dependent_friction", {"Stribeck", "logarithmic", "viscous"}},
        {"stiffness_gradient", {"thickness", "modulus"}}};
    if (hidden.value("family", "") == "softening_moment")
        return "softening";
    const auto variants = kByIndex.find(hidden.at("label").get<std::string>());
    const Json& parameters = hidden.at("parameters");
    return variants == kByIndex.end() || !parameters.contains("law")
               ? std::string()
               : variants->second.at(parameters.at("law").get<std::size_t>());
}

/// Compares parameters of the same variant only: in other variants the same name has another meaning.
void compareParameters(const Json& hidden, const Json& effect, CaseScore& j) {
    const std::string variant = variantOf(hidden), fitted = effect.value("law", "");
    if (!variant.empty() && !fitted.empty()) {
        j.otherVariant = fitted.compare(0, variant.size(), variant) != 0;
        if (*j.otherVariant)
            return;
    }
    const Json &truth = hidden.at("parameters"), &found = effect.at("parameters");
    const auto [from, to] = amplitudes().equal_range(hidden.at("label"));
    for (auto s = from; s != to; ++s)
        if (truth.contains(s->second.name) && found.contains(s->second.name)) {
            const double is = truth.at(s->second.name).get<double>() - s->second.off;
            const Json& value = found.at(s->second.name).at("value");
            if (is != 0.0 && value.is_number()) {
                const double ratio = (value.get<double>() - s->second.off) / is;
                // With an unresolved sign only the magnitude is compared.
                j.amplitudeError =
                    std::abs((found.at(s->second.name).value("resolves_sign", true) ? ratio : std::abs(ratio)) - 1.0);
            }
        }
    for (const auto& [name, value] : truth.items())
        if (found.contains(name) && found.at(name).at("ci90").at(0).is_number() &&
            found.at(name).at("ci90").at(1).is_number()) {
            const bool magnitude = !found.at(name).value("resolves_sign", true);
            const Json& ci = found.at(name).at(magnitude ? "strength_ci90" : "ci90");
            const double is = magnitude ? std::abs(value.get<double>()) : value.get<double>();
            ++j.intervals;
            j.covered += is >= ci.at(0) && is <= ci.at(1) ? 1 : 0;
        }
    if (truth.contains("arc_fraction") && found.contains("arc_fraction"))
        j.positionError =
            std::abs(truth.at("arc_fraction").get<double>() - found.at("arc_fraction").at("value").get<double>());
}

/// Probability of the truth, and the Brier score. Classes are: adequate, outside the catalogue, the true effect with
/// its confounded ones, and every other effect. An effect counts with its probability of being present but
/// undetectable.
void scoreProbabilities(const Json& d, CaseScore& j) {
    j.pAdequate = d.at("probability_adequate");
    j.pOutside = d.at("probability_outside_catalogue");
    std::vector<std::string> accepted = j.truth;
    for (const Json& e : d.at("effects"))
        if (has(j.truth, e.at("label")))
            for (const Json& g : e.at("confounded_with"))
                accepted.push_back(g);
    const bool outside = j.kind == "removed" || j.kind == "outside", noEffect = j.kind == "nothing";
    double others = 0.0;
    j.pTruth = noEffect ? j.pAdequate : outside ? j.pOutside : 0.0;
    std::map<std::string, double> labels;
    for (const Json& e : d.at("effects"))
        labels[e.at("label")] += e.at("probability").get<double>();
    for (const Json& s : d.value("screening", Json::array()))
        labels[s.at("label")] += s.value("probability_undetectable", 0.0);
    for (const auto& [label, p] : labels) {
        if (!noEffect && !outside && has(accepted, label))
            j.pTruth += p;
        else
            others += p * p;
    }
    j.pTruth = std::min(1.0, j.pTruth); // both effects of a pair have the probability of the pair
    others += noEffect ? 0.0 : j.pAdequate * j.pAdequate;
    others += outside ? 0.0 : j.pOutside * j.pOutside;
    j.brier = 0.5 * ((1.0 - j.pTruth) * (1.0 - j.pTruth) + others);
}

void compareErrors(const Json& answer, const Json& d, CaseScore& j) {
    double squares = 0.0, rows = 0.0;
    for (const Json& r : answer.at("runs")) {
        const double e = r.at("rms_noise_N"), n = r.at("rows");
        squares += n * e * e;
        rows += n;
    }
    const bool claims = j.verdict == "identified" || j.verdict == "ambiguous" || j.verdict == "outside_catalogue";
    const Json& fit = d.at("fit");
    const Json& used = claims && !fit.at("improved").is_null() ? fit.at("improved") : fit.at("baseline");
    const double held = used.at("heldout_rmse_N");
    j.overNoise = held / std::sqrt(squares / rows);
    for (const Json& e : d.at("effects"))
        if (has(j.truth, e.at("label")) && e.at("heldout_rmse_N").get<double>() > 0.0)
            j.overTrueModel = held / e.at("heldout_rmse_N").get<double>();
}

} // namespace

CaseScore scoreCase(const std::string& answerFile, const std::string& diagnosisFile) {
    const Json answer = read(answerFile), d = read(diagnosisFile);
    CaseScore j;
    try {
        j.name = answer.at("case");
        j.kind = answer.at("kind");
        j.strength = answer.at("strength");
        j.protocol = answer.at("protocol");
        j.truth = answer.at("labels").get<std::vector<std::string>>();
        j.detectable = answer.at("detectable");
        j.verdict = d.at("verdict");
        j.statement = d.at("statement");
        j.seconds = d.at("timing").at("elapsed_s");
        j.detected = j.verdict == "identified" || j.verdict == "ambiguous" || j.verdict == "outside_catalogue";
        const Json& effects = d.at("effects");
        if (!effects.empty()) {
            j.firstLabel = effects.front().at("label");
            j.confounded = effects.front().at("confounded_with").get<std::vector<std::string>>();
            j.pFirst = effects.front().at("probability");
            for (const Json& p : effects.front().at("parameters"))
                j.signUnresolved = j.signUnresolved || !p.value("resolves_sign", true);
        }
        j.firstLabelRight = has(j.truth, j.firstLabel);
        const bool groupRight = std::any_of(j.truth.begin(), j.truth.end(), [&](const std::string& t) {
            return has(j.confounded, t) || t == j.firstLabel;
        });
        const bool outside = j.kind == "removed" || j.kind == "outside";
        const bool names = j.verdict == "identified" || j.verdict == "ambiguous";
        j.right = j.kind == "nothing" ? !j.detected : outside ? j.verdict == "outside_catalogue" : names && groupRight;
        scoreProbabilities(d, j);
        if (j.kind != "nothing" && j.detected) {
            const Json& where = answer.at("windows");
            const bool forceOnly =
                where.empty() || !where.front().contains("channel"); // early answers list intervals of the force only
            j.overlap = overlap(where, d.at("misfit_intervals"), forceOnly);
            j.overlapForce = overlap(answer.at("windows"), d.at("misfit_intervals"), true);
        }
        if (names && j.kind != "nothing" && !effects.empty() && effects.front().contains("visible_intervals"))
            j.overlapVisible = overlap(answer.at("windows"), effects.front().at("visible_intervals"), true);
        if (names && j.firstLabelRight)
            for (const Json& hidden : answer.at("effects"))
                if (hidden.at("label") == j.firstLabel)
                    compareParameters(hidden, effects.front(), j);
        compareErrors(answer, d, j);
        if (answer.contains("further_own_error")) // null: infinite
            j.proposedRunsOwnError = answer["further_own_error"].is_number() ? answer["further_own_error"].get<double>()
                                                                             : std::numeric_limits<double>::infinity();
        if (!d.at("next_experiment").is_null()) {
            j.nextExperiment = d.at("next_experiment").at("description");
            j.expectedConclusive = d["next_experiment"].at("expected_conclusive");
        }
    } catch (const Json::exception& e) {
        throw std::runtime_error(diagnosisFile + " or " + answerFile + ": " + e.what());
    }
    return j;
}

bool undecided(const CaseScore& j) {
    return j.verdict == "ambiguous" || j.verdict == "inconclusive" ||
           (j.verdict == "identified" && (j.confounded.size() > 1 || j.signUnresolved));
}

bool resolved(const CaseScore& j) {
    if (j.kind == "nothing")
        return j.verdict == "adequate";
    if (j.kind == "removed" || j.kind == "outside")
        return j.verdict == "outside_catalogue";
    return j.verdict == "identified" && j.firstLabelRight && j.confounded.size() == 1 && !j.signUnresolved;
}

std::vector<ProposedRun> proposedRuns(const std::string& diagnosisFile) {
    const Json d = read(diagnosisFile);
    try {
        std::vector<ProposedRun> out;
        const Json& next = d.at("next_experiment");
        for (const Json& run : next.is_null() ? Json::array() : next.at("runs")) {
            const Json& drive = run.at("drive");
            if (drive.at("time_s").empty()) // a free scene
                return {};
            out.push_back(
                {{drive.at("time_s").get<std::vector<double>>(), drive.at("displacement_m").get<std::vector<double>>()},
                 run.at("sampling_Hz"),
                 run.at("repeats"),
                 run.at("specimen_rotation"),
                 run.at("new_markers_arc_fraction").get<std::vector<double>>(),
                 run.at("markers_sampling_Hz")});
        }
        return out;
    } catch (const Json::exception& e) {
        throw std::runtime_error(diagnosisFile + ": " + e.what());
    }
}

} // namespace supercircle::blind_benchmark
