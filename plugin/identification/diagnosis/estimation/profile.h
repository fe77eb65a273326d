#pragma once
// Intervals of what was fitted, by profiles of the likelihood.
//
// Two numbers of a law often do each other's work: depth and width of a defect, static friction and the way to get
// there, force and range of adhesion. The fit is as good along a valley, and where the valley is bent an interval that
// follows its tangent ends at its walls: of such laws 9 of 16 intervals of 90 % held the truth in a blind set, of all
// others 20 of 27. A profile goes along the valley: one number is moved and held, all others are fitted again, until
// the misfit has grown by what 90 % allow. A dozen fits a number, most of which end after two steps. A profile that
// comes upon a better fit than the one it started from ends there: that fit is where to go on from. Counted from the
// better fit and drawn around the other one, an interval began at the value it belongs to.
//
// Stacks, snaps and feet that stick make a misfit rough: next to a fit, a hundredth of an interval away, it stands two
// to seventy units higher, because the fit was chosen among its dents. Counted from the bottom of a dent an interval
// ends at its walls: five estimates of a blind set stood at one end of theirs, with the truth outside all of them. So
// where points of a profile lie above the convex hull of the others, points on both sides tell how deep dents are, the
// level is raised by that, once for the dent of the fit and once for those beside it, and the interval ends behind the
// outermost point below it, whatever lies between.
//
// Along a valley of a product the way begins with the product kept, and whatever point any profile comes to below the
// level belongs to the intervals of all numbers.
//
// Tried instead: draws from the linearised posterior cut off at the bounds (where the simulation's own error pushes a
// fit into a corner of its box, the corner becomes certain).
//
// Source: D. J. Venzon, S. H. Moolgavkar, "A method for computing profile-likelihood-based confidence intervals",
// Appl. Statist. 37 (1988) 87.

#include "plugin/identification/diagnosis/estimation/sandwich.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/result.h"

#include <optional>
#include <vector>

namespace supercircle::diagnosis {

/// Ends of the 90 % intervals of the numbers behind the nominal ones, in x, by the linearised posterior.
/// @param jacobian d(whitened simulation)/dx at the fit
/// @param dispersions of each of x (sandwich.h)
std::vector<Interval> linearIntervals(const Variables& variables, const Fitted& fitted, const Eigen::MatrixXd& jacobian,
                                      const Eigen::VectorXd& dispersions);

struct Profiled {
    std::vector<Interval> intervals; ///< in x; not all of them where there is a better fit
    std::optional<Fitted> better;    ///< one number of it was held: it can be fitted further
};

/// The same by profiles, first steps by the linearised posterior. A fit that cannot be made (a simulation fails, the
/// diagnosis is stopped) leaves that end where the linear one is.
/// @param stopAtBetter whether a fit that is better by more than one noise unit's square ends it
Profiled profileIntervals(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                          const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions,
                          bool stopAtBetter = false);

/// 90 % interval of what a law is worth in all, linearised in coordinates in which the product is one and its extent,
/// the product held, the other: from derivatives by the factors themselves an error of 5 % in one of them makes the
/// length of the valley, which may be anything, a width of the product.
/// @param first variable of the product's candidate
Interval productInterval(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                         const Eigen::MatrixXd& jacobian, const Product& product, Eigen::Index first);

/// Its value at x.
double productOf(const Product& product, const Variables& variables, const Eigen::VectorXd& x, Eigen::Index first);

/// What is known of a fit's numbers behind the nominal ones.
struct Spread {
    std::vector<Interval> intervals;             ///< in x
    std::vector<std::vector<Interval>> products; ///< of each term; empty: not asked for
};

} // namespace supercircle::diagnosis
