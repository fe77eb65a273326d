#pragma once
// Other places where a local effect may be, and the other side to which an effect may go.
//
// Force alone hardly tells in which half of an arch a bend is, and what a bend does in one place the nominal curvature
// with a bend to the other side does in another: the misfit over the place has several hollows, and a search ends in
// one of them. A bend of .07 degrees (case 33 of seed 2041) was found at .666 of the arc, [.55, .77], for .374. So the
// fit is begun again from its mirror image and from the best probes elsewhere; what ends below the level of 90 %
// belongs to the intervals, and what ends lower is the fit.
//
// Of an effect that acts to one side of a symmetric set-up (a head off its axis, a tilt, a gradient along the specimen,
// gravity across) force alone does not tell which: an offset of 1.2 mm was found as -1.2 mm, [-1.22, -1.17]. So it is
// begun again with the sign changed, too, where that explains anything.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/screening/screen.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// Fits of the same single effect that end elsewhere along the arc, or of one without a place to the other side,
/// whatever their misfit.
/// @param without misfit of the fit without the effect
std::vector<Fitted> otherHollows(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                 const std::vector<Screened>& screened, double without);

/// Widens 90 % intervals of a fit's numbers by what is below their level in other hollows. Of an effect without a place
/// it says which amplitudes go to either side (Interval::eitherSide): those that are not 0 to one side nor to the
/// other.
/// @param dispersions of each of x (sandwich.h)
/// @return the best of the mirror images that were found so, or null
const Fitted* widenBy(const std::vector<Fitted>& hollows, const Model& model, const Fitted& fitted,
                      const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals);

} // namespace supercircle::diagnosis
