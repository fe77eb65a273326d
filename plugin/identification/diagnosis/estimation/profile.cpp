#include "plugin/identification/diagnosis/estimation/profile.h"

#include "plugin/identification/diagnosis/box_qp.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Fits on one side of one parameter, and the tolerance of the level (fraction of k90 in the root of the rise).
constexpr int kFits = 8;
constexpr double kNear = 0.1;
/// Decrease of chi-squared, in dispersions, that makes a fit a better minimum.
constexpr double kBetter = 1.0;
/// Height of a profile above its convex hull, in dispersions, that counts as numerical noise.
constexpr double kNoisy = 1.0;

struct Visited {
    Eigen::VectorXd x;
    double chiSquared = 0.0;
};

/// Profile of one parameter.
class Profile {
public:
    Profile(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& best, double dispersion, Index index)
        : evaluator_(evaluator), likelihood_(likelihood), best_(best), v_(evaluator.model(), best.point),
          dispersion_(dispersion), index_(index), least_(best.chiSquared) {
        chiSquareds_[0.0] = best.chiSquared;
    }

    /// Signed distance from the best fit at which the level is crossed; empty if no fit could be made.
    std::optional<double> end(double side, double half) {
        const double limit = this->limit(side);
        FitResult at = best_; // the farthest fit below the level
        double below = 0.0, next = std::min(half, limit);
        std::optional<double> above;
        bool refresh = true;
        for (int k = 0; k < kFits && next > 1e-9; ++k) {
            auto f = heldAt(at, side * next, refresh);
            if (!f || evaluator_.stopped())
                return below >= half && below > 0.0 ? std::optional<double>(side * below) : std::nullopt;
            count(side * next, *f);
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
            // Before active bounds of other parameters a secant converges slowly.
            if (above)
                next = below + (*above - below) * std::clamp((k90 - from) / (riseAt(side * *above) - from), 0.3, 0.7);
            else
                next = std::min(limit, below * std::clamp(k90 / std::max(from, 1e-9), 1.2, 3.0));
        }
        return side * (above ? 0.5 * (below + *above) : below);
    }

    /// Largest height above the lower convex hull of the profile, in dispersions; 0 for a smooth one.
    [[nodiscard]] double nonconvexity() const {
        std::vector<std::pair<double, double>> hull;
        for (const auto& p : chiSquareds_) {
            const auto above = [&](const auto& a, const auto& b) { // b above the chord from a to p
                return (b.second - a.second) * (p.first - a.first) >= (p.second - a.second) * (b.first - a.first);
            };
            while (hull.size() > 1 && above(hull[hull.size() - 2], hull.back()))
                hull.pop_back();
            hull.push_back(p);
        }
        double most = 0.0;
        std::size_t i = 0;
        for (const auto& [distance, chiSquared] : chiSquareds_) {
            while (i + 1 < hull.size() && distance > hull[i + 1].first)
                ++i;
            if (i + 1 == hull.size())
                break;
            const double share = (distance - hull[i].first) / (hull[i + 1].first - hull[i].first);
            most = std::max(most, chiSquared - (1.0 - share) * hull[i].second - share * hull[i + 1].second);
        }
        return most / dispersion_;
    }

    /// Interval below the raised level of a profile with numerical noise.
    Interval noisyInterval(double half) {
        std::vector<double> rises;
        for (const double side : {1.0, -1.0})
            for (const double share : {0.15, 0.35, 0.6})
                if (const auto m = chiSquaredAt(side, share * half, best_))
                    rises.push_back(*m);
        if (rises.size() < 3)
            return {0.0, 0.0};
        // At an active bound one side is high without numerical noise. Not upperMedian(): this one reorders, so that
        // the halves are the three lower and the three higher rises. Published intervals have this amplitude.
        const auto median = [](auto from, auto to) {
            std::nth_element(from, from + (to - from) / 2, to);
            return *(from + (to - from) / 2);
        };
        double amplitude = median(rises.begin(), rises.end());
        if (rises.size() == 6)
            amplitude = std::min(median(rises.begin(), rises.begin() + 3), median(rises.begin() + 3, rises.end()));
        noiseAmplitude_ = std::max(0.0, amplitude - least_);
        const double level = least_ + k90 * k90 * dispersion_ + 2.0 * noiseAmplitude_;
        return {-outermost(-1.0, half, level), outermost(1.0, half, level)};
    }

