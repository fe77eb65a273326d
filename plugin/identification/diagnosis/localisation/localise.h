#pragma once
// Localisation of a misfit with a family-wise error. The projected residual u = (1 - Q Q') r is compared with a family
// of windows, Q an orthonormal basis of the free columns of the Jacobian.
// Shift Z_w = s_w' u / sd with the whitened indicator s_w; energy E_w = sum of u^2 in w, made normal by its cube root
// (E. B. Wilson, M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684). Null: B draws of noise, projected alike. p by
// single-step max-T (P. H. Westfall, S. S. Young, "Resampling-Based Multiple Testing" (1993), 2.3) with clipped u.
// Signatures of catalogue effects are a second family; the two combine by min-p (decision 0077).
// Report: the largest windows of each run and channel that do not overlap (X. J. Jeng, T. T. Cai, H. Li, J. Am. Stat.
// Assoc. 105 (2010) 1156).

#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/localisation/windows.h"
#include "plugin/identification/diagnosis/stop.h"

#include <cstdint>
#include <vector>

namespace supercircle::diagnosis {

/// Family-wise p-value below which a misfit is significant.
constexpr double kFamilyWise = 0.05;

struct Localisation {
    double p = 1.0; ///< family-wise, of the largest statistic
    /// The same, continued by Bonferroni's bound beyond all draws.
    double extendedP = 1.0;
    double critical =
        0.0; ///< 5 % critical value, family-wise, of a signature's |statistic| (of a window's without signatures)
    double largestSignature = 0.0; ///< largest |statistic| of a signature, sigma
    /// Largest first, disjoint.
    std::vector<ResidualWindow> significant;
    std::size_t familySize = 0; ///< number of statistics
};

/// @param free columns of the Jacobian of parameters off their bounds
/// @param signatures whitened changes of all readings, one column each, tested too; both signs count
/// @param stop throws Stopped
Localisation localise(const Likelihood& likelihood, const Eigen::VectorXd& residual, const Eigen::MatrixXd& free,
                      std::uint64_t seed, int draws = 999, const Eigen::MatrixXd& signatures = {},
                      const StopToken& stop = StopToken());

/// Orthonormal basis of the columns' span; columns below 1e-8 of the largest count as zero.
Eigen::MatrixXd basisOf(const Eigen::MatrixXd& columns);

} // namespace supercircle::diagnosis
