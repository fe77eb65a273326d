#include "plugin/identification/diagnosis/estimation/homogeneity.h"

#include "plugin/identification/diagnosis/localisation/localise.h"

#include <boost/math/distributions/chi_squared.hpp>

namespace supercircle::diagnosis {

Homogeneity homogeneityOf(const Likelihood& likelihood, const FitResult& fitted) {
    Homogeneity out;
    double own = 0.0, ranks = 0.0;
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const Eigen::MatrixXd Q = basisOf(fitted.jacobian.middleRows(likelihood.start(r), likelihood.rowsOf(r)));
        own += (Q.transpose() * fitted.residual.segment(likelihood.start(r), likelihood.rowsOf(r))).squaredNorm();
        ranks += static_cast<double>(Q.cols());
    }
    const Eigen::MatrixXd Q = basisOf(fitted.jacobian);
    out.q = std::max(0.0, own - (Q.transpose() * fitted.residual).squaredNorm());
    out.degrees = ranks - static_cast<double>(Q.cols());
    if (out.degrees > 0.0)
        out.p = boost::math::cdf(boost::math::complement(boost::math::chi_squared(out.degrees), out.q));
    return out;
}

} // namespace supercircle::diagnosis
