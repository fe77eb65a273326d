#include "plugin/identification/diagnosis/estimation/profile.h"

#include "plugin/identification/diagnosis/box.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Fits on one side of one number, and how near to the level is near enough (of k90, by the root of the misfit's rise).
constexpr int kFits = 8;
constexpr double kNear = 0.1;
/// Fall of the misfit, in dispersions, by which a fit was not the best one.
constexpr double kBetter = 1.0;
/// Height above the convex hull of a profile's points, in dispersions, from which on it is rough.
constexpr double kRough = 1.0;

struct Visited {
    Eigen::VectorXd x;
    double misfit = 0.0;
};

/// One number's profile.
class Profile {
public:
    Profile(Evaluator& evaluator, const Misfit& misfit, const Fitted& best, double dispersion, Index of)
        : evaluator_(evaluator), misfit_(misfit), best_(best), v_(evaluator.model(), best.point),
          dispersion_(dispersion), of_(of), least_(best.misfit) {
        misfits_[0.0] = best.misfit;
    }

    /// Where the level is passed, as a distance from the best fit with the side's sign; empty: no fit could be made.
    std::optional<double> end(double side, double half) {
        const double limit = this->limit(side);
        Fitted at = best_; // the farthest one below the level
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
            // Bounds of other numbers are walls, before which a secant creeps.
            if (above)
                next = below + (*above - below) * std::clamp((k90 - from) / (riseAt(side * *above) - from), 0.3, 0.7);
            else
                next = std::min(limit, below * std::clamp(k90 / std::max(from, 1e-9), 1.2, 3.0));
        }
        return side * (above ? 0.5 * (below + *above) : below);
    }

    /// Height of the highest point above the lower convex hull of all, in dispersions: 0 where it is smooth.
    [[nodiscard]] double roughness() const {
        std::vector<std::pair<double, double>> hull;
        for (const auto& p : misfits_) {
            const auto above = [&](const auto& a, const auto& b) { // b above the chord from a to p
                return (b.second - a.second) * (p.first - a.first) >= (p.second - a.second) * (b.first - a.first);
            };
            while (hull.size() > 1 && above(hull[hull.size() - 2], hull.back()))
                hull.pop_back();
            hull.push_back(p);
        }
        double most = 0.0;
        std::size_t i = 0;
        for (const auto& [distance, misfit] : misfits_) {
            while (i + 1 < hull.size() && distance > hull[i + 1].first)
                ++i;
            if (i + 1 == hull.size())
                break;
            const double share = (distance - hull[i].first) / (hull[i + 1].first - hull[i].first);
            most = std::max(most, misfit - (1.0 - share) * hull[i].second - share * hull[i + 1].second);
        }
        return most / dispersion_;
    }

    /// Ends of what lies below the level where the misfit is rough.
    Interval roughly(double half) {
        std::vector<double> depth;
        for (const double side : {1.0, -1.0})
            for (const double share : {0.15, 0.35, 0.6})
                if (const auto m = misfitAt(side, share * half, best_))
                    depth.push_back(*m);
        if (depth.size() < 3)
            return {0.0, 0.0};
        // Beside a wall one side stands high that is not rough.
        const auto median = [](auto from, auto to) {
            std::nth_element(from, from + (to - from) / 2, to);
            return *(from + (to - from) / 2);
        };
        double dent = median(depth.begin(), depth.end());
        if (depth.size() == 6)
            dent = std::min(median(depth.begin(), depth.begin() + 3), median(depth.begin() + 3, depth.end()));
        dent_ = std::max(0.0, dent - least_);
        const double level = least_ + k90 * k90 * dispersion_ + 2.0 * dent_;
        return {-outermost(-1.0, half, level), outermost(1.0, half, level)};
    }

    [[nodiscard]] double least() const { return least_; }
    /// The best fit that was come upon, if it is worth going on from.
    [[nodiscard]] const std::optional<Fitted>& better() const { return better_; }
    [[nodiscard]] const std::vector<Visited>& seen() const { return seen_; }
    [[nodiscard]] double dent() const { return dent_; }
    void countFrom(double least) { least_ = std::min(least_, least); }

