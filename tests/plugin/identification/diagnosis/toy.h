#pragma once
// A drive that compresses a spring with dry friction, in closed form, so that all parameters are known.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/model/random.h"

#include <string>
#include <vector>

namespace toy {

using namespace supercircle::diagnosis;

/// Down by 0.01 m and back at `speed` m/s, with dwells before, between and after; `rate` readings per s.
RecordedRun motion(const std::string& name, double speed, double rate);

/// Force = stiffness x + friction sign(v) + additions. Derived models change the result.
class Spring : public Model {
public:
    /// @param learns offers a law of displacement to learn, and no cubic law
    explicit Spring(const RecordedData& data, bool dashpot = true, bool learns = false);
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }
    [[nodiscard]] std::string identity() const override { return "spring"; }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity,
                                    const std::atomic<bool>*) const override;

    static std::vector<double> law(const std::vector<double>& values, const std::vector<double>& at);

protected:
    const RecordedData& data_;

private:
    /// Change of the response of run `r` by a derived model.
    virtual void alter(std::size_t /*r*/, const ParameterPoint& /*p*/, Response& /*out*/) const {}

    std::vector<Scalar> nominal_;
    std::vector<CandidateEffect> candidates_;
};

/// Adds effects to recordings of the toy.
void hide(RecordedData& data, const Model& model, const std::vector<Term>& effects);

constexpr double kWhite = 0.009, kColoured = 0.005, kMemory = 0.25; // N, N, s

void addNoise(RecordedRun& run, Random& random);

/// Recordings of a spring with true values inside the stated intervals, and a hidden effect.
RecordedData recordings(std::uint64_t seed, const std::string& masked = {}, double size = 0.0, double rate = 25.0);

/// Adds fixed markers at these arc fractions to the first run, at every reading or fewer.
RecordedRun& withMarkers(RecordedData& data, const std::vector<double>& arcFraction, Eigen::Index every = 1);

/// A closed form has no model error.
DiagnosisSettings exact(std::uint64_t seed = 1);

} // namespace toy
