#include "plugin/identification/diagnosis/estimation/baseline_fit.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/estimation/scatter.h"
#include "plugin/identification/diagnosis/model/random.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Name of the first run that cannot be simulated, and why; empty: all can.
std::string firstFailure(const RecordedData& data, const std::vector<Response>& all) {
    for (std::size_t r = 0; r < all.size(); ++r)
        if (!all[r].failure.empty())
            return data.runs[r].name + " cannot be simulated with the stated parameters: " + all[r].failure;
    return {};
}

/// Of points all over the box the three whose coarse simulations are nearest to the recordings.
std::vector<ParameterPoint> bestCoarsePoints(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v,
                                             std::uint64_t seed) {
    constexpr int kPoints = 32;
    constexpr std::size_t kStarts = 3;
    constexpr double kFar = 2.0; // steps, search range of parameters without bounds
    const Eigen::VectorXd lower = v.lower.cwiseMax(-kFar), width = v.upper.cwiseMin(kFar) - lower;
    Random random(seed + 5);
    std::vector<ParameterPoint> points;
    for (int i = 0; i < kPoints; ++i)
        points.push_back(v.at(lower + width.unaryExpr([&](double w) { return w * random.uniform(); })));
    const auto there = evaluator.simulateAllRuns(points, Fidelity::Coarse);
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const auto residual = likelihood.residual(there[i]))
            order.emplace_back(residual->squaredNorm() + likelihood.maskPenalty(there[i]).sum(), i);
    std::sort(order.begin(), order.end());
    order.resize(std::min(kStarts, order.size()));
    std::vector<ParameterPoint> out;
    for (const auto& [size, i] : order)
        out.push_back(points[i]);
    return out;
}

ParameterPoint oppositePoint(const Variables& v, const Eigen::VectorXd& x) {
    return v.at(x.unaryExpr([](double at) { return at > 0.0 ? -0.7 : 0.7; }));
}

/// Decrease of chi-squared that the derivatives predict inside the bounds.
double predictedDecrease(const Variables& v, const FitResult& f) {
    const Eigen::VectorXd precision = v.normalPrecision(), to = precision.cwiseProduct(f.x);
    Eigen::MatrixXd G = f.jacobian.transpose() * f.jacobian;
    G.diagonal().array() += 1e-6 * std::max(1e-12, G.diagonal().mean()); // insensitive parameters stay
    G.diagonal() += precision;
    const Eigen::VectorXd step = solveBoxQp(G, f.jacobian.transpose() * f.residual - to, v.lower - f.x, v.upper - f.x);
    return f.residual.squaredNorm() - (f.residual - f.jacobian * step).squaredNorm() -
           step.dot(precision.cwiseProduct(step) + 2.0 * to);
}

void differentiateAll(Evaluator& evaluator, const Likelihood& likelihood, FitResult& f) {
    constexpr double kHeld = 3.0; // delta chi-squared; a converged fit leaves 0.3
    const Variables v(evaluator.model(), f.point);
    std::vector<Index> all(static_cast<std::size_t>(v.size()));
    std::iota(all.begin(), all.end(), Index{0});
    f.atBranchEdge = differentiate(evaluator, likelihood, v, f.x, 0.2, all, f.jacobian, Fidelity::Fine) &&
                     predictedDecrease(v, f) > kHeld;
}

/// The best of the fits from several starts, if its chi-squared is below `limit`.
/// @param competitor chi-squared above which a slow search is stopped
std::optional<FitResult> lowest(Evaluator& evaluator, const Likelihood& likelihood,
                                const std::vector<ParameterPoint>& starts, double competitor, double limit) {
    std::optional<FitResult> best;
    for (std::size_t i = 0; i < starts.size() && !evaluator.stopped(); ++i) {
        FitSettings given;
        given.competitor = competitor;
        FitResult other = fit(evaluator, likelihood, starts[i], given);
        if (evaluator.stopped() || !other.failure.empty() || other.chiSquared >= limit)
            continue;
        limit = other.chiSquared;
        competitor = std::min(competitor, limit);
        best = std::move(other);
    }
    return best;
}

class BaselineSearch {
public:
    BaselineSearch(const RecordedData& data, Evaluator& evaluator, const Noise& noise,
                   const DiagnosisSettings& settings, const StageReporter& stage)
        : data_(data), evaluator_(evaluator), noise_(noise), settings_(settings), stage_(stage) {}