    [[nodiscard]] double least() const { return least_; }
    /// The best fit found on the way, if it is worth continuing from.
    [[nodiscard]] const std::optional<FitResult>& better() const { return better_; }
    [[nodiscard]] const std::vector<Visited>& visited() const { return visited_; }
    [[nodiscard]] double amplitude() const { return noiseAmplitude_; }
    void countFrom(double least) { least_ = std::min(least_, least); }

private:
    void count(double distance, const FitResult& f) {
        chiSquareds_[distance] = f.chiSquared;
        visited_.push_back({f.x, f.chiSquared});
        if (f.chiSquared < std::min(least_, best_.chiSquared - kBetter * dispersion_))
            better_ = f;
        least_ = std::min(least_, f.chiSquared);
    }

    [[nodiscard]] double limit(double side) const {
        return side > 0.0 ? v_.upper[index_] - best_.x[index_] : best_.x[index_] - v_.lower[index_];
    }

    /// Chi-squared of a fit from a start. Empty: beyond the bound, or the simulation fails.
    std::optional<double> chiSquaredAt(double side, double distance, FitResult start) {
        if (distance > limit(side) || evaluator_.stopped())
            return std::nullopt;
        bool refresh = false;
        const auto f = heldAt(start, side * distance, refresh);
        if (!f)
            return std::nullopt;
        count(side * distance, *f);
        return f->chiSquared;
    }

    /// Distance at which the outermost interval below the level ends.
    double outermost(double side, double half, double level) {
        constexpr double kShares[] = {1.0, 1.5, 2.2, 3.2, 4.8, 7.0}, kFarthest = 3.2;
        for (const double share : kShares) {
            const double distance = std::min(share * half, limit(side));
            // Larger distances only as long as the profile stays below the level.
            if (share > kFarthest && inside(side, level) < share / 1.6 * half)
                break;
            chiSquaredAt(side, distance, best_);
            if (distance >= limit(side))
                break;
        }
        const double in = inside(side, level);
        double out = limit(side), above = 0.0;
        for (const auto& [signedDistance, chiSquared] : chiSquareds_)
            if (const double d = side * signedDistance; d > in && d < out) {
                out = d;
                above = chiSquared;
            }
        if (above <= level) // no point further out
            return in;
        const double below = chiSquareds_.at(side * in);
        return in + (out - in) * (level - below) / (above - below);
    }

    /// Distance of the outermost point below the level.
    [[nodiscard]] double inside(double side, double level) const {
        double in = 0.0;
        for (const auto& [distance, chiSquared] : chiSquareds_)
            if (chiSquared <= level)
                in = std::max(in, side * distance);
        return in;
    }

    [[nodiscard]] double riseAt(double distance) const {
        return std::sqrt(std::max(0.0, chiSquareds_.at(distance) - least_) / dispersion_);
    }

    /// Linearised minimum over all other parameters, this one held at a distance from its best value.
    [[nodiscard]] Eigen::VectorXd stepFrom(const FitResult& f, double distance) const {
        constexpr double kFar = 2.0; // steps in one go
        Eigen::VectorXd lower = (v_.lower - f.x).cwiseMax(-kFar), upper = (v_.upper - f.x).cwiseMin(kFar);
        lower[index_] = upper[index_] = best_.x[index_] + distance - f.x[index_];
        Eigen::MatrixXd G = f.jacobian.transpose() * f.jacobian;
        G.diagonal() *= 1.0 + 1e-7; // insensitive parameters stay
        return solveBoxQp(G + v_.penalty, f.jacobian.transpose() * f.residual - v_.penalty * f.x, lower, upper);
    }

