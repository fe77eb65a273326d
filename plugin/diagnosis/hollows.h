#pragma once
// Other places where a local effect may be.
//
// Force alone hardly tells in which half of an arch a bend is, and what a bend does in one place the nominal curvature
// with a bend to the other side does in another: the misfit over the place has several hollows, and a search ends in
// one of them. A bend of .07 degrees (case 33 of seed 2041) was found at .666 of the arc, [.55, .77], for .374. So the
// fit is begun again from its mirror image and from the best probes elsewhere; what ends below the level of 90 %
// belongs to the intervals, and what ends lower is the fit.

#include "plugin/diagnosis/result.h"
#include "plugin/diagnosis/screen.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// Fits of the same single effect that end elsewhere along the arc, whatever their misfit; none of an effect without a
/// place.
std::vector<Fitted> otherHollows(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                 const std::vector<Screened>& screened);

/// Widens 90 % intervals of a fit's numbers by what is below their level in other hollows.
/// @param dispersions of each of x (sandwich.h)
void widenBy(const std::vector<Fitted>& hollows, const Variables& variables, const Fitted& fitted,
             const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals);

} // namespace supercircle::diagnosis
