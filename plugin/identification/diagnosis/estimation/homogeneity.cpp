#include "plugin/identification/diagnosis/estimation/homogeneity.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/model/stated_numbers.h"

#include <boost/math/distributions/chi_squared.hpp>

namespace supercircle::diagnosis {

namespace {

/// The columns of a Jacobian, with one of them split by runs; columns of runs that do not know it are zero.
Eigen::MatrixXd splitByRuns(const Likelihood& likelihood, const Eigen::MatrixXd& jacobian, Eigen::Index column) {
    const auto runs = static_cast<Eigen::Index>(likelihood.runs());
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(jacobian.rows(), jacobian.cols() + runs);
    out.leftCols(jacobian.cols()) = jacobian;
    out.col(column).setZero();
    for (Eigen::Index r = 0; r < runs; ++r) {
        const Eigen::Index from = likelihood.start(static_cast<std::size_t>(r)),
                           rows = likelihood.rowsOf(static_cast<std::size_t>(r));
        out.col(jacobian.cols() + r).segment(from, rows) = jacobian.col(column).segment(from, rows);
    }
    return out;
}

/// Sets the parameter whose values of single runs explain most, and their range.
void nameNumber(const Model& model, const Likelihood& likelihood, const FitResult& fitted, double common,
                Homogeneity& out) {
    const Variables v(model, fitted.point);
    double most = 0.0;
    for (Eigen::Index i = 0; i < v.nominal; ++i) {
        if (v.scalar(i).specimen >= 0 || v.scalar(i).batch >= 0)
            continue; // it differs already
        const Eigen::MatrixXd J = splitByRuns(likelihood, fitted.jacobian, i), Q = basisOf(J);
        const double q = (Q.transpose() * fitted.residual).squaredNorm() - common;
        if (!(q > most))
            continue;
        most = q;
        // Numbers that change the readings alike would without bounds share any value among them.
        const auto runs = static_cast<Eigen::Index>(likelihood.runs());
        Eigen::VectorXd lower(J.cols()), upper(J.cols());
        lower << v.lower - fitted.x, Eigen::VectorXd::Constant(runs, -kFarthestNumber - fitted.x[i]);
        upper << v.upper - fitted.x, Eigen::VectorXd::Constant(runs, kFarthestNumber - fitted.x[i]);
        const Eigen::VectorXd own =
            solveBoxQp(J.transpose() * J, J.transpose() * fitted.residual, lower, upper).tail(runs);
        const Scalar& number = v.scalar(i);
        const auto valueOf = [&](double by) { // beyond the interval, too
            return toPhysical(number.scale, number.value + (fitted.x[i] + by) * number.step);
        };
        out.number = number.name;
        out.unit = number.unit;
        out.values.clear();
        for (std::size_t r = 0; r < likelihood.runs(); ++r)
            out.values.emplace_back(likelihood.data().runs[r].name, valueOf(own[static_cast<Eigen::Index>(r)]));
    }
}

} // namespace

Homogeneity homogeneityOf(const Model& model, const Likelihood& likelihood, const FitResult& fitted) {
    Homogeneity out;
    double own = 0.0, ranks = 0.0;
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const Eigen::MatrixXd Q = basisOf(fitted.jacobian.middleRows(likelihood.start(r), likelihood.rowsOf(r)));
        own += (Q.transpose() * fitted.residual.segment(likelihood.start(r), likelihood.rowsOf(r))).squaredNorm();
        ranks += static_cast<double>(Q.cols());
    }
    const Eigen::MatrixXd Q = basisOf(fitted.jacobian);
    const double common = (Q.transpose() * fitted.residual).squaredNorm();
    out.q = std::max(0.0, own - common);
    out.degrees = ranks - static_cast<double>(Q.cols());
    if (out.degrees > 0.0)
        out.p = boost::math::cdf(boost::math::complement(boost::math::chi_squared(out.degrees), out.q));
    if (out.differ())
        nameNumber(model, likelihood, fitted, common, out);
    return out;
}

} // namespace supercircle::diagnosis
