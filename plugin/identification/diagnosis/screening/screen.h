#pragma once
// Screening of all effects: how much of chi-squared a signature could explain beside the nominal parameters, and the
// detectable amplitude.
//
// Signatures are finite differences at relevant amplitudes, because yield, adhesion, play and offsets have no
// derivative at zero (decision 0078). With s the whitened signature of a probe and J the nominal Jacobian, the gain is
// min |u - J d|^2 - min |u - J d - a s|^2 over d inside the stated intervals and a >= 0 (either sign where allowed).
// The amplitude detectable with 80 % power is (c + 0.84) / |(I - QQ') s|, c the critical value of the localisation, in
// units of the first probe. Screening only selects what is fitted.

#include "plugin/identification/diagnosis/fit.h"

#include <vector>

namespace supercircle::diagnosis {

/// Half-widths from which on a nominal parameter stands at the end of its interval.
constexpr double kEndOfInterval = 0.98;

struct ScreenedProbe {
    std::size_t candidate = 0;
    std::size_t probe = 0;
    std::vector<double> values;     ///< internal values, the probe scaled by `factor`
    double factor = 0.0;            ///< best a
    double gain = 0.0;              ///< decrease of |residual|^2
    double norm = 0.0;              ///< |s| of the probe
    double independentNorm = 0.0;   ///< |(I - QQ') s|: the part that nominal parameters cannot absorb
    double relativeAmplitude = 1.0; ///< the probe in relevant amplitudes (those of the first probe)
    bool simulated = false;
    Eigen::VectorXd signature; ///< whitened change of all readings; empty: not simulated
    /// Detectable amplitude in relevant amplitudes; infinite: never.
    [[nodiscard]] double detectable(double critical) const {
        return independentNorm > 1e-9 ? relativeAmplitude * (critical + 0.84) / independentNorm
                                      : std::numeric_limits<double>::infinity();
    }
};

/// @param share of the probe amplitudes at which effects are simulated; signatures are scaled back
std::vector<ScreenedProbe> screen(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& nominal,
                                  double share = 1.0);

/// Sets gain, factor and values of a probe with known signature, against the residual of a fit.
/// @param out its values are those of the probe
void explain(const FitResult& fitted, const Variables& variables, const CandidateEffect& candidate, ScreenedProbe& out);

/// The decrease of |residual|^2 that several signatures can bring together, in linear approximation.
/// @param factors receives the best factor of each
double explainTogether(const FitResult& fitted, const Variables& variables,
                       const std::vector<const CandidateEffect*>& candidates,
                       const std::vector<const Eigen::VectorXd*>& signatures, std::vector<double>& factors);

/// The values of a probe at the amplitude with the largest gain. If the linearised amplitude keeps less than half of
/// its gain, others are simulated, because a law with a threshold has no effect below it.
std::vector<double> bestAmplitudeValues(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                                        const ScreenedProbe& probe);

/// The values of a candidate with its amplitudes multiplied by `factor`, inside its bounds.
std::vector<double> scaledValues(const CandidateEffect& candidate, const std::vector<double>& values, double factor);

} // namespace supercircle::diagnosis
