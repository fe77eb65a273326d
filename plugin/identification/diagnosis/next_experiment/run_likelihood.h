#pragma once
// Likelihood of a predicted run: noise and excluded rows are modelled as for a real recording (likelihood.h).
//
// Two things differ. A jump present in only one of two simulations does not count by itself. The discretisation error
// is unknown, because a candidate run is simulated once at coarse fidelity; on strips the predicted value of repeats is
// therefore too high (decision 0086).

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>
#include <optional>

namespace supercircle::diagnosis {

class RunLikelihood {
public:
    /// @param truth the predicted recording without noise, at least 8 readings
    /// @param noise of the sensors; a new camera has the usual noise
    /// @param zeroWindow as RecordedData::zeroWindow, s
    /// @param repeats number of repeats with a common model error
    RunLikelihood(const CandidateRun& candidateRun, const CandidateRunResponse& truth, const Noise& noise,
                  double zeroWindow, std::size_t repeats);
    RunLikelihood(const RunLikelihood&) = delete;
    RunLikelihood& operator=(const RunLikelihood&) = delete;

    /// Whitened difference a - b of one repeat. Empty: not comparable.
    [[nodiscard]] std::optional<Eigen::VectorXd> difference(const CandidateRunResponse& a,
                                                            const CandidateRunResponse& b) const;

private:
    RecordedData data_;
    Likelihood likelihood_; ///< of data_
};

} // namespace supercircle::diagnosis
