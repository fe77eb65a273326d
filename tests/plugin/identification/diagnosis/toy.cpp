#include "toy.h"

#include "supercircle/effects/laws/spline.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace toy {

RecordedRun motion(const std::string& name, double speed, double rate) {
    RecordedRun run;
    run.name = name;
    const double way = 0.01, segment = way / speed;
    const double knots[] = {0.0, 1.0, 1.0 + segment, 3.0 + segment, 3.0 + 2.0 * segment, 4.0 + 2.0 * segment};
    const double speeds[] = {0.0, speed, 0.0, -speed, 0.0};
    std::vector<DriveSegment> segments;
    for (int i = 0; i < 5; ++i)
        segments.push_back({speeds[i] > 0.0   ? Phase::Loading
                            : speeds[i] < 0.0 ? Phase::Unloading
                                              : Phase::Hold,
                            knots[i], knots[i + 1], speeds[i]});
    const auto n = static_cast<Eigen::Index>(std::floor(knots[5] * rate));
    run.time.resize(n);
    run.displacement.resize(n);
    run.force = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double t = static_cast<double>(k) / rate;
        int l = 0;
        double d = 0.0;
        while (l < 4 && t > knots[l + 1])
            d += speeds[l] * (knots[l + 1] - knots[l]), ++l;
        run.time[k] = t;
        run.displacement[k] = d + speeds[l] * (t - knots[l]);
    }
    run.setDrive(std::move(segments));
    return run;
}

Spring::Spring(const RecordedData& data, bool dashpot, bool learns) : data_(data) {
    nominal_ = {{"stiffness", "N/m", "", 100.0, 94.0, 106.0, 6.0, Scale::Linear, false},
                {"friction", "N", "", 0.1, 0.05, 0.15, 0.05, Scale::Linear, false}};
    for (Scalar& s : nominal_)
        s.doubtful = true;
    if (dashpot)
        candidates_.push_back({"dashpot",
                               "material",
                               "",
                               "c v",
                               {{"c", "N s/m", "force per speed", 0.0, 0.0, 1e3, 2.0, Scale::Linear, true}},
                               {{5.0}}});
    candidates_.push_back(
        {"drift", "sensor", "", "a t", {{"a", "N/s", "", 0.0, -1.0, 1.0, 1e-3, Scale::Linear, true}}, {{5e-3}}});
    if (learns) {
        CandidateEffect c;
        c.label = "learned_force";
        c.slot = "material";
        c.law = "S(x)";
        c.learned = true;
        c.curve = {"displacement", "m", "added force", false, "N", 0.0, 0.01, false, 1.0, law};
        for (int k = 1; k <= 7; ++k)
            c.parameters.push_back({"c" + std::to_string(k), "N", "", 0.0, -9.0, 9.0, 0.02, Scale::Linear, true});
        candidates_.push_back(c);
        return;
    }
    candidates_.push_back(
        {"cubic", "material", "", "b x^3", {{"b", "N/m^3", "", 0.0, -1e9, 1e9, 1e4, Scale::Linear, true}}, {{1e5}}});
}

Response Spring::simulate(std::size_t r, const ParameterPoint& p, Fidelity, const std::atomic<bool>*) const {
    const RecordedRun& run = data_.runs[r];
    Response out;
    out.force.resize(run.time.size());
    out.markers.resize(0);
    for (Eigen::Index k = 0; k < run.time.size(); ++k) {
        const double v = run.segments[static_cast<std::size_t>(run.segmentOfRow[static_cast<std::size_t>(k)])].speed;
        const double x = run.displacement[k];
        double f = p.nominal[0] * x + p.nominal[1] * (v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0);
        for (const Term& t : p.terms) {
            const std::string& label = candidates()[t.candidate].label;
            if (label == "learned_force")
                f += law(t.values, {100.0 * x}).front();
            else
                f += t.values[0] * (label == "dashpot" ? v
                                    : label == "drift" ? run.time[k]
                                    : label == "cubic" ? x * x * x
                                                       : 0.0);
        }
        out.force[k] = f;
    }
    alter(r, p, out);
    return out;
}

std::vector<double> Spring::law(const std::vector<double>& values, const std::vector<double>& at) {
    supercircle::effects::SplineCoefficients c{};
    std::copy_n(values.begin(), 7, c.begin());
    std::vector<double> out;
    for (const double x : at)
        out.push_back(supercircle::effects::evaluateSpline(c, x).value);
    return out;
}

void hide(RecordedData& data, const Model& model, const std::vector<Term>& effects) {
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force += model.simulate(r, ParameterPoint{{103.0, 0.08}, effects}, Fidelity::Fine, nullptr).force -
                              model.simulate(r, ParameterPoint{{103.0, 0.08}, {}}, Fidelity::Fine, nullptr).force;
}

void addNoise(RecordedRun& run, Random& random) {
    double a = kColoured * random.normal();
    for (Eigen::Index k = 0; k < run.force.size(); ++k) {
        const double phi = k > 0 ? std::exp(-(run.time[k] - run.time[k - 1]) / kMemory) : 1.0;
        a = phi * a + kColoured * std::sqrt(1.0 - phi * phi) * random.normal();
        run.force[k] += a + kWhite * random.normal();
    }
}

RecordedData recordings(std::uint64_t seed, const std::string& masked, double size, double rate) {
    RecordedData data;
    data.statedForceNoise = 0.01;
    data.zeroWindow = 0.0;
    data.runs = {motion("slow", 1e-3, rate), motion("fast", 5e-3, rate), motion("slower", 2e-3, rate)};
    const Spring spring(data);
    ParameterPoint truth{{103.0, 0.08}, {}};
    for (std::size_t c = 0; c < spring.candidates().size(); ++c)
        if (spring.candidates()[c].label == masked)
            truth.terms.push_back({c, {size}});
    Random random(seed);
    std::vector<Eigen::VectorXd> forces;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        forces.push_back(spring.simulate(r, truth, Fidelity::Fine, nullptr).force);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        data.runs[r].force = forces[r];
        addNoise(data.runs[r], random);
    }
    return data;
}

RecordedRun& withMarkers(RecordedData& data, const std::vector<double>& arcFraction, Eigen::Index every) {
    data.statedMarkerNoise = 3e-5;
    data.arcFraction = arcFraction;
    for (std::size_t m = 0; m < arcFraction.size(); ++m)
        data.markerNames.push_back("m" + std::to_string(m));
    RecordedRun& run = data.runs.front();
    run.markerCount = arcFraction.size();
    run.markerTime = run.time(Eigen::seq(0, Eigen::last, every)).eval();
    run.markers = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(run.markerCount) * run.markerTime.size());
    run.setDrive(run.segments);
    return run;
}

DiagnosisSettings exact(std::uint64_t seed) {
    DiagnosisSettings s;
    s.seed = seed;
    s.draws = 199;
    s.likelihood.contactPosition = s.likelihood.shareOfPeak = s.likelihood.scale = 0.0;
    s.likelihood.contactAccuracy = s.likelihood.reversalRows = 0.0;
    return s;
}

} // namespace toy
