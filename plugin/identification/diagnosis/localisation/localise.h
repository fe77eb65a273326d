#pragma once
// Where a misfit sits, with a family-wise error: the residual in noise units, freed from what the fit could have
// absorbed, is compared with every window of a family, and the largest statistic with its own distribution under pure
// noise.
//
// u = (1 - Q Q') r with Q an orthonormal basis of the free columns of the Jacobian. For a window w with whitened
// indicator s_w (a constant shift of the raw reading there, which a residual that was merely summed would see less of
// behind an AR(1) whitening): Z_w = s_w' u / sd, and the energy E_w = (sum of u^2 in w), made normal by its
// cube root (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684) and standardised by the null's own
// mean and deviation. Null: B draws of white noise, with heavy tails where the readings show them, and of as much more
// noise as what is known of its size allows, projected alike; no simulation. p-values by single-step max-T (P. H.
// Westfall, S. S. Young, "Resampling-Based Multiple Testing" (1993), 2.3), of statistics in which u counts as three at
// most, either way.
//
// The signatures of the catalogue's effects are a family of their own, because there are few of them: p is that of the
// smaller of the two families' p, by its own distribution under the null (min-p), and says whether anything is missing,
// wherever it was looked for.
//
// Report: of the windows of one run and channel the one with the largest statistic, then the largest of those that do
// not overlap it, and so on (likelihood ratio selection: X. J. Jeng, T. T. Cai, H. Li, J. Am. Stat. Assoc. 105 (2010)
// 1156). Joining all significant windows instead gave one long stretch, because every window that contains a strong
// part is significant. What is reported is part of the family, so its p-values keep their meaning.

#include "plugin/identification/diagnosis/localisation/windows.h"
#include "plugin/identification/diagnosis/misfit.h"

#include <cstdint>
#include <vector>

namespace supercircle::diagnosis {

/// p, family-wise, at which something stands out of the noise.
constexpr double kFamilyWise = 0.05;

struct Localisation {
    double p = 1.0; ///< of the largest statistic
    /// The same, carried on by Bonferroni's bound where it lies beyond all draws.
    double tail = 1.0;
    double critical = 0.0;  ///< of a signature's |statistic| (without any: of a window's) at 5 %, family-wise
    double signature = 0.0; ///< the largest of a signature's, in deviations
    /// Largest first, disjoint.
    std::vector<Window> significant;
    std::size_t family = 0; ///< statistics that were looked at
};

/// @param free columns of the Jacobian that are not held by a bound
/// @param signatures whitened changes of all readings, a column each, that are looked for too; both signs count
Localisation localise(const Misfit& misfit, const Eigen::VectorXd& residual, const Eigen::MatrixXd& free,
                      std::uint64_t seed, int draws = 999, const Eigen::MatrixXd& signatures = {});

/// Orthonormal basis of the columns' span; columns below 1e-8 of the largest are nothing.
Eigen::MatrixXd basisOf(const Eigen::MatrixXd& columns);

} // namespace supercircle::diagnosis
