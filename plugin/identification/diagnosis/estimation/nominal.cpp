#include "plugin/identification/diagnosis/estimation/nominal.h"

#include "plugin/identification/diagnosis/box.h"
#include "plugin/identification/diagnosis/model/random.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Name of the first run that cannot be simulated, and why; empty: all can.
std::string firstFailure(const Data& data, const std::vector<Response>& all) {
    for (std::size_t r = 0; r < all.size(); ++r)
        if (!all[r].failure.empty())
            return data.runs[r].name + " cannot be simulated as it is described: " + all[r].failure;
    return {};
}

/// Of points all over the box the three whose coarse simulations are nearest to the recordings.
std::vector<Point> nearest(Evaluator& evaluator, const Misfit& misfit, const Variables& v, std::uint64_t seed) {
    constexpr int kPoints = 32;
    constexpr std::size_t kStarts = 3;
    constexpr double kFar = 2.0; // steps within which is looked for what has no bounds
    const Eigen::VectorXd lower = v.lower.cwiseMax(-kFar), width = v.upper.cwiseMin(kFar) - lower;
    Random random(seed + 5);
    std::vector<Point> points;
    for (int i = 0; i < kPoints; ++i)
        points.push_back(v.at(lower + width.unaryExpr([&](double w) { return w * random.uniform(); })));
    const auto there = evaluator.everywhere(points, Fineness::Coarse);
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const auto residual = misfit.residual(there[i]))
            order.emplace_back(residual->squaredNorm() + misfit.charge(there[i]).sum(), i);
    std::sort(order.begin(), order.end());
    order.resize(std::min(kStarts, order.size()));
    std::vector<Point> out;
    for (const auto& [size, i] : order)
        out.push_back(points[i]);
    return out;
}

Point otherSide(const Variables& v, const Eigen::VectorXd& x) {
    return v.at(x.unaryExpr([](double at) { return at > 0.0 ? -0.7 : 0.7; }));
}

/// What the misfit would gain by a step to where the derivatives lead, inside the box.
double promised(const Variables& v, const Fitted& f) {
    Eigen::MatrixXd G = f.jacobian.transpose() * f.jacobian;
    G.diagonal().array() += 1e-6 * std::max(1e-12, G.diagonal().mean()); // numbers that change nothing stay
    const Eigen::VectorXd step = boxMinimum(G, f.jacobian.transpose() * f.residual, v.lower - f.x, v.upper - f.x);
    return f.residual.squaredNorm() - (f.residual - f.jacobian * step).squaredNorm();
}

void differentiateAll(Evaluator& evaluator, const Misfit& misfit, Fitted& f) {
    constexpr double kHeld = 3.0; // squares; a fit that ends by itself leaves .3
    const Variables v(evaluator.model(), f.point);
    std::vector<Index> all(static_cast<std::size_t>(v.size()));
    std::iota(all.begin(), all.end(), Index{0});
    f.atEdge = differentiate(evaluator, misfit, v, f.x, 0.2, all, f.jacobian, Fineness::Fine) && promised(v, f) > kHeld;
}

/// The lowest of the fits from several starts, if it is below `limit`.
/// @param rival a misfit beside which a search that creeps is given up
std::optional<Fitted> lowest(Evaluator& evaluator, const Misfit& misfit, const std::vector<Point>& starts, double rival,
                             double limit) {
    std::optional<Fitted> best;
    for (std::size_t i = 0; i < starts.size() && !evaluator.stopped(); ++i) {
        FitSettings given;
        given.rival = rival;
        Fitted other = fit(evaluator, misfit, starts[i], given);
        if (evaluator.stopped() || !other.failure.empty() || other.misfit >= limit)
            continue;
        limit = other.misfit;
        rival = std::min(rival, limit);
        best = std::move(other);
    }
    return best;
}

class Search {
public:
    Search(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings, const Stage& stage)
        : data_(data), evaluator_(evaluator), noise_(noise), settings_(settings), stage_(stage) {}