    BaselineFit run() {
        constexpr double kNothingBetter = 1.3; // chi-squared per reading that no other start improves
        constexpr double kFarOff = 4.0;        // chi-squared per reading that suggests another branch
        stage_(0.02, "baseline fit");
        ParameterPoint at = statedPoint(evaluator_.model());
        evaluator_.checkCache(at, Fidelity::Coarse);
        for (int round = 0; round < 2; ++round) {
            if (!fitFrom(at))
                return std::move(out_);
            at = out_.fit.point;
        }
        if (perReading() > kNothingBetter)
            restartFromOppositeSide();
        if (!data_.free && perReading() > kFarOff) // free runs use the progressive fit
            restartAcrossBounds();
        if (!out_.failure.empty() || evaluator_.stopped())
            return std::move(out_);
        if (!evaluator_.model().batch().empty())
            settleScatter(evaluator_, *out_.likelihood, out_.fit);
        differentiateAll(evaluator_, *out_.likelihood, out_.fit);
        return std::move(out_);
    }

private:
    [[nodiscard]] Variables variables() const { return {evaluator_.model(), out_.fit.point}; }
    [[nodiscard]] double perReading() const {
        return out_.fit.chiSquared / static_cast<double>(out_.likelihood->countedRows());
    }

    /// Evaluates the model error at a point, then fits from there. False: stopped or failed.
    bool fitFrom(const ParameterPoint& at) {
        const auto fine = evaluator_.simulateAllRuns({at}, Fidelity::Fine).front();
        const auto finer = evaluator_.simulateAllRuns({at}, Fidelity::Finer).front();
        if (evaluator_.stopped())
            return false;
        if (out_.failure = firstFailure(data_, fine); !out_.failure.empty())
            return false;
        out_.likelihood =
            std::make_unique<Likelihood>(data_, noise_, fine, finer, settings_.likelihood.in(data_.units));
        out_.fit = fit(evaluator_, *out_.likelihood, at);
        if (evaluator_.stopped())
            return false;
        if (!out_.fit.failure.empty()) {
            const std::string which = firstFailure(data_, out_.fit.responses);
            out_.failure = which.empty() ? out_.fit.failure : which;
        }
        return out_.failure.empty();
    }

    void restartFromOppositeSide() {
        stage_(0.14, "baseline fit from the opposite side");
        const double here = out_.fit.chiSquared;
        if (auto other =
                lowest(evaluator_, *out_.likelihood, {oppositePoint(variables(), out_.fit.x)}, here / 2.0, here - 1.0))
            out_.fit = std::move(*other);
    }

    void restartAcrossBounds() {
        constexpr double kWorthIt = 0.5; // ratio of chi-squared that means another branch
        stage_(0.16, "baseline fit from further starts");
        const double limit = kWorthIt * out_.fit.chiSquared;
        const auto starts = bestCoarsePoints(evaluator_, *out_.likelihood, variables(), settings_.seed);
        if (const auto best = lowest(evaluator_, *out_.likelihood, starts, limit, limit); best && !evaluator_.stopped())
            fitFrom(best->point);
    }

    const RecordedData& data_;
    Evaluator& evaluator_;
    const Noise& noise_;
    const DiagnosisSettings& settings_;
    const StageReporter& stage_;
    BaselineFit out_;
};

} // namespace

BaselineFit fitBaseline(const RecordedData& data, Evaluator& evaluator, const Noise& noise,
                        const DiagnosisSettings& settings, const StageReporter& stage) {
    return BaselineSearch(data, evaluator, noise, settings, stage).run();
}

namespace {

bool replacedByLower(Evaluator& evaluator, const Likelihood& likelihood, const std::vector<ParameterPoint>& starts,
                     FitResult& found) {
    constexpr double kLower = 0.5; // delta chi-squared: tolerance of a fit's end
    auto other = lowest(evaluator, likelihood, starts, found.chiSquared, found.chiSquared - kLower);
    if (!other || evaluator.stopped())
        return false;
    found = std::move(*other);
    differentiateAll(evaluator, likelihood, found);
    return true;
}

} // namespace

bool searchLowerMinimum(Evaluator& evaluator, const DiagnosisSettings& settings, const Likelihood& likelihood,
                        FitResult& found) {
    const Variables v(evaluator.model(), found.point);
    std::vector<ParameterPoint> starts = bestCoarsePoints(evaluator, likelihood, v, settings.seed);
    starts.push_back(oppositePoint(v, found.x));
    return replacedByLower(evaluator, likelihood, starts, found);
}

bool refitFrom(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start, FitResult& found) {
    return replacedByLower(evaluator, likelihood, {start}, found);
}

} // namespace supercircle::diagnosis
