#include "plugin/diagnosis/nominal.h"

#include "plugin/diagnosis/random.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

class Search {
public:
    Search(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings,
           const std::function<void(double, const std::string&)>& stage)
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
        const Variables v = variables();
        std::vector<Index> all(static_cast<std::size_t>(v.size()));
        std::iota(all.begin(), all.end(), Index{0});
        differentiate(evaluator_, *out_.misfit, v, out_.fit.x, 0.2, all, out_.fit.jacobian);
        return std::move(out_);
    }

private:
    [[nodiscard]] Variables variables() const { return {evaluator_.model(), out_.fit.point}; }
    [[nodiscard]] double perRow() const { return out_.fit.misfit / static_cast<double>(out_.misfit->present()); }

    /// Rows weighed by what the simulation looks like at a point, then a fit from there. False: stopped, or why not.
    bool fitFrom(const Point& at) {
        const auto fine = evaluator_.everywhere({at}, Fineness::Fine).front();
        const auto coarse = evaluator_.everywhere({at}, Fineness::Coarse).front();
        if (evaluator_.stopped())
            return false;
        if (out_.failure = firstFailure(data_, fine); !out_.failure.empty())
            return false;
        out_.misfit = std::make_unique<Misfit>(data_, noise_, fine, coarse, settings_.misfit);
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
        const Eigen::VectorXd elsewhere = out_.fit.x.unaryExpr([](double x) { return x > 0.0 ? -0.7 : 0.7; });
        FitSettings given;
        given.rival = out_.fit.misfit / 2.0;
        Fitted other = fit(evaluator_, *out_.misfit, variables().at(elsewhere), given);
        if (other.failure.empty() && other.misfit < out_.fit.misfit - 1.0)
            out_.fit = std::move(other);
    }

    void fromAllOver() {
        constexpr std::size_t kStarts = 3;
        constexpr double kWorthIt = 0.5; // of the misfit: another branch, not the same one a little better
        stage_(0.16, "nominal fit from all over");
        const std::vector<Point> starts = nearest(kStarts);
        std::optional<Fitted> best;
        for (std::size_t i = 0; i < starts.size() && !evaluator_.stopped(); ++i) {
            FitSettings given;
            given.rival = best ? best->misfit : kWorthIt * out_.fit.misfit;
            Fitted other = fit(evaluator_, *out_.misfit, starts[i], given);
            if (other.failure.empty() && other.misfit < given.rival)
                best = std::move(other);
        }
        if (best && !evaluator_.stopped())
            fitFrom(best->point);
    }

    /// Of points all over the box those whose coarse simulations are nearest to the recordings.
    [[nodiscard]] std::vector<Point> nearest(std::size_t count) const {
        constexpr int kPoints = 32;
        constexpr double kFar = 2.0; // steps within which is looked for what has no bounds
        const Variables v = variables();
        const Eigen::VectorXd lower = v.lower.cwiseMax(-kFar), width = v.upper.cwiseMin(kFar) - lower;
        Random random(settings_.seed + 5);
        std::vector<Point> points;
        for (int i = 0; i < kPoints; ++i)
            points.push_back(v.at(lower + width.unaryExpr([&](double w) { return w * random.uniform(); })));
        const auto there = evaluator_.everywhere(points, Fineness::Coarse);
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (const auto residual = out_.misfit->residual(there[i]))
                order.emplace_back(residual->squaredNorm() + out_.misfit->charge(there[i]).sum(), i);
        std::sort(order.begin(), order.end());
        order.resize(std::min(count, order.size()));
        std::vector<Point> out;
        for (const auto& [misfit, i] : order)
            out.push_back(points[i]);
        return out;
    }

    const Data& data_;
    Evaluator& evaluator_;
    const Noise& noise_;
    const Settings& settings_;
    const std::function<void(double, const std::string&)>& stage_;
    Nominal out_;
};

} // namespace

std::string firstFailure(const Data& data, const std::vector<Response>& all) {
    for (std::size_t r = 0; r < all.size(); ++r)
        if (!all[r].failure.empty())
            return data.runs[r].name + " cannot be simulated as it is described: " + all[r].failure;
    return {};
}

Nominal fitNominal(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings,
                   const std::function<void(double, const std::string&)>& stage) {
    return Search(data, evaluator, noise, settings, stage).run();
}

} // namespace supercircle::diagnosis
