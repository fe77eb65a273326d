#include "tests/blind_benchmark/synthetic_cases/make_case.h"

#include "tests/blind_benchmark/synthetic_cases/detectability.h"
#include "tests/reference_simulator/json_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace supercircle::blind_benchmark {

namespace {

using Json = nlohmann::ordered_json;

/// Everything drawn for a case, before it is recorded.
struct CaseTruth {
    CasePlan plan;
    Protocol protocol = Protocol::Arch;
    Description description;
    Offsets offsets;
    SensorNoise noise;
    std::vector<HiddenEffect> hidden;
    double visible = 0.0;  ///< Unexplained::detectable of all effects together
    double ownError = 0.0; ///< of the reference simulator: the largest ReadingDistance::rms of atOtherResolutions()
    std::vector<VisibleInterval> visibleIntervals;
};

Effects effectsOf(const std::vector<HiddenEffect>& hidden) {
    Effects e;
    for (const HiddenEffect& h : hidden)
        apply(e, h);
    return e;
}

using Make = std::function<HiddenEffect(double)>;

/// Amplitude at which the effect has about the wanted detectability: interpolated in logarithms.
double amplitudeFor(const BaselineModel& model, const Family& f, const Make& make, double wanted) {
    constexpr double kLeast = 0.02;
    double amplitude = 1.0, low = 0.0, lowSeen = 0.0, high = 0.0, highSeen = 0.0;
    for (int i = 0; i < 5; ++i) {
        const auto unexplained = model.unexplained(effectsOf({make(amplitude)}));
        const double seen =
            unexplained ? std::max(unexplained->detectable, 1e-3) : 1e6; // a failed simulation counts as too strong
        if (std::abs(std::log(seen / wanted)) < 0.25)
            break;
        (seen < wanted ? low : high) = amplitude;
        (seen < wanted ? lowSeen : highSeen) = seen;
        double next = std::clamp(wanted / seen, 0.1, 10.0) * amplitude;
        if (low > 0.0 && high > 0.0)
            next = low * std::pow(high / low,
                                  std::clamp(std::log(wanted / lowSeen) / std::log(highSeen / lowSeen), 0.1, 0.9));
        next = std::clamp(next, kLeast, f.largest);
        if (next == amplitude)
            break;
        amplitude = next;
    }
    return amplitude;
}

/// Adds the effects, one after the other, with about the wanted detectability. @return an error, or nothing
std::string addEffects(Random& draw, CaseTruth& s) {
    const BaselineModel model(s.description, s.offsets, s.noise);
    if (!model.failure().empty())
        return model.failure();
    for (const std::string& name : s.plan.families) {
        const Family& f = family(name);
        const Make make = f.draw(draw, s.protocol);
        const double wanted = s.plan.strength == "limit"  ? draw.logarithmic(4.5, 8.0)
                              : s.plan.strength == "weak" ? draw.logarithmic(6.0, 12.0)
                                                          : draw.logarithmic(40.0, 150.0);
        s.hidden.push_back(make(amplitudeFor(model, f, make, wanted)));
    }
    if (s.hidden.empty())
        return {};
    const auto unexplained = model.unexplained(effectsOf(s.hidden));
    if (!unexplained)
        return "the simulation with the effects fails";
    s.visible = unexplained->detectable;
    s.visibleIntervals = model.visibleIntervals(unexplained->readings);
    return {};
}

std::string text(const char* format, double a) {
    char buffer[48];
    std::snprintf(buffer, sizeof buffer, format, a);
    return buffer;
}

/// Adds noise and quantisation, and subtracts the mean of the first half second.
std::vector<double> addNoise(Random& draw, const SensorNoise& n, const std::vector<double>& times,
                             std::vector<double> force) {
    double correlated = n.correlated * draw.normal();
    const double offset = 20.0 * n.total() * draw.uniform(-1.0, 1.0); // of the load cell, before its zero
    for (std::size_t i = 0; i < force.size(); ++i) {
        if (i > 0) {
            const double keep = std::exp(-(times[i] - times[i - 1]) / n.correlationTime);
            correlated = keep * correlated + n.correlated * std::sqrt(1.0 - keep * keep) * draw.normal();
        }
        force[i] += offset + correlated + n.white * (n.heavyTails ? draw.heavyTailed() : draw.normal());
        if (n.quantum > 0.0)
            force[i] = n.quantum * std::round(force[i] / n.quantum);
    }
    zeroAtStart(times, force);
    return force;
}

std::string forceFile(Random& draw, const Description& d, const RunPlan& run, const std::vector<double>& force) {
    std::string out = "time_s,displacement_mm,force_N\n";
    const std::vector<double> times = run.times(run.sampling);
    for (std::size_t i = 0; i < times.size(); ++i)
        out += text("%.4f,", times[i]) +
               text("%.4f,", 1e3 * (run.drive.at(times[i]) + d.displacementNoise * draw.normal())) +
               text("%.6f\n", force[i]);
    return out;
}

std::string markerFile(Random& draw, const Description& d, const SensorNoise& n, const RunPlan& run,
                       const std::vector<std::vector<Vec2>>& paths) {
    std::string out = "time_s";
    for (std::size_t m = 0; m < d.markers.size(); ++m)
        out += ",m" + std::to_string(m) + "_x_mm,m" + std::to_string(m) + "_y_mm";
    out += "\n";
    const std::vector<double> times = run.times(run.markersSampling);
    for (std::size_t i = 0; i < times.size(); ++i) {
        out += text("%.4f", times[i]);
        for (const std::vector<Vec2>& path : paths)
            for (int axis = 0; axis < 2; ++axis)
                out += text(",%.4f", 1e3 * (path[i][axis] + n.marker * draw.normal()));
        out += "\n";
    }
    return out;
}

double rms(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

Json parametersOf(const Setup& s, double gap) {
    const Specimen& a = s.specimens.front();
    return {{"bending_modulus_N_m2", a.modulus}, {"natural_curvature_1_m", a.curvature}, {"friction", s.friction},
            {"thickness_m", a.thickness},        {"linear_mass_kg_m", a.linearMass},     {"initial_gap_shift_m", gap}};
}

Json answerOf(const CaseTruth& s, const Setup& truth, const Json& runs) {
    const char* protocols[] = {"P1", "P2", "P3", "P4"};
    Json labels = Json::array(), effects = Json::array(), windows = Json::array(), without = Json::array();
    for (std::size_t i = 0; i < s.hidden.size(); ++i) {
        labels.push_back(s.hidden[i].label);
        effects.push_back(
            {{"family", s.plan.families[i]}, {"label", s.hidden[i].label}, {"parameters", s.hidden[i].parameters}});
        if (s.plan.kind == "removed") {
            without.push_back(s.hidden[i].label);
            for (const std::string& equivalent : equivalentLabels(s.hidden[i].label))
                without.push_back(equivalent);
        }
    }
    if (labels.empty())
        labels.push_back("none");
    for (const VisibleInterval& w : s.visibleIntervals)
        windows.push_back({{"run", w.run}, {"channel", w.channel}, {"t_start_s", w.from}, {"t_end_s", w.to}});
    return {{"case", s.plan.name},
            {"part", s.plan.part},
            {"kind", s.plan.kind},
            {"strength", s.plan.strength},
            {"protocol", protocols[static_cast<int>(s.protocol)]},
            {"labels", labels},
            {"effects", effects},
            {"diagnose_without", without},
            {"detectable", s.visible},
            {"own_error", s.ownError},
            {"windows", windows},
            {"true_parameters", parametersOf(truth, truth.crossheadOffset)},
            {"nominal_parameters", parametersOf(s.description.nominal, 0.0)},
            {"noise",
             {{"white_N", s.noise.white},
              {"correlated_N", s.noise.correlated},
              {"memory_s", s.noise.correlationTime},
              {"quantum_N", s.noise.quantum},
              {"heavy_tails", s.noise.heavyTails},
              {"marker_m", s.noise.marker}}},
            {"runs", runs}};
}

CaseTruth drawTruth(Random& draw, const CasePlan& plan) {
    CaseTruth s;
    s.plan = plan;
    const bool horizontal = draw.chance(0.15); // horizontal set-up: no weight in its plane
    bool markers = false, weightless = false;
    const bool snaps = plan.strength == "snaps";
    std::vector<Protocol> possible = {Protocol::Cylinder, Protocol::Strip,    Protocol::Arch,
                                      Protocol::Arch,     Protocol::Cylinder, Protocol::Shells};
    if (snaps)
        possible = {draw.chance(0.5) ? Protocol::Cylinder : Protocol::Strip};
    for (const std::string& name : plan.families) {
        const Family& f = family(name);
        std::vector<Protocol> common;
        for (const Protocol p : f.protocols)
            if (std::count(possible.begin(), possible.end(), p) > 0)
                common.push_back(p);
        possible = common;
        markers = markers || f.markers;
        weightless = weightless || f.weightless;
    }
    s.protocol = possible[static_cast<std::size_t>(draw.integer(static_cast<int>(possible.size())))];
    // An arch without weight floats between the plates, and its position between contacts is undefined.
    weightless = weightless || (horizontal && s.protocol != Protocol::Arch);
    s.description = drawDescription(draw, s.protocol, weightless, markers, snaps);
    s.offsets = drawOffsets(draw);
    s.noise = drawSensorNoise(draw, s.description);
    return s;
}

/// Distance of two sets of readings of a case, in noise standard deviations.
struct ReadingDistance {
    std::vector<double> rows;
    /// @param most larger distances of a reading count as this one
    [[nodiscard]] double rms(double most = std::numeric_limits<double>::infinity()) const {
        double squares = 0.0;
        for (const double x : rows)
            squares += std::min(x * x, most * most);
        return rows.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(rows.size()));
    }
};

/// Range of runs.
struct RunRange {
    std::size_t from = 0, to = std::numeric_limits<std::size_t>::max(); ///< to: behind the last one
};

/// Distance of the readings outside excludedIntervals().
ReadingDistance distance(const Description& d, const CleanReadings& a, const CleanReadings& b, const SensorNoise& n,
                         const RunRange& of = {}) {
    ReadingDistance out;
    for (std::size_t r = of.from; r < std::min(of.to, a.force.size()); ++r) {
        const auto size = static_cast<Eigen::Index>(a.force[r].size());
        const Eigen::VectorXd one = Eigen::Map<const Eigen::VectorXd>(a.force[r].data(), size) / n.total(),
                              other = Eigen::Map<const Eigen::VectorXd>(b.force[r].data(), size) / n.total();
        auto excluded = excludedIntervals(d.runs[r], one);
        const auto ofOther = excludedIntervals(d.runs[r], other);
        excluded.insert(excluded.end(), ofOther.begin(), ofOther.end());
        const std::vector<double> times = d.runs[r].times(d.runs[r].sampling);
        for (Eigen::Index i = 0; i < size; ++i) {
            const double t = times[static_cast<std::size_t>(i)];
            if (std::none_of(excluded.begin(), excluded.end(),
                             [&](const auto& s) { return t > s.first && t < s.second; }))
                out.rows.push_back(std::abs(one[i] - other[i]));
        }
    }
    return out;
}

constexpr double kMaxDistance =
    8.0; // noise standard deviations; a jump that comes earlier or later counts as this much

/// Distance of the markers along x or y, rms over all rows, m; 0 without markers.
double markerDistance(const CleanReadings& a, const CleanReadings& b, const RunRange& of = {}) {
    double squares = 0.0, count = 0.0;
    for (std::size_t r = of.from; r < std::min(of.to, a.markers.size()); ++r)
        for (std::size_t m = 0; m < a.markers[r].size(); ++m)
            for (std::size_t i = 0; i < a.markers[r][m].size(); ++i) {
                squares += (a.markers[r][m][i] - b.markers[r][m][i]).squaredNorm();
                count += 2.0;
            }
    return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// Whether an effect changes the readings. An effect with a threshold may act in the coarse simulation only.
bool changesReadings(const CleanReadings& with, const CleanReadings& without, const SensorNoise& n) {
    constexpr double kLeast = 1e-3; // noise standard deviations of a reading
    double most = markerDistance(with, without) / n.marker;
    for (std::size_t r = 0; r < with.force.size(); ++r)
        most = std::max(most, rms(with.force[r], without.force[r]) / n.total());
    return most > kLeast;
}

constexpr const char* kOtherCase = "the readings are those of another case: numbers of runs, rows or markers differ";

/// Whether two sets of readings have the same runs, rows and markers.
bool sameLayout(const CleanReadings& a, const CleanReadings& b) {
    if (a.force.size() != b.force.size() || a.markers.size() != b.markers.size())
        return false;
    for (std::size_t r = 0; r < a.force.size(); ++r) {
        if (a.force[r].size() != b.force[r].size() || a.markers[r].size() != b.markers[r].size())
            return false;
        for (std::size_t m = 0; m < a.markers[r].size(); ++m)
            if (a.markers[r][m].size() != b.markers[r][m].size())
                return false;
    }
    return true;
}

/// A drawn case, and the random numbers of its noise.
struct DrawnCase {
    std::string failure;
    Random draw;
    CaseTruth content;
};

/// Readings at half the resolution and, where friction falls with speed, with steps sixteen times shorter. Such
/// friction excites a vibration near 100 Hz that long implicit steps damp, so that halving the resolution hides it
/// (decision 0089).
std::vector<CleanReadings> atOtherResolutions(const CaseTruth& s, const Setup& truth) {
    std::vector<CleanReadings> out = {simulate(s.description, truth, finer(0.5))};
    const bool fallsWithSpeed = std::any_of(s.hidden.begin(), s.hidden.end(), [](const HiddenEffect& h) {
        return h.label == "rate_dependent_friction" && h.parameters.at("strength") < 0.0;
    });
    if (fallsWithSpeed) {
        constexpr double kStepFactor = 16.0;
        Resolution r;
        r.travel /= kStepFactor;
        r.longest /= kStepFactor;
        out.push_back(simulate(s.description, truth, r));
    }
    return out;
}

/// Draws a case, and again where the reference simulator does not know its own readings, for example because a specimen
/// sticks and slips. No answer can be right or wrong there (decision 0089).
DrawnCase drawCase(const CasePlan& plan) {
    constexpr int kMaxDraws = 8;
    for (int i = 0;; ++i) {
        DrawnCase d{{}, Random(plan.seed + 15485863ULL * static_cast<std::uint64_t>(i)), {}};
        d.content = drawTruth(d.draw, plan);
        if (!plan.families.empty())
            d.failure = addEffects(d.draw, d.content);
        if (!d.failure.empty())
            return d;
        CaseTruth& s = d.content;
        const Setup truth = trueSetup(s.description, s.offsets, effectsOf(s.hidden));
        const CleanReadings recorded = simulate(s.description, truth, {});
        s.ownError = recorded.failure.empty() ? 0.0 : std::numeric_limits<double>::infinity();
        for (const CleanReadings& other : atOtherResolutions(s, truth))
            s.ownError = std::max(s.ownError, recorded.failure.empty() && other.failure.empty()
                                                  ? distance(s.description, recorded, other, s.noise).rms(kMaxDistance)
                                                  : std::numeric_limits<double>::infinity());
        if (s.ownError <= kMaxOwnError)
            return d;
        if (i + 1 == kMaxDraws) {
            d.failure = "the readings depend on the resolution of the reference simulator in every draw";
            return d;
        }
    }
}

} // namespace

Accuracy accuracyOf(const CasePlan& plan, const CleanReadings* other) {
    Accuracy out;
    const DrawnCase drawn = drawCase(plan);
    const CaseTruth& s = drawn.content;
    if (out.failure = drawn.failure; !out.failure.empty())
        return out;
    const Setup truth = trueSetup(s.description, s.offsets, effectsOf(s.hidden));
    const CleanReadings a = simulate(s.description, truth, {}), b = simulate(s.description, truth, finer(2.0));
    if (out.failure = a.failure + b.failure; !out.failure.empty())
        return out;
    if (other != nullptr && !sameLayout(*other, a)) {
        out.failure = kOtherCase;
        return out;
    }
    const BaselineModel model(s.description, s.offsets, s.noise);
    if (out.failure = model.failure(); !out.failure.empty())
        return out;
    ReadingDistance readings = distance(s.description, a, b, s.noise);
    out.rms = readings.rms();
    std::sort(readings.rows.begin(), readings.rows.end());
    out.percentile99 = readings.rows[readings.rows.size() * 99 / 100];
    out.detectable = model.detectableDifference(a, b);
    out.markers = markerDistance(a, b) / s.noise.marker;
    if (other != nullptr) {
        out.otherRms = distance(s.description, a, *other, s.noise).rms();
        out.otherDetectable = model.detectableDifference(a, *other);
        out.otherMarkers = markerDistance(a, *other) / s.noise.marker;
    }
    return out;
}

SyntheticCase makeCase(const CasePlan& plan, const std::vector<ProposedRun>& further,
                       const CleanReadings* replacement) {
    SyntheticCase out;
    DrawnCase drawn = drawCase(plan);
    Random& draw = drawn.draw;
    CaseTruth& s = drawn.content;
    if (out.failure = drawn.failure; !out.failure.empty())
        return out;
    std::vector<RunRange> proposedRanges; // the proposed runs, each with its repeats
    const bool markersTracked = !s.description.markers.empty();
    for (const ProposedRun& f : further) {
        if (!markersTracked && !f.markers.empty()) { // markers are tracked from now on
            for (RunPlan& run : s.description.runs)
                run.markersTracked = false;
            for (std::size_t a = 0; a < s.description.nominal.specimens.size(); ++a)
                for (const double at : f.markers)
                    s.description.markers.push_back({static_cast<int>(a), at});
        }
        const std::size_t before = s.description.runs.size();
        for (std::size_t i = 0; i < f.repeats; ++i) {
            addRun(s.description, f.drive, f.rate, f.specimenReversed);
            s.description.runs.back().markersTracked = markersTracked || !f.markers.empty();
            if (f.markerRate > 0.0)
                s.description.runs.back().markersSampling = f.markerRate;
        }
        proposedRanges.push_back({before, s.description.runs.size()});
    }
    const Setup truth = trueSetup(s.description, s.offsets, effectsOf(s.hidden));
    const CleanReadings clean = replacement != nullptr ? *replacement : simulate(s.description, truth, {});
    const CleanReadings plain = simulate(s.description, trueSetup(s.description, s.offsets, {}), {});
    if (!clean.failure.empty() || !plain.failure.empty()) {
        out.failure = clean.failure + plain.failure;
        return out;
    }
    if (!sameLayout(clean, plain)) {
        out.failure = kOtherCase;
        return out;
    }
    if (!s.hidden.empty() && !changesReadings(clean, plain, s.noise)) {
        out.failure = "the hidden effect does not change these recordings";
        return out;
    }
    out.files.emplace_back("experiment.json", writeDescription(s.description));
    Json runs = Json::array();
    for (std::size_t r = 0; r < s.description.runs.size(); ++r) {
        const RunPlan& run = s.description.runs[r];
        const std::vector<double> read = addNoise(draw, s.noise, run.times(run.sampling), clean.force[r]);
        out.files.emplace_back(run.file, forceFile(draw, s.description, run, read));
        if (!s.description.markers.empty() && run.markersTracked)
            out.files.emplace_back(run.markersFile, markerFile(draw, s.description, s.noise, run, clean.markers[r]));
        runs.push_back({{"run", run.file},
                        {"rows", read.size()},
                        {"rms_noise_N", rms(read, clean.force[r])},
                        {"rms_effect_N", rms(clean.force[r], plain.force[r])},
                        {"peak_N", *std::max_element(clean.force[r].begin(), clean.force[r].end())}});
    }
    Json answer = answerOf(s, truth, runs);
    if (!proposedRanges.empty()) {
        double worst = 0.0; // infinite is null in JSON
        for (const CleanReadings& other : atOtherResolutions(s, truth))
            for (const RunRange& of : proposedRanges) {
                if (!sameLayout(clean, other)) {
                    worst = std::numeric_limits<double>::infinity();
                    break;
                }
                // Repeats average their noise, not this common error.
                const double one = std::max(distance(s.description, clean, other, s.noise, of).rms(kMaxDistance),
                                            markerDistance(clean, other, of) / s.noise.marker);
                worst = std::max(worst, std::sqrt(static_cast<double>(of.to - of.from)) * one);
            }
        answer["further_own_error"] = worst;
    }
    out.answer = reference_simulator::jsonText(answer) + "\n";
    return out;
}

void writeAtomically(const std::filesystem::path& file, const std::string& text) {
    const std::filesystem::path part = file.string() + ".part";
    std::ofstream out(part, std::ios::binary);
    out << text;
    out.close();
    if (!out)
        throw std::runtime_error(file.string() + ": cannot be written");
    std::filesystem::rename(part, file);
}

} // namespace supercircle::blind_benchmark
