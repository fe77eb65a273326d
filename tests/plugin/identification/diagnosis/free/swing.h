#pragma once
// A free oscillation in closed form: reading = A f(t) cos(2 pi frequency t), where f is 1 without damping, exp(-a t)
// with the effect "viscous" and 1 / (1 + b t) with the effect "quadratic" (the envelope of quadratic drag).

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/model/random.h"

#include <cmath>

namespace swing {

using namespace supercircle::diagnosis;

constexpr double kNoise = 0.1, kFrequency = 1.0, kRate = 25.0; // deg, Hz, Hz

class Oscillator : public Model {
public:
    /// @param data of which only times are used
    /// @param interval half-width of the frequency, Hz
    Oscillator(const RecordedData& data, double interval, bool quadratic = true) : data_(data) {
        nominal_.resize(2);
        nominal_[0] = {"frequency", "Hz", "", kFrequency, kFrequency - interval, kFrequency + interval, interval};
        nominal_[1] = {"amplitude", "deg", "", 40.0, 38.0, 42.0, 2.0};
        for (const char* label : {"viscous", "quadratic"}) {
            CandidateEffect c;
            c.label = label;
            c.slot = "load";
            c.law = label;
            c.parameters = {{"rate", "1/s", "", 0.0, 0.0, 5.0, 0.05}};
            c.parameters[0].amplitude = true;
            c.probes = {{0.05}, {0.3}};
            if (quadratic || c.label == "viscous")
                candidates_.push_back(c);
        }
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }
    [[nodiscard]] std::string identity() const override { return "oscillator"; }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity,
                                    const std::atomic<bool>*) const override {
        Response out;
        out.force = data_.runs[r].time.unaryExpr([&](double t) {
            double envelope = p.nominal[1];
            for (const Term& term : p.terms)
                envelope *= candidates_[term.candidate].label == "viscous" ? std::exp(-term.values[0] * t)
                                                                           : 1.0 / (1.0 + term.values[0] * t);
            return envelope * std::cos(2.0 * M_PI * p.nominal[0] * t);
        });
        return out;
    }

private:
    const RecordedData& data_;
    std::vector<Scalar> nominal_;
    std::vector<CandidateEffect> candidates_;
};

/// A recording with quadratic drag.
/// @param frequency Hz; @param rate of the damping, 1/s
inline RecordedData recording(std::uint64_t seed, double frequency, double rate, double seconds) {
    Random random(seed);
    supercircle::experiment::Run run;
    run.file = "swing.csv";
    run.driveTime = {0.0, seconds};
    run.driveDisplacement = {0.0, 0.0};
    run.samplingRate = kRate;
    for (int k = 0; k < seconds * kRate; ++k) {
        const double t = k / kRate;
        run.readings.time.push_back(t);
        run.readings.force.push_back(40.5 / (1.0 + rate * t) * std::cos(2.0 * M_PI * frequency * t) +
                                     kNoise * random.normal());
    }
    RecordedData data;
    data.free = true;
    data.channel = "angle";
    data.unit = "deg";
    data.statedForceNoise = kNoise;
    data.zeroHalfWidth = 0.1;
    data.runs = {recordedRun(run, 0, true, 1.0, {})};
    data.runs[0].name = "swing.csv";
    return data;
}

} // namespace swing
