#include "plugin/identification/diagnosis/model/learned_laws.h"

#include "plugin/identification/replay/parameters.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

effects::SplineCoefficients coefficients(const std::vector<double>& values) {
    effects::SplineCoefficients c{};
    std::copy_n(values.begin(), std::min(values.size(), c.size()), c.begin());
    return c;
}

double splineAt(const effects::SplineCoefficients& c, double x) {
    return effects::evaluateSpline(c, x).value;
}

/// Secant stiffness, moment over curvature change, relative to B, minus one.
double secantAt(const effects::SplineCoefficients& c, double x) {
    const effects::SplinePoint p = effects::evaluateSpline(c, x);
    return x > 0.0 ? p.area / x : p.value;
}

double fadingAt(const effects::SplineCoefficients& c, double x) {
    return effects::evaluateFading(c, x).value;
}

template <double (*Law)(const effects::SplineCoefficients&, double)>
std::vector<double> curve(const std::vector<double>& values, const std::vector<double>& at) {
    std::vector<double> out;
    for (const double x : at)
        out.push_back(Law(coefficients(values), x));
    return out;
}

/// A candidate with spline coefficients between `lower` and `upper`, step `step`.
CandidateEffect learned(const std::string& label, const std::string& slot, const std::string& law, double lower,
                        double upper, double step, LearnedCurve curve) {
    CandidateEffect c;
    c.label = label;
    c.slot = slot;
    c.law = law;
    c.learned = true;
    c.curve = std::move(curve);
    for (std::size_t k = 1; k <= effects::kSplineCoefficients; ++k)
        c.parameters.push_back({"c" + std::to_string(k), "1", "", 0.0, lower, upper, step, Scale::Linear, true});
    return c;
}

/// A law in a slot of the simulator, by a catalogue effect whose law "learned" has coefficients c1, c2, ...
void inSlot(CandidateEffects& candidateEffects, const experiment::Experiment& experiment, CandidateEffect c,
            const char* effect, const std::vector<std::pair<std::string, double>>& fixed) {
    const effects::Effect* e = effects::find(effect);
    if (e == nullptr || !replay::acts(experiment, e->key))
        return;
    EffectMapping mapping{effects::off(*e), {}, ReadingEffect::None};
    const auto find = [&](const std::string& name) {
        const auto at = std::find_if(e->parameters.begin(), e->parameters.end(),
                                     [&](const effects::Parameter& p) { return p.name == name; });
        return static_cast<std::size_t>(at - e->parameters.begin());
    };
    const std::vector<std::string>& laws = e->parameters[find("law")].choices;
    mapping.base.values[find("law")] =
        static_cast<double>(std::find(laws.begin(), laws.end(), "learned") - laws.begin());
    for (const auto& [name, value] : fixed)
        mapping.base.values[find(name)] = value;
    for (const Scalar& s : c.parameters)
        mapping.parameterAt.push_back(find(s.name));
    candidateEffects.candidates.push_back(std::move(c));
    candidateEffects.mappings.push_back(std::move(mapping));
}

void onReadings(CandidateEffects& candidateEffects, CandidateEffect c, ReadingEffect readingEffect) {
    candidateEffects.candidates.push_back(std::move(c));
    candidateEffects.mappings.push_back({{}, {}, readingEffect});
}

} // namespace

void addLearnedLaws(CandidateEffects& candidateEffects, const experiment::Experiment& e, const ExperimentScales& s) {
    // A run that fails or hardly bends does not limit the learned moment.
    const double bend = s.bend > 1e-3 / s.radius ? 1.05 * s.bend : 1.0 / s.radius;
    inSlot(candidateEffects, e,
           learned("learned_moment", "material", "dM/du = B (1 + S(|u|))", -0.9, 5.0, 0.1,
                   {"curvature change", "1/m", "bending moment", true, "", 0.0, bend, false, 1.0, curve<secantAt>}),
           "nonlinear_elasticity", {{"uc_1_m", bend}});
    const double middle = 0.1 * s.speed; // two decades to either side, down to a thousandth of the drive speed
    inSlot(candidateEffects, e,
           learned(
               "learned_friction_speed", "contact", "mu (1 + S(log v))", -0.9, 5.0, 0.1,
               {"sliding speed", "m/s", "friction", true, "", 1e-2 * middle, 1e2 * middle, true, 1.0, curve<splineAt>}),
           "rate_dependent_friction", {{"strength", 1.0}, {"speed_m_s", middle}});
    const double distance = 6.0 * s.travel;
    inSlot(candidateEffects, e,
           learned("learned_friction_slip", "contact", "mu (1 + S(sliding distance))", -0.9, 5.0, 0.1,
                   {"sliding distance", "m", "friction", true, "", 0.0, distance, false, 1.0, curve<splineAt>}),
           "wear", {{"change", 1.0}, {"distance_m", distance}});
    const double attraction = 2.0 * s.modulus / (s.radius * s.radius * s.radius), range = 3e-4 * s.units.length;
    inSlot(candidateEffects, e,
           learned("learned_contact", "contact", "attraction per length S(gap)", -10.0, 10.0, 0.2,
                   {"gap", "m", "attraction", false, "N/m", 0.0, range, false, attraction, curve<fadingAt>}),
           "adhesion", {{"F_a_N_m", attraction}, {"range_m", range}});
    const double f = 0.2 * s.force;
    onReadings(candidateEffects,
               learned("learned_machine_force", "apparatus", "reading += S(displacement)", -20.0, 20.0, 0.05,
                       {"displacement", "m", "added force", false, "N", 0.0, s.travel, false, f, curve<splineAt>}),
               ReadingEffect::ByDisplacement);
    onReadings(candidateEffects,
               learned("learned_machine_friction", "apparatus", "reading += S(displacement) against the motion", -20.0,
                       20.0, 0.05,
                       {"displacement", "m", "force against the motion", false, "N", 0.0, s.travel, false, f,
                        curve<splineAt>}),
               ReadingEffect::ByDirection);
    if (experiment::isTable(e))
        return;
    onReadings(candidateEffects,
               learned("learned_drift", "sensor", "reading += S(time)", -20.0, 20.0, 0.05,
                       {"time", "s", "zero of the load cell", false, "N", 0.0, s.duration, false, f, curve<splineAt>}),
               ReadingEffect::ByTime);
}

} // namespace supercircle::diagnosis
