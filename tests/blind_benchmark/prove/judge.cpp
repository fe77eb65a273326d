#include "tests/blind_benchmark/prove/judge.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace supercircle::oracle {

namespace {

using Json = nlohmann::json;

Json read(const std::string& file) {
    std::ifstream in(file);
    if (!in)
        throw std::runtime_error(file + ": cannot be read");
    try {
        return Json::parse(in);
    } catch (const Json::exception& e) {
        throw std::runtime_error(file + ": " + e.what());
    }
}

bool has(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

/// The parameter that says how large an effect is, and the value at which it is absent.
struct Size {
    const char* name;
    double off;
};

const std::multimap<std::string, Size>& sizes() {
    static const std::multimap<std::string, Size> kSizes = {
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
    return kSizes;
}

struct Span {
    double from = 0.0, to = 0.0;
};

std::vector<Span> joined(std::vector<Span> all) {
    std::sort(all.begin(), all.end(), [](const Span& a, const Span& b) { return a.from < b.from; });
    std::vector<Span> out;
    for (const Span& s : all)
        if (!out.empty() && s.from <= out.back().to)
            out.back().to = std::max(out.back().to, s.to);
        else
            out.push_back(s);
    return out;
}

double length(const std::vector<Span>& all) {
    double sum = 0.0;
    for (const Span& s : all)
        sum += s.to - s.from;
    return sum;
}

using Reading = std::pair<std::string, std::string>; ///< run and channel

/// Of windows that name a single run.
std::map<Reading, std::vector<Span>> spans(const Json& windows, bool forceOnly) {
    std::map<Reading, std::vector<Span>> out;
    for (const Json& w : windows) {
        const std::string channel = w.value("channel", "force");
        if (w.at("run") != "all" && (channel == "force" || !forceOnly))
            out[{w.at("run"), channel}].push_back({w.at("t_start_s"), w.at("t_end_s")});
    }
    for (auto& [reading, all] : out)
        all = joined(all);
    return out;
}

/// Seconds in both over seconds in either, of all readings together; -1: nothing is hidden in them.
double overlap(const Json& truth, const Json& marked, bool forceOnly) {
    auto a = spans(truth, forceOnly), b = spans(marked, forceOnly);
    if (a.empty())
        return -1.0;
    double both = 0.0, any = 0.0;
    for (const auto& [reading, all] : a)
        b[reading];
    for (const auto& [reading, of] : b) {
        std::vector<Span> together = a[reading];
        together.insert(together.end(), of.begin(), of.end());
        const double sum = length(joined(together));
        any += sum;
        both += length(a[reading]) + length(of) - sum;
    }
    return both / any;
}

/// The form of a hidden effect's law as the diagnosis calls it; empty: it has one form, or its numbers' names tell.
std::string formOf(const Json& hidden) {
    static const std::map<std::string, std::vector<std::string>> kByNumber = {
        {"rate_dependent_friction", {"Stribeck", "logarithmic", "viscous"}},
        {"stiffness_gradient", {"thickness", "modulus"}}};
    if (hidden.value("family", "") == "softening_moment")
        return "softening";
    const auto forms = kByNumber.find(hidden.at("label").get<std::string>());
    const Json& parameters = hidden.at("parameters");
    return forms == kByNumber.end() || !parameters.contains("law")
               ? std::string()
               : forms->second.at(parameters.at("law").get<std::size_t>());
}

/// Where two forms of a law have numbers of the same name, these do not mean the same.
void compareParameters(const Json& hidden, const Json& effect, Judged& j) {
    const std::string form = formOf(hidden), said = effect.value("law", "");
    if (!form.empty() && !said.empty()) {
        j.otherForm = said.compare(0, form.size(), form) != 0;
        if (*j.otherForm)
            return;
    }
    const Json &truth = hidden.at("parameters"), &found = effect.at("parameters");
    const auto [from, to] = sizes().equal_range(hidden.at("label"));
    for (auto s = from; s != to; ++s)
        if (truth.contains(s->second.name) && found.contains(s->second.name)) {
            const double is = truth.at(s->second.name).get<double>() - s->second.off;
            const Json& value = found.at(s->second.name).at("value");
            if (is != 0.0 && value.is_number()) {
                const double ratio = (value.get<double>() - s->second.off) / is;
                // Where the answer says that the side is not told only the size is an answer.
                j.amplitudeError =
                    std::abs((found.at(s->second.name).value("either_side", false) ? std::abs(ratio) : ratio) - 1.0);
            }
        }
    for (const auto& [name, value] : truth.items())
        if (found.contains(name) && found.at(name).at("ci90").at(0).is_number() &&
            found.at(name).at("ci90").at(1).is_number()) {
            const bool size = found.at(name).value("either_side", false); // all that it says
            const Json& ci = found.at(name).at(size ? "size_ci90" : "ci90");
            const double is = size ? std::abs(value.get<double>()) : value.get<double>();
            ++j.intervals;
            j.covered += is >= ci.at(0) && is <= ci.at(1) ? 1 : 0;
        }
    if (truth.contains("arc_fraction") && found.contains("arc_fraction"))
        j.placeError =
            std::abs(truth.at("arc_fraction").get<double>() - found.at("arc_fraction").at("value").get<double>());
}

/// Classes: nothing, unknown, the true effect (with what cannot be told from it), every other effect, whether it was
/// fitted or may be there too small to be seen.
void weigh(const Json& d, Judged& j) {
    j.pNothing = d.at("probability_nothing");
    j.pUnknown = d.at("probability_unknown");
    std::vector<std::string> same = j.truth;
    for (const Json& e : d.at("effects"))
        if (has(j.truth, e.at("label")))
            for (const Json& g : e.at("group"))
                same.push_back(g);
    const bool unknown = j.kind == "removed" || j.kind == "outside", nothing = j.kind == "nothing";
    double others = 0.0;
    j.pTruth = nothing ? j.pNothing : unknown ? j.pUnknown : 0.0;
    std::map<std::string, double> labels;
    for (const Json& e : d.at("effects"))
        labels[e.at("label")] += e.at("probability").get<double>();
    for (const Json& s : d.value("screen", Json::array()))
        labels[s.at("label")] += s.value("probability_unseen", 0.0);
    for (const auto& [label, p] : labels) {
        if (!nothing && !unknown && has(same, label))
            j.pTruth += p;
        else
            others += p * p;
    }
    j.pTruth = std::min(1.0, j.pTruth); // the parts of a pair are both certain
    others += nothing ? 0.0 : j.pNothing * j.pNothing;
    others += unknown ? 0.0 : j.pUnknown * j.pUnknown;
    j.brier = 0.5 * ((1.0 - j.pTruth) * (1.0 - j.pTruth) + others);
}

void compareErrors(const Json& answer, const Json& d, Judged& j) {
    double squares = 0.0, rows = 0.0;
    for (const Json& r : answer.at("runs")) {
        const double e = r.at("rms_noise_N"), n = r.at("rows");
        squares += n * e * e;
        rows += n;
    }
    const bool named = j.verdict == "named" || j.verdict == "ambiguous" || j.verdict == "unexplained";
    const Json& fit = d.at("fit");
    const Json& used = named && !fit.at("improved").is_null() ? fit.at("improved") : fit.at("baseline");
    const double held = used.at("heldout_rmse_N");
    j.overNoise = held / std::sqrt(squares / rows);
    for (const Json& e : d.at("effects"))
        if (has(j.truth, e.at("label")) && e.at("heldout_rmse_N").get<double>() > 0.0)
            j.overKnowing = held / e.at("heldout_rmse_N").get<double>();
}

} // namespace

Judged judge(const std::string& answerFile, const std::string& diagnosisFile) {
    const Json answer = read(answerFile), d = read(diagnosisFile);
    Judged j;
    try {
        j.name = answer.at("case");
        j.kind = answer.at("kind");
        j.strength = answer.at("strength");
        j.protocol = answer.at("protocol");
        j.truth = answer.at("labels").get<std::vector<std::string>>();
        j.detectable = answer.at("detectable");
        j.verdict = d.at("verdict");
        j.statement = d.at("statement");
        j.seconds = d.at("elapsed_s");
        j.detected = j.verdict == "named" || j.verdict == "ambiguous" || j.verdict == "unexplained";
        const Json& effects = d.at("effects");
        if (!effects.empty()) {
            j.first = effects.front().at("label");
            j.group = effects.front().at("group").get<std::vector<std::string>>();
            j.pFirst = effects.front().at("probability");
            for (const Json& p : effects.front().at("parameters"))
                j.eitherSide = j.eitherSide || p.value("either_side", false);
        }
        j.firstRight = has(j.truth, j.first);
        const bool groupRight = std::any_of(j.truth.begin(), j.truth.end(),
                                            [&](const std::string& t) { return has(j.group, t) || t == j.first; });
        const bool unknown = j.kind == "removed" || j.kind == "outside";
        const bool names = j.verdict == "named" || j.verdict == "ambiguous";
        j.right = j.kind == "nothing" ? !j.detected : unknown ? j.verdict == "unexplained" : names && groupRight;
        weigh(d, j);
        if (j.kind != "nothing" && j.detected) {
            const Json& where = answer.at("windows");
            const bool forceOnly = where.empty() || !where.front().contains("channel"); // answers of long ago
            j.overlap = overlap(where, d.at("mismatch"), forceOnly);
            j.overlapForce = overlap(answer.at("windows"), d.at("mismatch"), true);
        }
        if (names && j.kind != "nothing" && d.contains("effect_windows"))
            j.overlapNamed = overlap(answer.at("windows"), d.at("effect_windows"), true);
        if (names && j.firstRight)
            for (const Json& hidden : answer.at("effects"))
                if (hidden.at("label") == j.first)
                    compareParameters(hidden, effects.front(), j);
        compareErrors(answer, d, j);
        if (answer.contains("further_own_error")) // null: infinite
            j.furtherOwnError = answer["further_own_error"].is_number() ? answer["further_own_error"].get<double>()
                                                                        : std::numeric_limits<double>::infinity();
        if (!d.at("next_experiment").is_null()) {
            j.next = d.at("next_experiment").at("what");
            j.wouldSettle = d["next_experiment"].at("settles");
        }
    } catch (const Json::exception& e) {
        throw std::runtime_error(diagnosisFile + " or its answer: " + e.what());
    }
    return j;
}

bool open(const Judged& j) {
    return j.verdict == "ambiguous" || j.verdict == "not_enough_information" ||
           (j.verdict == "named" && (j.group.size() > 1 || j.eitherSide));
}

bool settled(const Judged& j) {
    if (j.kind == "nothing")
        return j.verdict == "nothing_missing";
    if (j.kind == "removed" || j.kind == "outside")
        return j.verdict == "unexplained";
    return j.verdict == "named" && j.firstRight && j.group.size() == 1 && !j.eitherSide;
}

std::vector<Further> proposedRuns(const std::string& diagnosisFile) {
    const Json d = read(diagnosisFile);
    try {
        std::vector<Further> out;
        const Json& next = d.at("next_experiment");
        for (const Json& run : next.is_null() ? Json::array() : next.at("runs")) {
            const Json& drive = run.at("drive");
            if (drive.at("time_s").empty()) // nothing is driven
                return {};
            out.push_back(
                {{drive.at("time_s").get<std::vector<double>>(), drive.at("displacement_m").get<std::vector<double>>()},
                 run.at("sampling_Hz"),
                 run.at("repeats"),
                 run.at("specimen_turned"),
                 run.at("new_markers_arc_fraction").get<std::vector<double>>(),
                 run.at("markers_sampling_Hz")});
        }
        return out;
    } catch (const Json::exception& e) {
        throw std::runtime_error(diagnosisFile + ": " + e.what());
    }
}

} // namespace supercircle::oracle
