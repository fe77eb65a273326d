#include "plugin/identification/diagnosis/fit.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/estimation/progressive_fit.h"
#include "plugin/identification/diagnosis/model/decompositions.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supercircle::diagnosis {

namespace {

std::vector<Eigen::Index> range(Eigen::Index from, Eigen::Index to) {
    std::vector<Eigen::Index> all;
    for (Eigen::Index i = from; i < to; ++i)
        all.push_back(i);
    return all;
}

/// Two neighbours of x in one coordinate, inside the box.
struct Neighbours {
    Neighbours(const Variables& v, const Eigen::VectorXd& x, Eigen::Index c, double difference)
        : column(c), up(x), down(x) {
        up[c] = std::min(x[c] + difference, v.upper[c]);
        down[c] = std::max(x[c] - difference, v.lower[c]);
        toUp = up[c] - x[c];
        toDown = x[c] - down[c];
    }
    [[nodiscard]] double span() const { return up[column] - down[column]; }
    Eigen::Index column;
    Eigen::VectorXd up, down;
    double toUp = 0.0, toDown = 0.0;
};

/// Upper and lower neighbour of each in turn.
std::vector<ParameterPoint> pointsOf(const Variables& v, const std::vector<Neighbours>& all) {
    std::vector<ParameterPoint> points;
    for (const Neighbours& n : all) {
        points.push_back(v.at(n.up));
        points.push_back(v.at(n.down));
    }
    return points;
}

/// Difference step for a parameter that changed all readings by `change` sigma over a unit step. Kinks of the simulated
/// force shift single readings by half a sigma. For a parameter with a faint effect these dominate its column; a wider
/// step divides them (decision 0076).
double widened(double difference, double change) {
    constexpr double kPlain = 20.0, kWidest = 1.0; // sigma; fraction of the stated half-width
    return change > 0.0 ? std::clamp(difference * kPlain / change, difference, kWidest) : kWidest;
}

/// Difference step of a free motion, by what `step` to both sides changed in all readings, sigma. The motion is smooth
/// and the simulation exact to 1e-9, so the step may be small; but sticking shifts single readings. A change of 1.5
/// sigma a reading or a twentieth of a radian of phase, whichever is less: there a sine bends by 0.04 % of its change.
double bySignal(const Likelihood& likelihood, double step, double change) {
    constexpr double kSigma = 1.5, kPhase = 0.05, kEnough = 5.0; // kEnough: steps within this ratio stay
    constexpr double kNarrowest = 1e-4, kWidest = 30.0;          // times `step`
    const double signal = kPhase * likelihood.signalNorm();
    const double wanted = std::min(kSigma * std::sqrt(static_cast<double>(likelihood.countedRows())), signal);
    const double ratio = change > 0.0 ? std::clamp(wanted / change, kNarrowest, kWidest) : kWidest;
    return ratio > 1.0 / kEnough && ratio < kEnough ? step : ratio * step;
}

/// Derivatives with respect to the parameters `only`; faint ones again over a wider step. Only stated parameters are
/// widened: effects may begin at a threshold, and parameters of free scenes have no bounds.
/// @param take fills columns of `into` from their neighbours in x
template <class Fill>
void differentiateInTwoPasses(const Likelihood& likelihood, const Variables& v, const Eigen::VectorXd& x,
                              double difference, const std::vector<Eigen::Index>& only, const Evaluator& evaluator,
                              Eigen::MatrixXd& into, const Fill& fill) {
    // The phase of a free motion is very sensitive to its initial state, so its first step is small.
    constexpr double kFree = 0.05;
    std::vector<Neighbours> near, wide;
    for (const Eigen::Index c : only) {
        into.col(c).setZero();
        near.emplace_back(v, x, c, likelihood.data().free ? kFree * difference : difference);
    }
    fill(near);
    for (const Neighbours& n : near)
        if (likelihood.data().free) {
            const double change = into.col(n.column).norm() * n.span();
            if (const double step = bySignal(likelihood, kFree * difference, change); step != kFree * difference)
                wide.emplace_back(v, x, n.column, step);
        } else if (const double wider = widened(difference, into.col(n.column).norm() * n.span());
                   wider > difference && n.column < v.nominal && !likelihood.data().free)
            wide.emplace_back(v, x, n.column, wider);
    if (!wide.empty() && !evaluator.stopped())
        fill(wide);
}

/// The smaller of the two one-sided derivatives, if a neighbour lies on another solution branch: a strip that slips or
/// buckles the other way changes every reading. Such a column would hold its parameter where the search began (decision
/// 0076).
std::optional<Eigen::VectorXd> onSameBranch(const Likelihood& likelihood, const std::vector<Response>& here,
                                            const Neighbours& n, const std::vector<Response>& up,
                                            const std::vector<Response>& down) {
    constexpr double kElsewhere = 4.0; // ratio of the two one-sided changes
    const auto above = likelihood.whitenedDifference(up, here), below = likelihood.whitenedDifference(here, down);
    if (!above || !below || !(n.toUp > 0.0) || !(n.toDown > 0.0))
        return std::nullopt;
    const double a = above->norm() / n.toUp, b = below->norm() / n.toDown;
    if (std::max(a, b) < kElsewhere * std::min(a, b))
        return std::nullopt;
    return Eigen::VectorXd(a < b ? *above / n.toUp : *below / n.toDown);
}

/// The one-sided derivative where one of the two neighbours cannot be simulated, as where friction that falls with
/// speed makes the specimen stick and slip (decision 0076).
std::optional<Eigen::VectorXd> oneSidedDifference(const Likelihood& likelihood, const std::vector<Response>& here,
                                                  const Neighbours& n, const std::vector<Response>& up,
                                                  const std::vector<Response>& down) {
    if (const auto above = n.toUp > 0.0 ? likelihood.whitenedDifference(up, here) : std::nullopt)
        return Eigen::VectorXd(*above / n.toUp);
    if (const auto below = n.toDown > 0.0 ? likelihood.whitenedDifference(here, down) : std::nullopt)
        return Eigen::VectorXd(*below / n.toDown);
    return std::nullopt;
}

} // namespace