    Nominal run() {
        constexpr double kNothingBetter = 1.3; // misfit per row, below which there is nothing better to find
        constexpr double kFarOff = 4.0;        // and beyond which the recordings may lie on another branch
        stage_(0.02, "nominal fit");
        Point at;
        for (const Scalar& s : evaluator_.model().nominal())
            at.nominal.push_back(s.value);
        evaluator_.checkStore(at, Fineness::Coarse);
        for (int round = 0; round < 2; ++round) {
            if (!fitFrom(at))
                return std::move(out_);
            at = out_.fit.point;
        }
        if (perRow() > kNothingBetter)
            fromTheOtherSide();
        if (!data_.free && perRow() > kFarOff) // free runs are fitted in growing pieces
            fromAllOver();
        if (!out_.failure.empty() || evaluator_.stopped())
            return std::move(out_);
        differentiateAll(evaluator_, *out_.misfit, out_.fit);
        return std::move(out_);
    }

private:
    [[nodiscard]] Variables variables() const { return {evaluator_.model(), out_.fit.point}; }
    [[nodiscard]] double perRow() const { return out_.fit.misfit / static_cast<double>(out_.misfit->present()); }

    /// Rows weighed by what the simulation looks like at a point, then a fit from there. False: stopped, or why not.
    bool fitFrom(const Point& at) {
        const auto fine = evaluator_.everywhere({at}, Fineness::Fine).front();
        const auto finer = evaluator_.everywhere({at}, Fineness::Finer).front();
        if (evaluator_.stopped())
            return false;
        if (out_.failure = firstFailure(data_, fine); !out_.failure.empty())
            return false;
        out_.misfit = std::make_unique<Misfit>(data_, noise_, fine, finer, settings_.misfit);
        out_.fit = fit(evaluator_, *out_.misfit, at);
        if (evaluator_.stopped())
            return false;
        if (!out_.fit.failure.empty()) {
            const std::string which = firstFailure(data_, out_.fit.responses);
            out_.failure = which.empty() ? out_.fit.failure : which;
        }
        return out_.failure.empty();
    }

    void fromTheOtherSide() {
        stage_(0.14, "nominal fit from elsewhere");
        const double here = out_.fit.misfit;
        if (auto other = lowest(evaluator_, *out_.misfit, {otherSide(variables(), out_.fit.x)}, here / 2.0, here - 1.0))
            out_.fit = std::move(*other);
    }

    void fromAllOver() {
        constexpr double kWorthIt = 0.5; // of the misfit: another branch, not the same one a little better
        stage_(0.16, "nominal fit from all over");
        const double enough = kWorthIt * out_.fit.misfit;
        const auto starts = nearest(evaluator_, *out_.misfit, variables(), settings_.seed);
        if (const auto best = lowest(evaluator_, *out_.misfit, starts, enough, enough); best && !evaluator_.stopped())
            fitFrom(best->point);
    }

    const Data& data_;
    Evaluator& evaluator_;
    const Noise& noise_;
    const Settings& settings_;
    const Stage& stage_;
    Nominal out_;
};

} // namespace

Nominal fitNominal(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings,
                   const Stage& stage) {
    return Search(data, evaluator, noise, settings, stage).run();
}

namespace {

bool moved(Evaluator& evaluator, const Misfit& misfit, const std::vector<Point>& starts, Fitted& found) {
    constexpr double kLower = 0.5; // squares: what a fit's end is uncertain by
    auto other = lowest(evaluator, misfit, starts, found.misfit, found.misfit - kLower);
    if (!other || evaluator.stopped())
        return false;
    found = std::move(*other);
    differentiateAll(evaluator, misfit, found);
    return true;
}

} // namespace

bool searchOn(Evaluator& evaluator, const Settings& settings, const Misfit& misfit, Fitted& found) {
    const Variables v(evaluator.model(), found.point);
    std::vector<Point> starts = nearest(evaluator, misfit, v, settings.seed);
    starts.push_back(otherSide(v, found.x));
    return moved(evaluator, misfit, starts, found);
}

bool searchFrom(Evaluator& evaluator, const Misfit& misfit, const Point& start, Fitted& found) {
    return moved(evaluator, misfit, {start}, found);
}

} // namespace supercircle::diagnosis