private:
    void count(double distance, const Fitted& f) {
        misfits_[distance] = f.misfit;
        seen_.push_back({f.x, f.misfit});
        if (f.misfit < std::min(least_, best_.misfit - kBetter * dispersion_))
            better_ = f;
        least_ = std::min(least_, f.misfit);
    }

    [[nodiscard]] double limit(double side) const {
        return side > 0.0 ? v_.upper[of_] - best_.x[of_] : best_.x[of_] - v_.lower[of_];
    }

    /// Of a fit from a start, which becomes that fit; known ones are not made again. Empty: behind the bound, or it
    /// cannot be made.
    std::optional<double> misfitAt(double side, double distance, Fitted start) {
        if (distance > limit(side) || evaluator_.stopped())
            return std::nullopt;
        bool refresh = false;
        const auto f = heldAt(start, side * distance, refresh);
        if (!f)
            return std::nullopt;
        count(side * distance, *f);
        return f->misfit;
    }

    /// Where the outermost stretch below the level ends, as a distance.
    double outermost(double side, double half, double level) {
        constexpr double kShares[] = {1.0, 1.5, 2.2, 3.2, 4.8, 7.0}, kFarthest = 3.2;
        for (const double share : kShares) {
            const double distance = std::min(share * half, limit(side));
            // Further out than usual only as long as that leads below the level.
            if (share > kFarthest && inside(side, level) < share / 1.6 * half)
                break;
            misfitAt(side, distance, best_);
            if (distance >= limit(side))
                break;
        }
        const double in = inside(side, level);
        double out = limit(side), above = 0.0;
        for (const auto& [signedDistance, misfit] : misfits_)
            if (const double d = side * signedDistance; d > in && d < out) {
                out = d;
                above = misfit;
            }
        if (above <= level) // nothing is known further out
            return in;
        const double below = misfits_.at(side * in);
        return in + (out - in) * (level - below) / (above - below);
    }

    /// Distance of the outermost point below the level.
    [[nodiscard]] double inside(double side, double level) const {
        double in = 0.0;
        for (const auto& [distance, misfit] : misfits_)
            if (misfit <= level)
                in = std::max(in, side * distance);
        return in;
    }

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

    /// Of two factors whose product readings show: the step to the distance that keeps the product. Empty: none, or it
    /// cannot be kept.
    [[nodiscard]] std::optional<Eigen::VectorXd> productStep(const Fitted& f, double distance) const {
        Index first = v_.nominal;
        for (const Term& t : best_.point.terms) {
            const Candidate& c = evaluator_.model().candidates()[t.candidate];
            for (const Product& p : c.products) {
                const Index a = first + static_cast<Index>(p.amplitude), e = first + static_cast<Index>(p.extent);
                if (of_ != a && of_ != e)
                    continue;
                Eigen::VectorXd x = f.x;
                x[of_] = best_.x[of_] + distance;
                const double is = productOf(p, v_, f.x, first), would = productOf(p, v_, x, first);
                if (is == 0.0 || would / is <= 0.0)
                    return std::nullopt;
                const Index other = of_ == a ? e : a;
                const Scalar& s = v_.scalar(other);
                const double value = outer(s.scale, s.value + x[other] * s.step) * is / would;
                x[other] = (inner(s.scale, value) - s.value) / s.step;
                if (!(x[other] >= v_.lower[other] && x[other] <= v_.upper[other]))
                    return std::nullopt;
                return Eigen::VectorXd(x - f.x);
            }
            first += static_cast<Index>(c.parameters.size());
        }
        return std::nullopt;
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
            if (f.residual.squaredNorm() - (f.residual - f.jacobian * step).squaredNorm() < 0.1 * dispersion_)
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
        const bool straight = moved(start, stepFrom(start, distance), f);
        if (const auto step = productStep(from, distance)) {
            Fitted along = from, to;
            if (moved(along, *step, to) && (!straight || to.misfit < f.misfit))
                f = std::move(to);
        }
        if (f.residual.size() == 0)
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
    std::vector<Visited> seen_;
    double dent_ = 0.0; ///< how deep the misfit's dents are, where it is rough
};

} // namespace

namespace {

double halfWidth(const Variables& v, const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions, Index k) {
    return k90 * std::sqrt(std::max(0.0, posteriorOf(v, jacobian, dispersions[k])(k, k)));
}

} // namespace

std::vector<Interval> linearIntervals(const Variables& v, const Fitted& fitted, const Eigen::MatrixXd& jacobian,
                                      const Eigen::VectorXd& dispersions) {
    std::vector<Interval> out;
    for (Index k = v.nominal; k < v.size(); ++k) {
        const double half = halfWidth(v, jacobian, dispersions, k);
        out.push_back({std::max(v.lower[k], fitted.x[k] - half), std::min(v.upper[k], fitted.x[k] + half)});
    }
    return out;
}

Profiled profileIntervals(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                          const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions, bool stopAtBetter) {
    const Variables v(evaluator.model(), fitted.point);
    Fitted best = fitted;
    best.jacobian = jacobian;
    Profiled out{linearIntervals(v, fitted, jacobian, dispersions), {}};
    double least = fitted.misfit, dent = 0.0;
    std::vector<Visited> seen;
    for (Index k = v.nominal; k < v.size() && !out.better; ++k) {
        Interval& ci = out.intervals[static_cast<std::size_t>(k - v.nominal)];
        const double half = halfWidth(v, jacobian, dispersions, k);
        Profile profile(evaluator, misfit, best, dispersions[k], k);
        profile.countFrom(least);
        if (const auto end = profile.end(1.0, half))
            ci.high = fitted.x[k] + *end;
        if (!(stopAtBetter && profile.better()))
            if (const auto end = profile.end(-1.0, half))
                ci.low = fitted.x[k] + *end;
        if (!(stopAtBetter && profile.better()) && profile.roughness() > kRough && !evaluator.stopped()) {
            const Interval rough = profile.roughly(half);
            ci.low = std::min(ci.low, fitted.x[k] + rough.low);
            ci.high = std::max(ci.high, fitted.x[k] + rough.high);
        }
        least = profile.least();
        dent = std::max(dent, profile.dent());
        seen.insert(seen.end(), profile.seen().begin(), profile.seen().end());
        if (stopAtBetter)
            out.better = profile.better();
    }
    // Where one number's profile went, another one may have gone further than its own did.
    for (Index k = v.nominal; k < v.size(); ++k)
        for (const Visited& s : seen)
            if (s.misfit < least + k90 * k90 * dispersions[k] + 2.0 * dent) {
                Interval& ci = out.intervals[static_cast<std::size_t>(k - v.nominal)];
                ci.low = std::min(ci.low, s.x[k]);
                ci.high = std::max(ci.high, s.x[k]);
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
                         const Eigen::MatrixXd& jacobian, const Product& p, Index first) {
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
    const Eigen::VectorXd dispersions = dispersionsOf(misfit, v, fitted.residual, J, misfitPerRow(misfit, fitted));
    const double half = std::abs(perStep) * halfWidth(v, J, dispersions, a);
    return {is - half, is + half};
}

} // namespace supercircle::diagnosis