bool differentiate(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v, const Eigen::VectorXd& x,
                   double difference, const std::vector<Eigen::Index>& only, Eigen::MatrixXd& into, Fidelity fidelity) {
    constexpr double kLoud = 5.0; // sigma a reading: more than a nearby stated parameter does
    const double limit = kLoud * std::sqrt(static_cast<double>(likelihood.countedRows()));
    bool edge = false;
    std::vector<Eigen::Index> failed; // neither neighbour can be simulated
    std::vector<Response> here;
    const auto middle = [&]() -> const std::vector<Response>& {
        if (here.empty())
            here = evaluator.simulateAllRuns({v.at(x)}, fidelity).front();
        return here;
    };
    into.conservativeResize(likelihood.rows(), v.size());
    differentiateInTwoPasses(likelihood, v, x, difference, only, evaluator, into,
                             [&](const std::vector<Neighbours>& beside) {
                                 const auto answers = evaluator.simulateAllRuns(pointsOf(v, beside), fidelity);
                                 for (std::size_t i = 0; i < beside.size(); ++i) {
                                     const Neighbours& n = beside[i];
                                     const std::vector<Response>&up = answers[2 * i], &down = answers[2 * i + 1];
                                     const auto change = likelihood.whitenedDifference(up, down);
                                     if (!(n.span() > 0.0))
                                         continue;
                                     if (!change) {
                                         if (const auto one = oneSidedDifference(likelihood, middle(), n, up, down))
                                             into.col(n.column) = *one;
                                         else if (into.col(n.column).isZero(0.0))
                                             failed.push_back(n.column);
                                         continue;
                                     }
                                     into.col(n.column) = *change / n.span();
                                     // Effects may begin at a threshold, and free motions are not bounded.
                                     if (change->norm() < limit || n.column >= v.nominal || likelihood.data().free)
                                         continue;
                                     if (const auto smaller = onSameBranch(likelihood, middle(), n, up, down)) {
                                         into.col(n.column) = *smaller;
                                         edge = true;
                                     }
                                 }
                             });
    // Stick-slip may fail at coarse fidelity alone.
    if (fidelity == Fidelity::Coarse && !failed.empty() && !evaluator.stopped())
        edge = differentiate(evaluator, likelihood, v, x, difference, failed, into, Fidelity::Fine) || edge;
    return edge;
}