    /// Step that keeps the product of two factors constant at a distance. Empty: there is no product, or the bounds
    /// forbid it.
    [[nodiscard]] std::optional<Eigen::VectorXd> productStep(const FitResult& f, double distance) const {
        Index first = v_.nominal;
        for (const Term& t : best_.point.terms) {
            const CandidateEffect& c = evaluator_.model().candidates()[t.candidate];
            for (const DerivedQuantity& p : c.derived) {
                const Index a = first + static_cast<Index>(p.amplitude), e = first + static_cast<Index>(p.extent);
                if (index_ != a && index_ != e)
                    continue;
                Eigen::VectorXd x = f.x;
                x[index_] = best_.x[index_] + distance;
                const double is = derivedValue(p, v_, f.x, first), would = derivedValue(p, v_, x, first);
                if (is == 0.0 || would / is <= 0.0)
                    return std::nullopt;
                const Index other = index_ == a ? e : a;
                const Scalar& s = v_.scalar(other);
                const double value = toPhysical(s.scale, s.value + x[other] * s.step) * is / would;
                x[other] = (toInternal(s.scale, value) - s.value) / s.step;
                if (!(x[other] >= v_.lower[other] && x[other] <= v_.upper[other]))
                    return std::nullopt;
                return Eigen::VectorXd(x - f.x);
            }
            first += static_cast<Index>(c.parameters.size());
        }
        return std::nullopt;
    }

    /// Moves f by a step; false if that cannot be simulated. The Jacobian of f is updated in any case.
    bool moved(FitResult& f, const Eigen::VectorXd& step, FitResult& to) const {
        to = {};
        to.x = f.x + step;
        if (!evaluate(evaluator_, likelihood_, v_, to))
            return false;
        if (const auto change = likelihood_.whitenedDifference(to.responses, f.responses);
            change && step.squaredNorm() > 0.0)
            broydenUpdate(f.jacobian, step, *change);
        to.jacobian = f.jacobian;
        return true;
    }

    /// Fits all other parameters with this one held.
    void settle(FitResult& f, double distance) const {
        constexpr int kSteps = 3;
        for (int k = 0; k < kSteps && !evaluator_.stopped(); ++k) {
            const Eigen::VectorXd step = stepFrom(f, distance);
            const Eigen::VectorXd prior = v_.normalPrecision().cwiseProduct(step + 2.0 * f.x);
            if (f.residual.squaredNorm() - (f.residual - f.jacobian * step).squaredNorm() - step.dot(prior) <
                0.1 * dispersion_)
                return;
            FitResult to;
            if (!moved(f, step, to) || to.chiSquared >= f.chiSquared)
                continue; // with the updated Jacobian
            f = std::move(to);
        }
    }

    /// @param refresh whether derivatives may be taken anew; false after that
    [[nodiscard]] std::optional<FitResult> heldAt(const FitResult& from, double distance, bool& refresh) const {
        FitResult start = from, f;
        const bool straight = moved(start, stepFrom(start, distance), f);
        if (const auto step = productStep(from, distance)) {
            FitResult along = from, to;
            if (moved(along, *step, to) && (!straight || to.chiSquared < f.chiSquared))
                f = std::move(to);
        }
        if (f.residual.size() == 0)
            return std::nullopt;
        settle(f, distance);
        if (refresh && std::sqrt(std::max(0.0, f.chiSquared - least_) / dispersion_) > (1.0 + kNear) * k90) {
            refresh = false; // an active bound or a bend of the valley
            std::vector<Index> others;
            for (Index i = 0; i < v_.size(); ++i)
                if (i != index_)
                    others.push_back(i);
            differentiate(evaluator_, likelihood_, v_, f.x, 0.2, others, f.jacobian);
            settle(f, distance);
        }
        return f;
    }

    Evaluator& evaluator_;
    const Likelihood& likelihood_;
    const FitResult& best_;
    Variables v_;
    double dispersion_;
    Index index_;
    double least_; ///< chi-squared of the best fit so far
    std::optional<FitResult> better_;
    std::map<double, double> chiSquareds_; ///< by distance
    std::vector<Visited> visited_;
    double noiseAmplitude_ = 0.0; ///< amplitude of the numerical noise of chi-squared
};

} // namespace

namespace {

double halfWidth(const Variables& v, const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions, Index k) {
    return k90 * std::sqrt(std::max(0.0, posteriorCovariance(v, jacobian, dispersions[k])(k, k)));
}

} // namespace

