#include "plugin/identification/diagnosis/model/own_law.h"

#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace supercircle::diagnosis {

namespace {

/// What a kind of law needs.
struct KindInfo {
    OwnLawKind kind;
    const char* declared; ///< name of what the law changes
    const char* state;
    const char* effect;
    const char* extent;    ///< parameter of the effect that sets the range
    const char* amplitude; ///< switches the effect on; the same as `extent` where there is none
};
constexpr KindInfo kKinds[] = {
    {OwnLawKind::FrictionOfSpeed, "mu", "v", "rate_dependent_friction", "speed_m_s", "strength"},
    {OwnLawKind::FrictionOfSlip, "mu", "s", "wear", "distance_m", "change"},
    {OwnLawKind::Moment, "B", "u", "nonlinear_elasticity", "uc_1_m", "uc_1_m"}};

const KindInfo& infoOf(OwnLawKind kind) {
    return kKinds[static_cast<std::size_t>(kind)];
}

double extentOf(OwnLawKind kind, const OwnLawRange& r) {
    return kind == OwnLawKind::FrictionOfSpeed ? r.speed : kind == OwnLawKind::FrictionOfSlip ? r.slip : r.bend;
}

constexpr int kSegments = static_cast<int>(effects::kTableCoefficients) - 3;

/// The states at the knots of the table.
std::vector<double> knotsOf(OwnLawKind kind, double extent) {
    std::vector<double> at;
    for (int i = 0; i <= kSegments; ++i) {
        const double x = static_cast<double>(i) / kSegments;
        at.push_back(kind == OwnLawKind::FrictionOfSpeed ? extent * math::pow(10.0, (x - 0.5) * effects::kTableDecades)
                                                         : extent * x);
    }
    return at;
}

/// The law over what is declared, less one, at the knots: of a moment its slope.
std::vector<double> changeAt(const OwnLaw& law, const std::vector<double>& values, double declared, double extent) {
    const KindInfo& kind = infoOf(law.kind);
    std::vector<std::pair<std::string, double>> given{{kind.declared, declared}};
    for (std::size_t i = 0; i < law.parameters.size(); ++i)
        given.emplace_back(law.parameters[i], values[i]);
    const std::vector<double> at = knotsOf(law.kind, extent);
    std::vector<double> out;
    if (law.kind != OwnLawKind::Moment) {
        for (const double v : law.formula.values(given, kind.state, at))
            out.push_back(v / declared - 1.0);
        return out;
    }
    const double h = 1e-5 * extent; // differences err by h^2 of the third derivative and 1e-11
    std::vector<double> around;
    for (const double u : at) {
        around.push_back(u + h);
        around.push_back(std::max(0.0, u - h));
    }
    const std::vector<double> m = law.formula.values(given, kind.state, around);
    for (std::size_t i = 0; i < at.size(); ++i)
        out.push_back((m[2 * i] - m[2 * i + 1]) / (around[2 * i] - around[2 * i + 1]) / declared - 1.0);
    return out;
}

/// Whether a moment changes its sign with the curvature change, as that of a symmetric section does.
bool isOdd(const OwnLaw& law, const std::vector<double>& values, double extent) {
    std::vector<std::pair<std::string, double>> given{{"B", 1.0}};
    for (std::size_t i = 0; i < law.parameters.size(); ++i)
        given.emplace_back(law.parameters[i], values[i]);
    const std::vector<double> at{0.0, 0.3 * extent, -0.3 * extent, extent, -extent};
    const std::vector<double> m = law.formula.values(given, "u", at);
    if (!std::all_of(m.begin(), m.end(), [](double v) { return std::isfinite(v); }))
        return true; // it has no value there, which is said elsewhere
    const double tolerance = 1e-9 * extent;
    return std::abs(m[0]) < tolerance && std::abs(m[1] + m[2]) < tolerance && std::abs(m[3] + m[4]) < tolerance;
}

bool vanishes(const std::vector<double>& change) {
    return std::all_of(change.begin(), change.end(), [](double v) { return std::abs(v) < 1e-9; });
}

/// The state at and beyond its ends as a cubic; `even`: before its beginning as in a mirror.
std::vector<double> continued(std::vector<double> f, bool even) {
    for (std::size_t i = 0; i < 2; ++i) {
        const double before = even ? f[2 * i + 1] : 4.0 * f[0] - 6.0 * f[1] + 4.0 * f[2] - f[3];
        f.insert(f.begin(), before);
        const std::size_t n = f.size();
        f.push_back(4.0 * f[n - 1] - 6.0 * f[n - 2] + 4.0 * f[n - 3] - f[n - 4]);
    }
    return f;
}

/// Coefficients of a cubic B-spline through f: those that meet cubics exactly, c_i = f_i - (f_i-1 - 2 f_i + f_i+1) / 6
/// (C. de Boor, A Practical Guide to Splines, 1978), and the same again of what is left.
std::vector<double> coefficientsOf(const std::vector<double>& f, bool even) {
    std::vector<double> c(f.size() + 2, 0.0), left = f;
    for (int pass = 0; pass < 4; ++pass) { // each leaves a fifth of the highest wave, and less of the others
        const std::vector<double> g = continued(left, even);
        for (std::size_t i = 0; i < c.size(); ++i)
            c[i] += g[i + 1] - (g[i] - 2.0 * g[i + 1] + g[i + 2]) / 6.0;
        for (std::size_t i = 0; i < f.size(); ++i)
            left[i] = f[i] - (c[i] + 4.0 * c[i + 1] + c[i + 2]) / 6.0;
    }
    return c;
}

/// Whether the change is in proportion to a parameter. That it vanishes where the parameter is 0 is not enough:
/// exp(-v / v0) does.
bool isAmplitude(const OwnLaw& law, std::vector<double> values, std::size_t parameter, double extent) {
    const std::vector<double> whole = changeAt(law, values, 1.0, extent);
    const double start = values[parameter];
    values[parameter] = 0.0;
    if (!vanishes(changeAt(law, values, 1.0, extent)))
        return false;
    values[parameter] = 0.5 * start;
    const std::vector<double> half = changeAt(law, values, 1.0, extent);
    for (std::size_t i = 0; i < half.size(); ++i)
        if (std::abs(half[i] - 0.5 * whole[i]) > 1e-6 * (1e-6 + std::abs(whole[i])))
            return false;
    return true;
}

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", v);
    return text;
}