namespace {

/// The smaller of the two one-sided slopes in each reading; the other one where one does not exist.
Eigen::VectorXd smallerSlope(const RawDifference& up, double toUp, const RawDifference& down, double toDown,
                             Eigen::Index rows) {
    const bool above = toUp > 0.0 && up.rows.size() == rows, below = toDown > 0.0 && down.rows.size() == rows;
    if (!above && !below)
        return Eigen::VectorXd::Zero(rows);
    const Eigen::VectorXd a = above ? Eigen::VectorXd(up.rows / toUp) : Eigen::VectorXd(down.rows / toDown);
    const Eigen::VectorXd b = below ? Eigen::VectorXd(down.rows / toDown) : a;
    return a.binaryExpr(b, [](double p, double q) { return std::abs(p) < std::abs(q) ? p : q; });
}

/// Whitened slope of all readings; zero where it is unknown.
Eigen::VectorXd slope(const Likelihood& likelihood, const std::vector<Response>& here,
                      const std::vector<Response>& above, double toUp, const std::vector<Response>& below,
                      double toDown) {
    Eigen::VectorXd out(likelihood.rows()); // whitening would spread a jump, so slopes are selected before it
    for (std::size_t r = 0; r < here.size(); ++r)
        out.segment(likelihood.start(r), likelihood.rowsOf(r)) = likelihood.whiten(
            r, smallerSlope(likelihood.rawDifference(r, above[r], here[r]), toUp,
                            likelihood.rawDifference(r, here[r], below[r]), toDown, likelihood.rowsOf(r)));
    return out.allFinite() ? out : Eigen::VectorXd::Zero(likelihood.rows());
}

} // namespace

Eigen::MatrixXd differentiateRobustly(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v,
                                      const Eigen::VectorXd& x, double difference) {
    Eigen::MatrixXd out(likelihood.rows(), v.size());
    const auto here = evaluator.simulateAllRuns({v.at(x)}, Fidelity::Coarse).front();
    differentiateInTwoPasses(
        likelihood, v, x, difference, range(0, v.size()), evaluator, out, [&](const std::vector<Neighbours>& beside) {
            const auto answers = evaluator.simulateAllRuns(pointsOf(v, beside), Fidelity::Coarse);
            for (std::size_t i = 0; i < beside.size(); ++i)
                out.col(beside[i].column) =
                    slope(likelihood, here, answers[2 * i], beside[i].toUp, answers[2 * i + 1], beside[i].toDown);
        });
    return out;
}

Eigen::VectorXd slopeAlong(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v,
                           const Eigen::VectorXd& x, const Eigen::VectorXd& up, const Eigen::VectorXd& down,
                           Eigen::Index by) {
    const auto answers = evaluator.simulateAllRuns({v.at(x), v.at(up), v.at(down)}, Fidelity::Coarse);
    return slope(likelihood, answers[0], answers[1], up[by] - x[by], answers[2], x[by] - down[by]);
}

bool evaluate(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v, FitResult& f) {
    f.point = v.at(f.x);
    f.responses = evaluator.simulateAllRuns({f.point}, Fidelity::Fine).front();
    for (const Response& r : f.responses)
        if (!r.failure.empty())
            f.failure = r.failure;
    const auto residual = likelihood.residual(f.responses);
    if (!residual)
        return false;
    f.residual = *residual;
    const Eigen::Index n = v.nominal;
    const double deviations = f.x.head(n).dot(v.penalty.topLeftCorner(n, n) * f.x.head(n));
    f.chiSquared = f.residual.squaredNorm() + likelihood.maskPenalty(f.responses).sum() + deviations;
    f.cost = f.chiSquared + f.x.dot(v.penalty * f.x) - deviations;
    return true;
}

void broydenUpdate(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
    jacobian += (change - jacobian * step) * step.transpose() / step.squaredNorm();
}

namespace {

/// A search from one start.
class LevenbergMarquardt {
public:
    LevenbergMarquardt(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
                       const FitSettings& settings)
        : evaluator_(evaluator), likelihood_(likelihood), settings_(settings), v_(evaluator.model(), start) {
        now_.x = v_.of(start);
    }

    FitResult run(const Eigen::MatrixXd& known) {
        if (!evaluate(now_)) {
            now_.failure = now_.failure.empty() ? "the start cannot be simulated" : now_.failure;
            return now_;
        }
        const bool fits = known.rows() == likelihood_.rows() && known.cols() <= v_.size();
        const Eigen::Index given = fits ? known.cols() : 0;
        now_.jacobian.setZero(likelihood_.rows(), v_.size());
        if (given > 0)
            now_.jacobian.leftCols(given) = known;
        if (given < v_.size())
            differentiate(evaluator_, likelihood_, v_, now_.x, settings_.differenceStep, range(given, v_.size()),
                          now_.jacobian);
        // Columns of the first effect come from its own search, where Broyden's updates have changed them.
        if (given > v_.nominal && v_.size() > v_.nominal)
            age_ = Age::Learnt;
        constexpr int kMoreTrials = 8; // failed steps count apart from accepted ones
        while (!done_ && now_.iterations < settings_.iterations && trials_ < settings_.iterations + kMoreTrials &&
               !evaluator_.stopped())
            iterate();
        return now_;
    }

private:
    bool evaluate(FitResult& f) const { return supercircle::diagnosis::evaluate(evaluator_, likelihood_, v_, f); }

