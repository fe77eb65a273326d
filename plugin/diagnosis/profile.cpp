#include "plugin/diagnosis/profile.h"

#include "plugin/diagnosis/box.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double k90 = 1.6448536269514722; // of a normal distribution
/// Fits on one side of one number, and how near to the level is near enough (of k90, by the root of the misfit's rise).
constexpr int kFits = 8;
constexpr double kNear = 0.1;
/// Fall of the misfit, in dispersions, by which a fit was not the best one.
constexpr double kBetter = 1.0;

/// One number's profile.
class Profile {
public:
    Profile(Evaluator& evaluator, const Misfit& misfit, const Fitted& best, double dispersion, Index of)
        : evaluator_(evaluator), misfit_(misfit), best_(best), v_(evaluator.model(), best.point),
          dispersion_(std::max(1.0, dispersion)), of_(of), least_(best.misfit) {
        misfits_[0.0] = best.misfit;
    }

    /// Where the level is passed, as a distance from the best fit with the side's sign; empty: no fit could be made.
    std::optional<double> end(double side, double half) {
        const double limit = side > 0.0 ? v_.upper[of_] - best_.x[of_] : best_.x[of_] - v_.lower[of_];
        Fitted at = best_; // the farthest one below the level
        double below = 0.0, next = std::min(half, limit);
        std::optional<double> above;
        bool refresh = true;
        for (int k = 0; k < kFits && next > 1e-9; ++k) {
            auto f = heldAt(at, side * next, refresh);
            if (!f || evaluator_.stopped())
                return below >= half && below > 0.0 ? std::optional<double>(side * below) : std::nullopt;
            misfits_[side * next] = f->misfit;
            if (f->misfit < std::min(least_, best_.misfit - kBetter * dispersion_))
                better_ = *f;
            least_ = std::min(least_, f->misfit);
            const double rise = riseAt(side * next);
            if (rise < k90) {
                below = next;
                at = std::move(*f);
            } else {
                above = next;
            }
            if (std::abs(rise / k90 - 1.0) < kNear)
                return side * next;
            if (!above && below >= limit)
                return side * limit;
            const double from = riseAt(side * below);
            if (above && *above - below < kNear * *above)
                break;
            // Bounds of other numbers are walls, before which a secant creeps.
            if (above)
                next = below + (*above - below) * std::clamp((k90 - from) / (riseAt(side * *above) - from), 0.3, 0.7);
            else
                next = std::min(limit, below * std::clamp(k90 / std::max(from, 1e-9), 1.2, 3.0));
        }
        return side * (above ? 0.5 * (below + *above) : below);
    }

    [[nodiscard]] double least() const { return least_; }
    /// The best fit that was come upon, if it is worth going on from.
    [[nodiscard]] const std::optional<Fitted>& better() const { return better_; }
    void countFrom(double least) { least_ = std::min(least_, least); }

private:
    [[nodiscard]] double riseAt(double distance) const {
        return std::sqrt(std::max(0.0, misfits_.at(distance) - least_) / dispersion_);
    }

    /// Smallest misfit, linearised, of all other numbers with this one at a distance from its best.
    [[nodiscard]] Eigen::VectorXd stepFrom(const Fitted& f, double distance) const {
        constexpr double kFar = 2.0; // steps in one go
        Eigen::VectorXd lower = (v_.lower - f.x).cwiseMax(-kFar), upper = (v_.upper - f.x).cwiseMin(kFar);
        lower[of_] = upper[of_] = best_.x[of_] + distance - f.x[of_];
        Eigen::MatrixXd G = f.jacobian.transpose() * f.jacobian;
        G.diagonal() *= 1.0 + 1e-7; // what the readings do not see stays where it is
        return boxMinimum(G, f.jacobian.transpose() * f.residual, lower, upper);
    }

    /// @return f moved by a step; false if that cannot be simulated. The Jacobian of f learns from it in any case.
    bool moved(Fitted& f, const Eigen::VectorXd& step, Fitted& to) const {
        to = {};
        to.x = f.x + step;
        if (!evaluate(evaluator_, misfit_, v_, to))
            return false;
        if (const auto change = misfit_.difference(to.responses, f.responses); change && step.squaredNorm() > 0.0)
            learnFrom(f.jacobian, step, *change);
        to.jacobian = f.jacobian;
        return true;
    }

    /// Fits all other numbers again, this one held where it is.
    void settle(Fitted& f, double distance) const {
        constexpr int kSteps = 3;
        for (int k = 0; k < kSteps && !evaluator_.stopped(); ++k) {
            const Eigen::VectorXd step = stepFrom(f, distance);
            if (f.misfit - (f.residual - f.jacobian * step).squaredNorm() < 0.1 * dispersion_)
                return;
            Fitted to;
            if (!moved(f, step, to) || to.misfit >= f.misfit)
                continue; // the Jacobian knows more now
            f = std::move(to);
        }
    }