bool isName(const std::string& text) {
    return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 &&
           std::all_of(text.begin(), text.end(),
                       [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
}

/// "PARAMETER=VALUE", no formula with a comparison.
bool isAssignment(std::string_view text) {
    const std::size_t equals = text.find('=');
    return equals != std::string_view::npos && isName(std::string(text.substr(0, equals))) &&
           text.substr(equals + 1).find('=') == std::string_view::npos;
}

/// Labels that results give to other things.
bool isReserved(const std::string& name) {
    return name == kNothing || name.rfind("learned_", 0) == 0 || name.rfind("stated_", 0) == 0;
}

std::vector<std::string> namesOf(const std::vector<StartedLaw>& laws) {
    std::vector<std::string> names;
    for (const StartedLaw& l : laws)
        names.push_back(l.law.name);
    return names;
}

/// "NAME:PARAMETER=VALUE" of a law. Empty, or what is wrong.
std::string setStart(StartedLaw& started, std::string_view assignment) {
    const OwnLaw& law = started.law;
    const std::size_t equals = assignment.find('=');
    const std::string parameter(assignment.substr(0, equals)), text(assignment.substr(equals + 1));
    const auto at = std::find(law.parameters.begin(), law.parameters.end(), parameter);
    if (at == law.parameters.end())
        return "the law " + law.name + " has no parameter \"" + parameter + "\"" +
               didYouMean(parameter, law.parameters);
    double value = 0.0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size() || !std::isfinite(value))
        return law.name + ": " + parameter + " = \"" + text + "\"; expected a number";
    started.values[static_cast<std::size_t>(at - law.parameters.begin())] = value;
    return {};
}

} // namespace

OwnLawRange ownLawRange(const ExperimentScales& s, double largestBend) {
    // A law of the moment may let the specimen bend by more in one place. The table ends there, and goes on straight.
    constexpr double kFarther = 1.5;
    const double bend = largestBend > 1e-3 / s.radius ? kFarther * largestBend : 1.0 / s.radius;
    return {0.1 * s.speed, 6.0 * s.travel, bend};
}

