#pragma once
// A first look at every effect: how much of the misfit its signature could explain beside the nominal parameters, and
// the smallest size these runs could have shown.
//
// Signatures are finite differences between simulations with and without the effect at sizes that matter: yield,
// adhesion, gaps or an offset of a symmetric set-up have no derivative at zero. With s the whitened signature of a
// probe and J the nominal Jacobian, the gain is
//     min |u - J d|^2 - min |u - J d - a s|^2    over d inside the stated intervals and a >= 0 (either sign where the
// effect has one). The size seen with 80 % power is (c + 0.84) / |(I - QQ') s| of the probe, c the critical value of
// the whole search; it is given in units of the effect's first probe. This only chooses what is fitted; a screen alone
// confuses effects.

#include "plugin/identification/diagnosis/fit.h"

#include <vector>

namespace supercircle::diagnosis {

struct Screened {
    std::size_t candidate = 0;
    std::size_t probe = 0;
    std::vector<double> values; ///< inner, the probe stretched by `stretch`
    double stretch = 0.0;       ///< best a
    double gain = 0.0;          ///< drop of |residual|^2
    double size = 0.0;          ///< |s| of the probe
    double own = 0.0;           ///< |(I - QQ') s|: what the nominal parameters cannot absorb
    double times = 1.0;         ///< the probe in units of a size that matters, the candidate's first probe
    bool simulated = false;
    Eigen::VectorXd signature; ///< whitened change of all readings; empty: not simulated
    /// In units of a size that matters; infinite: never.
    [[nodiscard]] double visible(double critical) const {
        return own > 1e-9 ? times * (critical + 0.84) / own : std::numeric_limits<double>::infinity();
    }
};

/// One entry per probe of every candidate, in their order.
/// @param share of the probes' sizes at which effects are simulated; signatures are stretched back
std::vector<Screened> screen(Evaluator& evaluator, const Misfit& misfit, const Fitted& nominal, double share = 1.0);

/// Sets gain, stretch and values of a probe whose signature is known, against the residual of a fit.
/// @param out its values are those of the probe
void explain(const Fitted& fitted, const Variables& variables, const Candidate& candidate, Screened& out);

/// The values of a probe at the size that explains most beside a fit. Where the size that the signature, stretched,
/// asks for does not keep half of what it promises, sizes between it and the probe's own are simulated: a law with a
/// threshold does nothing below it (a yield moment that was never reached made a fit stand still where plasticity was
/// hidden).
std::vector<double> settledValues(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                  const Screened& probe);

/// The values of a candidate with its amplitudes multiplied by `factor`, inside its bounds.
std::vector<double> stretched(const Candidate& candidate, const std::vector<double>& values, double factor);

} // namespace supercircle::diagnosis