    /// @param refresh whether derivatives may be taken anew; false after that
    [[nodiscard]] std::optional<Fitted> heldAt(const Fitted& from, double distance, bool& refresh) const {
        Fitted start = from, f;
        if (!moved(start, stepFrom(start, distance), f))
            return std::nullopt;
        settle(f, distance);
        if (refresh && std::sqrt(std::max(0.0, f.misfit - least_) / dispersion_) > (1.0 + kNear) * k90) {
            refresh = false; // a wall, or a bend that old derivatives do not know
            std::vector<Index> others;
            for (Index i = 0; i < v_.size(); ++i)
                if (i != of_)
                    others.push_back(i);
            differentiate(evaluator_, misfit_, v_, f.x, 0.2, others, f.jacobian);
            settle(f, distance);
        }
        return f;
    }

    Evaluator& evaluator_;
    const Misfit& misfit_;
    const Fitted& best_;
    Variables v_;
    double dispersion_;
    Index of_;
    double least_; ///< misfit of the best fit that was seen
    std::optional<Fitted> better_;
    std::map<double, double> misfits_; ///< by distance
};

} // namespace

std::vector<Interval> linearIntervals(const Variables& v, const Fitted& fitted, const Eigen::MatrixXd& jacobian,
                                      double dispersion) {
    const Eigen::MatrixXd covariance = posteriorOf(v, jacobian, dispersion);
    std::vector<Interval> out;
    for (Index k = v.nominal; k < v.size(); ++k) {
        const double half = k90 * std::sqrt(std::max(0.0, covariance(k, k)));
        out.push_back({std::max(v.lower[k], fitted.x[k] - half), std::min(v.upper[k], fitted.x[k] + half)});
    }
    return out;
}

Profiled profileIntervals(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                          const Eigen::MatrixXd& jacobian, double dispersion, bool stopAtBetter) {
    const Variables v(evaluator.model(), fitted.point);
    Fitted best = fitted;
    best.jacobian = jacobian;
    const Eigen::MatrixXd covariance = posteriorOf(v, jacobian, dispersion);
    Profiled out{linearIntervals(v, fitted, jacobian, dispersion), {}};
    double least = fitted.misfit;
    for (Index k = v.nominal; k < v.size() && !out.better; ++k) {
        auto& [low, high] = out.intervals[static_cast<std::size_t>(k - v.nominal)];
        const double half = k90 * std::sqrt(std::max(0.0, covariance(k, k)));
        Profile profile(evaluator, misfit, best, dispersion, k);
        profile.countFrom(least);
        if (const auto end = profile.end(1.0, half))
            high = fitted.x[k] + *end;
        if (!(stopAtBetter && profile.better()))
            if (const auto end = profile.end(-1.0, half))
                low = fitted.x[k] + *end;
        least = profile.least();
        if (stopAtBetter)
            out.better = profile.better();
    }
    return out;
}

double productOf(const Product& p, const Variables& v, const Eigen::VectorXd& x, Index first) {
    const auto value = [&](std::size_t i) {
        const Index k = first + static_cast<Index>(i);
        return outer(v.scalar(k).scale, v.scalar(k).value + x[k] * v.scalar(k).step);
    };
    return p.factor * value(p.amplitude) * value(p.extent);
}

Interval productInterval(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                         const Eigen::MatrixXd& jacobian, double dispersion, const Product& p, Index first) {
    const Variables v(evaluator.model(), fitted.point);
    const Index a = first + static_cast<Index>(p.amplitude), e = first + static_cast<Index>(p.extent);
    const double is = productOf(p, v, fitted.x, first);
    constexpr double kFar = 0.2;         // of a step, as other derivatives
    const auto along = [&](double far) { // as much in all, over another extent
        Eigen::VectorXd x = fitted.x;
        x[e] = std::clamp(x[e] + far, v.lower[e], v.upper[e]);
        x[a] = std::clamp(x[a] * is / productOf(p, v, x, first), v.lower[a], v.upper[a]);
        return x;
    };
    Eigen::MatrixXd J = jacobian;
    if (is != 0.0)
        J.col(e) = slopeAlong(evaluator, misfit, v, fitted.x, along(kFar), along(-kFar), e);
    Eigen::VectorXd one = fitted.x;
    one[a] += 1.0;
    const double perStep = productOf(p, v, one, first) - is;
    const double half = k90 * std::abs(perStep) * std::sqrt(std::max(0.0, posteriorOf(v, J, dispersion)(a, a)));
    return {is - half, is + half};
}

} // namespace supercircle::diagnosis