Result<OwnLaw> readOwnLaw(const std::string& name, const std::string& text) {
    using Failed = Result<OwnLaw>;
    auto formula = scene::Formula::parse(text);
    if (!formula)
        return Failed::failure(formula.error());
    OwnLaw law{name, *std::move(formula), OwnLawKind::FrictionOfSpeed, {}};
    const std::vector<std::string>& names = law.formula.names();
    const auto has = [&](const std::string& n) { return std::find(names.begin(), names.end(), n) != names.end(); };
    std::vector<const KindInfo*> kinds;
    for (const KindInfo& k : kKinds)
        if (has(k.declared) && has(k.state))
            kinds.push_back(&k);
    if (kinds.size() != 1)
        return Failed::failure(
            std::string(kinds.empty() ? "the formula says of nothing known what it depends on"
                                      : "the formula depends on two things at once") +
            "; expected a friction coefficient, mu times a factor of v (speed of sliding, m/s) or of s (slip, m), or "
            "a bending moment, B times a law of u (curvature change, 1/m)");
    law.kind = kinds.front()->kind;
    for (const std::string& n : names)
        if (n != kinds.front()->declared && n != kinds.front()->state)
            law.parameters.push_back(n);
    return law;
}

Result<effects::Setting> settingOf(const OwnLaw& law, const std::vector<double>& values, const OwnLawRange& range) {
    using Failed = Result<effects::Setting>;
    const KindInfo& kind = infoOf(law.kind);
    const double extent = extentOf(law.kind, range);
    const std::vector<double> change = changeAt(law, values, 1.0, extent), twice = changeAt(law, values, 2.0, extent);
    const std::vector<double> at = knotsOf(law.kind, extent);
    if (law.kind == OwnLawKind::Moment && !isOdd(law, values, extent))
        return Failed::failure(law.name +
                               " is another law for bending the other way: expected a moment that is 0 at u = 0 "
                               "and changes its sign with u");
    for (std::size_t i = 0; i < change.size(); ++i) {
        const std::string place = std::string(" at ") + kind.state + " = " + number(at[i]);
        if (!std::isfinite(change[i]))
            return Failed::failure(law.name + " has no value" + place);
        if (std::abs(twice[i] - change[i]) > 1e-6 * (1.0 + std::abs(change[i])))
            return Failed::failure(law.name + " is not in proportion to " + kind.declared +
                                   ": with twice the declared value it is not twice as large" + place);
        constexpr double kLeast = -0.95, kMost = 100.0;
        if (change[i] < kLeast || change[i] > kMost)
            return Failed::failure(law.name +
                                   (law.kind == OwnLawKind::Moment
                                        ? ": the moment hardly rises with curvature, or very steeply,"
                                        : ": the friction coefficient is not 0.05 to 100 times the declared "
                                          "one") +
                                   place);
    }
    effects::Setting out = effects::off(*effects::find(kind.effect));
    if (vanishes(change))
        return out;
    if (std::string why = effects::set(out, "law", std::string_view("table")); !why.empty())
        return Failed::failure(why);
    const std::vector<double> c = coefficientsOf(change, law.kind == OwnLawKind::Moment);
    std::string why = effects::set(out, kind.extent, extent);
    if (why.empty() && std::string_view(kind.amplitude) != kind.extent)
        why = effects::set(out, kind.amplitude, 1.0);
    for (std::size_t k = 0; k < c.size() && why.empty(); ++k)
        why = effects::set(out, "t" + std::to_string(k + 1), std::max(-0.99, c[k]));
    return why.empty() ? Result<effects::Setting>(out) : Failed::failure(law.name + ": " + why);
}