    void iterate() {
        ++trials_;
        Eigen::MatrixXd G = now_.jacobian.transpose() * now_.jacobian + v_.penalty;
        const Eigen::VectorXd g = now_.jacobian.transpose() * now_.residual - v_.penalty * now_.x;
        const double typical = std::max(1e-12, G.diagonal().mean());
        const Eigen::VectorXd precision = v_.normalPrecision();
        for (Eigen::Index i = 0; i < G.rows(); ++i) // where priors decide, damping by the readings would hold the step
            G(i, i) += damping_ * (precision[i] > 0.0 ? precision[i] : G(i, i) + 1e-3 * typical);
        const Eigen::VectorXd far = farthest();
        const Eigen::VectorXd step =
            solveBoxQp(G, g, (v_.lower - now_.x).cwiseMax(-far), (v_.upper - now_.x).cwiseMin(far));
        const Eigen::VectorXd to = now_.x + step;
        // The penalty for masked rows (Likelihood::maskPenalty) has no derivative.
        const double predictedGain = now_.residual.squaredNorm() + now_.x.dot(v_.penalty * now_.x) -
                                     (now_.residual - now_.jacobian * step).squaredNorm() - to.dot(v_.penalty * to);
        if (predictedGain < settings_.smallestGain) {
            finishOrRefresh();
            return;
        }
        FitResult trial;
        trial.x = to;
        if (evaluate(trial) && trial.cost < now_.cost)
            accept(std::move(trial), step, predictedGain);
        else
            reject();
    }

    /// Longest step: two half-widths, of free motions where a parameter alone shifts the phase by half a radian.
    [[nodiscard]] Eigen::VectorXd farthest() const {
        constexpr double kSteps = 2.0, kPhase = 0.5;
        Eigen::VectorXd far = Eigen::VectorXd::Constant(v_.size(), kSteps);
        if (likelihood_.data().free)
            for (Eigen::Index c = 0; c < far.size(); ++c)
                if (const double slope = now_.jacobian.col(c).norm(); slope > 0.0)
                    far[c] = std::min(1e6, kPhase * likelihood_.signalNorm() / slope);
        return far;
    }

    /// Damping below 0.3 shortens a step by at most 9 %, so a failed step would fail again.
    void reject() {
        damping_ = std::max(10.0 * damping_, 0.3);
        const int most = age_ == Age::Fresh ? 4 : 2;
        if (++rejected_ >= most || damping_ > 1e4)
            finishOrRefresh();
    }

    void accept(FitResult&& trial, const Eigen::VectorXd& step, double predictedGain) {
        rejected_ = 0;
        age_ = Age::Learnt;
        trial.iterations = now_.iterations + 1;
        const double gain = now_.cost - trial.cost;
        const bool stalled =
            trials_ >= 5 && trial.chiSquared > 3.0 * settings_.competitor && gain < 0.1 * trial.chiSquared;
        trial.jacobian = std::move(now_.jacobian);
        if (const auto change = likelihood_.whitenedDifference(trial.responses, now_.responses))
            broydenUpdate(trial.jacobian, step, *change);
        damping_ = std::max(1e-6, gain > 0.5 * predictedGain ? damping_ / 10.0 : damping_);
        now_ = std::move(trial);
        if (settings_.competitor > 0.0 && stalled)
            done_ = true;
        else if (gain < settings_.smallestGain)
            finishOrRefresh();
        else if (gain < 0.5 * predictedGain && !farBehind()) // the derivatives are those of another point
            refreshEffect();
    }

    [[nodiscard]] bool farBehind() const {
        return settings_.competitor > 0.0 && now_.chiSquared > 3.0 * settings_.competitor;
    }

    /// Refreshes old derivatives where no step is found: those with respect to the effect first, then the nominal ones.
    void finishOrRefresh() { done_ = farBehind() || !(refreshEffect() || refreshNominal()); }

    /// Whether the steps since a refresh lowered chi-squared by more than its dispersion. Twice that ends a fit up to 2
    /// above its minimum, half of it pays for refreshes whose gain is noise.
    [[nodiscard]] bool paid(double costAtRefresh) const {
        const double dispersion =
            now_.chiSquared / static_cast<double>(std::max<Eigen::Index>(1, likelihood_.countedRows()));
        return costAtRefresh - now_.cost > std::max(1.0, dispersion);
    }

    /// Refreshes the derivatives with respect to the effect's parameters, or the nominal ones where there is no effect.
    bool refreshEffect() {
        if (age_ != Age::Learnt || (refreshes_ >= settings_.refreshes && !paid(refreshedAt_)))
            return false;
        ++refreshes_;
        refreshedAt_ = now_.cost;
        const bool alone = v_.size() == v_.nominal;
        refresh(range(alone ? 0 : v_.nominal, v_.size()));
        age_ = alone ? Age::Fresh : Age::Moved;
        return true;
    }