std::vector<Interval> linearIntervals(const Variables& v, const FitResult& fitted, const Eigen::MatrixXd& jacobian,
                                      const Eigen::VectorXd& dispersions) {
    std::vector<Interval> out;
    for (Index k = v.nominal; k < v.size(); ++k) {
        const double half = halfWidth(v, jacobian, dispersions, k);
        out.push_back({std::max(v.lower[k], fitted.x[k] - half), std::min(v.upper[k], fitted.x[k] + half)});
    }
    return out;
}

Profiled profileIntervals(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                          const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions, bool stopAtBetter) {
    const Variables v(evaluator.model(), fitted.point);
    FitResult best = fitted;
    best.jacobian = jacobian;
    Profiled out{linearIntervals(v, fitted, jacobian, dispersions), {}};
    double least = fitted.chiSquared, amplitude = 0.0;
    std::vector<Visited> visited;
    for (Index k = v.nominal; k < v.size() && !out.better; ++k) {
        Interval& ci = out.intervals[static_cast<std::size_t>(k - v.nominal)];
        const double half = halfWidth(v, jacobian, dispersions, k);
        Profile profile(evaluator, likelihood, best, dispersions[k], k);
        profile.countFrom(least);
        if (const auto end = profile.end(1.0, half))
            ci.high = fitted.x[k] + *end;
        if (!(stopAtBetter && profile.better()))
            if (const auto end = profile.end(-1.0, half))
                ci.low = fitted.x[k] + *end;
        if (!(stopAtBetter && profile.better()) && profile.nonconvexity() > kNoisy && !evaluator.stopped()) {
            const Interval noisy = profile.noisyInterval(half);
            ci.low = std::min(ci.low, fitted.x[k] + noisy.low);
            ci.high = std::max(ci.high, fitted.x[k] + noisy.high);
        }
        least = profile.least();
        amplitude = std::max(amplitude, profile.amplitude());
        visited.insert(visited.end(), profile.visited().begin(), profile.visited().end());
        if (stopAtBetter)
            out.better = profile.better();
    }
    // A profile of one parameter may reach further in another one than that one's own profile.
    for (Index k = v.nominal; k < v.size(); ++k)
        for (const Visited& s : visited)
            if (s.chiSquared < least + k90 * k90 * dispersions[k] + 2.0 * amplitude) {
                Interval& ci = out.intervals[static_cast<std::size_t>(k - v.nominal)];
                ci.low = std::min(ci.low, s.x[k]);
                ci.high = std::max(ci.high, s.x[k]);
            }
    return out;
}

double derivedValue(const DerivedQuantity& p, const Variables& v, const Eigen::VectorXd& x, Index first) {
    const auto value = [&](std::size_t i) {
        const Index k = first + static_cast<Index>(i);
        return toPhysical(v.scalar(k).scale, v.scalar(k).value + x[k] * v.scalar(k).step);
    };
    return p.factor * value(p.amplitude) * value(p.extent);
}

Interval derivedInterval(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                         const Eigen::MatrixXd& jacobian, const DerivedQuantity& p, Index first) {
    const Variables v(evaluator.model(), fitted.point);
    const Index a = first + static_cast<Index>(p.amplitude), e = first + static_cast<Index>(p.extent);
    const double is = derivedValue(p, v, fitted.x, first);
    constexpr double kFar = 0.2;         // of a step
    const auto along = [&](double far) { // same product, another extent
        Eigen::VectorXd x = fitted.x;
        x[e] = std::clamp(x[e] + far, v.lower[e], v.upper[e]);
        x[a] = std::clamp(x[a] * is / derivedValue(p, v, x, first), v.lower[a], v.upper[a]);
        return x;
    };
    Eigen::MatrixXd J = jacobian;
    if (is != 0.0)
        J.col(e) = slopeAlong(evaluator, likelihood, v, fitted.x, along(kFar), along(-kFar), e);
    Eigen::VectorXd one = fitted.x;
    one[a] += 1.0;
    const double perStep = derivedValue(p, v, one, first) - is;
    const Eigen::VectorXd dispersions =
        dispersionsOf(likelihood, v, fitted.residual, J, chiSquaredPerReading(likelihood, fitted));
    const double half = std::abs(perStep) * halfWidth(v, J, dispersions, a);
    return {is - half, is + half};
}

} // namespace supercircle::diagnosis