std::string takeOwnLaws(std::vector<std::string>& texts, std::vector<StartedLaw>& laws) {
    const auto find = [&](const std::string& name) {
        return std::find_if(laws.begin(), laws.end(), [&](const StartedLaw& l) { return l.law.name == name; });
    };
    std::vector<std::string> rest, others; // assignments may stand before the formula
    for (const std::string& text : texts) {
        const std::size_t colon = text.find(':');
        const std::string name = text.substr(0, colon), what = colon == std::string::npos ? "" : text.substr(colon + 1);
        if (colon == std::string::npos || effects::find(name) != nullptr || isAssignment(what)) {
            rest.push_back(text);
            continue;
        }
        if (!isName(name) || isReserved(name))
            return "\"" + name + "\" is no name for a law; expected letters, digits and underscores" +
                   (isReserved(name) ? ", and another name, since results use this one" : "");
        if (find(name) != laws.end())
            return "the law " + name + " is given twice";
        auto law = readOwnLaw(name, what);
        if (!law)
            return name + ": " + law.error();
        const std::size_t count = law->parameters.size();
        laws.push_back({*std::move(law), std::vector<double>(count, std::numeric_limits<double>::quiet_NaN())});
    }
    for (const std::string& text : rest) {
        const std::size_t colon = text.find(':');
        const auto law = find(text.substr(0, colon));
        if (colon == std::string::npos || law == laws.end())
            others.push_back(text);
        else if (std::string why = setStart(*law, std::string_view(text).substr(colon + 1)); !why.empty())
            return why;
    }
    for (const StartedLaw& l : laws)
        for (std::size_t i = 0; i < l.values.size(); ++i)
            if (std::isnan(l.values[i]))
                return l.law.name + ": the parameter " + l.law.parameters[i] + " has no value; expected --effect " +
                       l.law.name + ":" + l.law.parameters[i] + "=VALUE";
    if (!laws.empty()) { // a name that is neither a law nor an effect may be meant as either
        std::vector<std::string> known = namesOf(laws);
        for (const std::string& text : others)
            if (const std::string name = text.substr(0, text.find(':')); effects::find(name) == nullptr)
                if (const std::string near = didYouMean(name, known); !near.empty())
                    return "there is no law \"" + name + "\"" + near;
    }
    texts = std::move(others);
    return {};
}

std::string addEffects(const std::vector<std::string>& all, const experiment::Experiment& e, replay::Parameters& p,
                       const std::atomic<bool>* interrupt) {
    std::vector<std::string> texts = all;
    std::vector<StartedLaw> laws;
    if (std::string why = takeOwnLaws(texts, laws); !why.empty())
        return why;
    for (const std::string& text : texts)
        if (const std::string why = effects::add(p.effects, text); !why.empty())
            return text + ": " + why;
    for (const StartedLaw& l : laws) {
        const double bend = l.law.kind == OwnLawKind::Moment ? largestBend(e, interrupt) : 0.0;
        const auto setting = settingOf(l.law, l.values, ownLawRange(scalesOf(e), bend));
        if (!setting)
            return setting.error();
        if (!effects::isOff(*setting))
            p.effects.push_back(*setting);
    }
    return replay::checkEffects(p, e);
}

std::string addOwnLaw(CandidateEffects& all, const experiment::Experiment& e, const StartedLaw& started,
                      const OwnLawRange& range) {
    const OwnLaw& law = started.law;
    const effects::Effect* effect = effects::find(infoOf(law.kind).effect);
    if (!replay::acts(e, effect->key))
        return law.name + " has nothing to act on in this experiment";
    const auto first = settingOf(law, started.values, range);
    if (!first)
        return first.error();
    if (effects::isOff(*first))
        return law.name + " says nothing with these values; expected starts at which it acts";
    CandidateEffect c;
    c.label = law.name;
    c.slot = effects::name(effect->slot);
    c.acting = effect->name;
    c.variant = law.formula.text();
    c.law = law.formula.text();
    bool vanishing = false;
    for (std::size_t i = 0; i < law.parameters.size(); ++i) {
        const double start = started.values[i], size = start != 0.0 ? std::abs(start) : 1.0;
        const bool amplitude = isAmplitude(law, started.values, i, extentOf(law.kind, range));
        vanishing = vanishing || amplitude;
        if (amplitude || start <= 0.0)
            c.parameters.push_back({law.parameters[i], "1", "parameter of the law", amplitude ? 0.0 : start,
                                    -20.0 * size, 20.0 * size, 0.2 * size, Scale::Linear, amplitude});
        else
            c.parameters.push_back({law.parameters[i], "1", "parameter of the law", math::log(start),
                                    math::log(start / 100.0), math::log(start * 100.0), math::log(2.0),
                                    Scale::Logarithm});
    }
    if (!vanishing)
        return law.name + " cannot be fitted: no parameter of it is a factor of what the law changes";
    for (const double factor : {1.0, -1.0, 0.3}) { // of its amplitudes
        std::vector<double> probe;
        for (std::size_t i = 0; i < c.parameters.size(); ++i)
            probe.push_back(c.parameters[i].amplitude ? factor * started.values[i]
                                                      : toInternal(c.parameters[i].scale, started.values[i]));
        c.probes.push_back(probe);
    }
    all.candidates.push_back(std::move(c));
    all.mappings.push_back(
        {effects::off(*effect), {}, ReadingEffect::None, [law, range](const std::vector<double>& values) {
             return settingOf(law, values, range);
         }});
    return {};
}

} // namespace supercircle::diagnosis