    bool refreshNominal() {
        if (age_ == Age::Fresh || v_.size() == v_.nominal ||
            (nominalRefreshes_ >= settings_.nominalRefreshes && !paid(nominalRefreshedAt_)))
            return false;
        ++nominalRefreshes_;
        nominalRefreshedAt_ = now_.cost;
        refresh(range(0, age_ == Age::Moved ? v_.nominal : v_.size()));
        age_ = Age::Fresh;
        return true;
    }

    void refresh(const std::vector<Eigen::Index>& columns) {
        differentiate(evaluator_, likelihood_, v_, now_.x, settings_.differenceStep, columns, now_.jacobian);
        rejected_ = 0;
        damping_ = std::min(damping_, 1e-2);
    }

    Evaluator& evaluator_;
    const Likelihood& likelihood_;
    const FitSettings& settings_;
    Variables v_;
    FitResult now_;
    double damping_ = 1e-3;
    int trials_ = 0, rejected_ = 0, refreshes_ = 0, nominalRefreshes_ = 0;
    double refreshedAt_ = 0.0, nominalRefreshedAt_ = 0.0; ///< cost at the last refreshes
    /// Of the derivatives: all taken at this point, only those of the effect, or updated from steps.
    enum class Age : std::uint8_t { Fresh, Moved, Learnt } age_ = Age::Fresh;
    bool done_ = false;
};

} // namespace

FitResult fit(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
              const FitSettings& settings, const Eigen::MatrixXd& known) {
    const bool progressive = settings.progressive && likelihood.data().free;
    FitSettings given = settings;
    if (likelihood.data().freeBodies()) // long oscillations are too nonlinear for Broyden's update
        given.refreshes = given.nominalRefreshes = given.iterations;
    const ParameterPoint from = progressive ? progressiveStart(evaluator, likelihood, start, given) : start;
    return LevenbergMarquardt(evaluator, likelihood, from, given).run(from == start ? known : Eigen::MatrixXd());
}

Eigen::MatrixXd posteriorCovariance(const Variables& v, const Eigen::MatrixXd& jacobian, double dispersion) {
    Eigen::MatrixXd precision = jacobian.transpose() * jacobian / std::max(1.0, dispersion);
    for (Eigen::Index k = 0; k < v.size(); ++k) {
        precision(k, k) += v.intervalPrecision(k, 1e3) + (k < v.nominal ? v.penalty(k, k) : 0.0);
    }
    return dense::inverseLdlt(precision);
}

double chiSquaredPerReading(const Likelihood& likelihood, const FitResult& f) {
    return f.chiSquared / static_cast<double>(std::max<Eigen::Index>(1, likelihood.countedRows()));
}

Eigen::MatrixXd freeColumns(const Model& model, const FitResult& f) {
    const Variables v(model, f.point);
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < v.size(); ++i)
        if (f.x[i] > v.lower[i] + 1e-6 && f.x[i] < v.upper[i] - 1e-6)
            free.push_back(i);
    Eigen::MatrixXd columns(f.jacobian.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
        columns.col(static_cast<Eigen::Index>(i)) = f.jacobian.col(free[i]);
    return columns;
}

std::vector<Eigen::Index> amplitudesAtBound(const Model& model, const FitResult& f, double dispersion) {
    constexpr double kSigma = 3.0;
    std::vector<Eigen::Index> out;
    const Variables v(model, f.point);
    if (f.residual.size() == 0 || f.jacobian.rows() != f.residual.size() || f.jacobian.cols() != v.size())
        return out;
    const Eigen::MatrixXd free = freeColumns(model, f);
    for (Eigen::Index i = v.nominal; i < v.size(); ++i) {
        // The bound at which an effect is absent does not count.
        const bool up = f.x[i] >= v.upper[i] - 1e-6 && v.upper[i] > 1e-6,
                   down = f.x[i] <= v.lower[i] + 1e-6 && v.lower[i] < -1e-6;
        if (!v.scalar(i).amplitude || (!up && !down))
            continue;
        Eigen::VectorXd own = f.jacobian.col(i);
        if (free.cols() > 0)
            own -= free * dense::leastSquares(free, own);
        const double size = own.norm();
        if (size > 0.0 && (up ? 1.0 : -1.0) * own.dot(f.residual) / size > kSigma * std::sqrt(dispersion))
            out.push_back(i);
    }
    return out;
}

} // namespace supercircle::diagnosis
