// The variables of a fit: scaled parameters, their bounds and penalties.

#include "plugin/identification/diagnosis/fit.h"

#include <algorithm>

namespace supercircle::diagnosis {

Variables::Variables(const Model& model, const ParameterPoint& like) : scalars_(model.nominal()), like_(like) {
    nominal = static_cast<Eigen::Index>(scalars_.size());
    for (const Term& t : like.terms)
        for (const Scalar& s : model.candidates()[t.candidate].parameters)
            scalars_.push_back(s);
    lower.resize(static_cast<Eigen::Index>(scalars_.size()));
    upper = lower;
    for (Eigen::Index i = 0; i < size(); ++i) {
        lower[i] = (scalar(i).lower - scalar(i).value) / scalar(i).step;
        upper[i] = (scalar(i).upper - scalar(i).value) / scalar(i).step;
    }
    // A number that may be wrong is fitted as such, and no second time inside its interval.
    constexpr double kHeld = 1e-3; // half-widths, as its variance has to be positive
    for (const Term& t : like.terms)
        if (const CandidateEffect& c = model.candidates()[t.candidate]; c.isNumber()) {
            lower[c.number] = std::max(lower[c.number], -kHeld);
            upper[c.number] = std::min(upper[c.number], kHeld);
        }
    penalty = Eigen::MatrixXd::Zero(size(), size());
    for (Eigen::Index i = 0; i < nominal; ++i) {
        penalty(i, i) = scalar(i).precision;
        if (scalar(i).batch >= 0) {
            const auto factor = static_cast<std::size_t>(scalar(i).batch);
            const double scatter = factor < like.scatter.size() ? like.scatter[factor] : 1.0;
            penalty(i, i) = 1.0 / (scatter * scatter);
        }
    }
    Eigen::Index first = nominal;
    for (const Term& t : like.terms) {
        const auto n = static_cast<Eigen::Index>(t.values.size());
        if (model.candidates()[t.candidate].learned)
            penalty.block(first, first, n, n) = smoothingPenalty(n, t.smoothing);
        first += n;
    }
}

/// P. H. C. Eilers, B. D. Marx (1996): second differences of neighbouring coefficients, and their size.
Eigen::MatrixXd smoothingPenalty(Eigen::Index n, double smoothing) {
    constexpr double kBend = 1.0, kSize = 6.0; // in steps: sigma of second differences and of coefficients
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(n - 2, n);
    for (Eigen::Index i = 0; i + 2 < n; ++i)
        d.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
    return smoothing / (kBend * kBend) * d.transpose() * d + Eigen::MatrixXd::Identity(n, n) / (kSize * kSize);
}

Eigen::VectorXd Variables::of(const ParameterPoint& point) const {
    Eigen::VectorXd x(size());
    Eigen::Index i = 0;
    const auto put = [&](double v) {
        x[i] = (v - scalar(i).value) / scalar(i).step;
        ++i;
    };
    std::for_each(point.nominal.begin(), point.nominal.end(), put);
    for (const Term& t : point.terms)
        std::for_each(t.values.begin(), t.values.end(), put);
    return x.cwiseMax(lower).cwiseMin(upper);
}

ParameterPoint Variables::at(const Eigen::VectorXd& x) const {
    ParameterPoint p = like_;
    Eigen::Index i = 0;
    const auto put = [&](double& v) {
        const Scalar& s = scalar(i);
        v = std::clamp(s.value + x[i] * s.step, s.lower, s.upper);
        ++i;
    };
    std::for_each(p.nominal.begin(), p.nominal.end(), put);
    for (Term& t : p.terms)
        std::for_each(t.values.begin(), t.values.end(), put);
    return p;
}

} // namespace supercircle::diagnosis
