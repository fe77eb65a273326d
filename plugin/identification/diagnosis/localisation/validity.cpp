#include "plugin/identification/diagnosis/localisation/validity.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/estimation/beside_stated.h"
#include "plugin/identification/diagnosis/estimation/progressive_fit.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/localisation/localise.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr int kDraws = 199;  ///< of the null distribution; p is resolved to 0.005
constexpr int kRounds = 3;   ///< linearisations; the second one moves ends by less than a row in most runs
constexpr int kPlaces = 96;  ///< at which a departure is tried
constexpr int kLengths = 12; ///< of the part in which it is sought
/// Gain in chi-squared at which a departure is long enough to be placed: ten sigma. Half of it widens intervals by a
/// third; twice as much takes in more of a law that no offset, ramp or parabola has.
constexpr double kClear = 100.0;
constexpr double kInterval = 2.71; ///< decrease of the gain at the ends of a 90 % interval

/// A run alone, with simulations at the stated numbers and beside them.
class RunAlone {
public:
    /// @param finer than the fine simulation, of this run
    RunAlone(Evaluator& evaluator, const Likelihood& all, std::size_t run, const Variables& variables,
             const BesideStated& stated, Response finer, std::uint64_t seed)
        : evaluator_(evaluator), all_(all), run_(run), variables_(variables), stated_(stated), finer_(std::move(finer)),
          seed_(seed), data_(all.data()), x_(Eigen::VectorXd::Zero(variables.size())), there_(stated.fine[run]) {
        data_.runs = {all.data().runs[run]};
    }

    ValidRange range() {
        ValidRange out;
        out.run = data_.runs[0].name;
        const Index n = data_.runs[0].time.size();
        if (!there_.failure.empty() || n < 2)
            return out;
        out.known = true;
        Index rows = explained(n, out.whole);
        for (int round = 1; round < kRounds && moveTo(rows); ++round) {
            const Index before = rows;
            rows = explained(n, out.whole);
            if (std::abs(rows - before) <= std::max<Index>(1, n / 100))
                break;
        }
        out.until = out.departs = out.departsFrom = out.departsTo = at(rows - 1);
        if (!out.whole)
            place(rows, out);
        return out;
    }

private:
    /// The first rows of the run: likelihood, residual at x_, and derivatives.
    struct Beginning {
        std::unique_ptr<RecordedData> data; ///< that the likelihood refers to
        std::unique_ptr<Likelihood> likelihood;
        Eigen::VectorXd residual;
        Eigen::MatrixXd jacobian;
    };

    [[nodiscard]] std::optional<Beginning> beginning(Index rows) const {
        const Eigen::VectorXd& time = data_.runs[0].time;
        const double length = time[time.size() - 1] - time[0];
        Beginning b;
        // Halfway to the next row, so that no rounding decides.
        const double until = rows < time.size() ? 0.5 * (time[rows - 1] + time[rows]) : time[time.size() - 1];
        b.data = std::make_unique<RecordedData>(
            firstPart(data_, rows < time.size() ? (until - time[0]) / length : 1.0 + 1e-9));
        b.likelihood = std::make_unique<Likelihood>(*b.data, all_.noise(), std::vector<Response>{there_},
                                                    std::vector<Response>{finer_}, all_.settings());
        auto residual = b.likelihood->residual({there_});
        if (!residual)
            return std::nullopt;
        b.residual = std::move(*residual);
        b.jacobian = Eigen::MatrixXd::Zero(b.likelihood->rows(), variables_.size());
        for (Index i = 0; i < variables_.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const auto change = b.likelihood->whitenedDifference({stated_.up[k][run_]}, {stated_.down[k][run_]});
            if (change && stated_.span[i] > 0.0)
                b.jacobian.col(i) = *change / stated_.span[i];
        }
        return b;
    }

    /// Change of x_ that explains most of a beginning inside the stated intervals.
    [[nodiscard]] Eigen::VectorXd step(const Beginning& b) const {
        const Eigen::VectorXd precision = variables_.normalPrecision();
        Eigen::MatrixXd G = b.jacobian.transpose() * b.jacobian;
        G.diagonal().array() += 1e-6 * std::max(1e-12, G.diagonal().mean()); // insensitive parameters stay
        G.diagonal() += precision;
        return solveBoxQp(G, b.jacobian.transpose() * b.residual - precision.cwiseProduct(x_), variables_.lower - x_,
                          variables_.upper - x_);
    }

    [[nodiscard]] bool isExplained(Index rows) const {
        const auto b = beginning(rows);
        if (!b)
            return false;
        const Eigen::VectorXd to = step(*b);
        Eigen::MatrixXd free(b->jacobian.rows(), variables_.size());
        Index columns = 0;
        for (Index i = 0; i < variables_.size(); ++i)
            if (const double x = x_[i] + to[i]; x > variables_.lower[i] + 1e-9 && x < variables_.upper[i] - 1e-9)
                free.col(columns++) = b->jacobian.col(i);
        return localise(*b->likelihood, b->residual - b->jacobian * to, free.leftCols(columns), seed_, kDraws, {},
                        evaluator_.stop())
                   .p > kFamilyWise;
    }

    /// Number of rows of the longest beginning that is explained.
    [[nodiscard]] Index explained(Index n, bool& whole) const {
        whole = isExplained(n);
        if (whole)
            return n;
        Index low = 1, high = n;
        while (high - low > std::max<Index>(1, n / 400)) {
            const Index middle = (low + high) / 2;
            (isExplained(middle) ? low : high) = middle;
        }
        return low;
    }

    /// Simulates where these rows are explained best. False: that is where it is.
    bool moveTo(Index rows) {
        const auto b = beginning(rows);
        if (!b)
            return false;
        const Eigen::VectorXd to = step(*b);
        if ((b->jacobian * to).norm() < 0.1) // sigma of all rows
            return false;
        x_ += to;
        Response there = evaluator_.simulate({{run_, variables_.at(x_), Fidelity::Fine}}).front();
        if (!there.failure.empty()) {
            x_ -= to;
            return false;
        }
        there_ = std::move(there);
        return true;
    }

    /// Of an offset, ramp or parabola that begins at each place, in the residual of a beginning: the largest gain.
    /// @param explained rows that are explained: it begins in them
    [[nodiscard]] Eigen::VectorXd gains(const Beginning& b, Index rows, Index explained, Eigen::VectorXd& u) const {
        const Eigen::MatrixXd Q = basisOf(b.jacobian);
        u = b.residual - Q * (Q.transpose() * b.residual);
        const Eigen::VectorXd& time = data_.runs[0].time;
        Eigen::VectorXd out = Eigen::VectorXd::Zero(kPlaces);
        for (int place = 0; place < kPlaces; ++place)
            for (int power = 0; power < 3; ++power) {
                const Index from = rowOf(place, explained);
                Eigen::VectorXd shape = Eigen::VectorXd::Zero(b.likelihood->rows());
                for (Index k = from; k < rows; ++k) {
                    const double x = (time[k] - time[from]) / (time[rows - 1] - time[from] + 1e-300);
                    shape[k] = power == 0 ? 1.0 : power == 1 ? x : x * x;
                }
                Eigen::VectorXd s = b.likelihood->whiten(0, shape);
                const double whole = s.norm();
                s -= Q * (Q.transpose() * s);
                if (const double left = s.norm(); left > 1e-3 * whole && left > 0.0) {
                    const double gain = s.dot(u) / left; // sigma
                    out[place] = std::max(out[place], gain * gain);
                }
            }
        return out;
    }
    static Index rowOf(int place, Index explained) { return place * explained / (kPlaces - 1); }

    /// Where the run departs, in a beginning that shows it clearly.
    void place(Index rows, ValidRange& out) const {
        const Index n = data_.runs[0].time.size();
        for (int length = 1; length <= kLengths; ++length) {
            evaluator_.stop().poll();
            const Index to = rows + std::max<Index>(1, (n - rows) * length / kLengths);
            const auto b = beginning(std::min(to, n));
            if (!b || to < 4)
                continue;
            Eigen::VectorXd u;
            const Eigen::VectorXd gain = gains(*b, std::min(to, n), rows, u);
            Index best = 0;
            const double most = gain.maxCoeff(&best);
            if (most < kClear && length < kLengths)
                continue;
            const double dispersion =
                std::max(1.0, (u.squaredNorm() - most) / static_cast<double>(b->likelihood->countedRows()));
            Index first = best, last = best;
            for (Index k = 0; k < kPlaces; ++k)
                if (gain[k] >= most - kInterval * dispersion) {
                    first = std::min(first, k);
                    last = std::max(last, k);
                }
            const auto row = [&](Index k) { return rowOf(static_cast<int>(k), rows); };
            out.departs = at(row(best));
            out.departsFrom = at(row(std::max<Index>(0, first - 1)));
            out.departsTo = at(row(std::min<Index>(kPlaces - 1, last + 1)));
            return;
        }
    }

    [[nodiscard]] ValidRange::Place at(Index row) const {
        const RecordedRun& run = data_.runs[0];
        return {run.time[row], run.displacement[row], run.phase(row)};
    }

    Evaluator& evaluator_;
    const Likelihood& all_;
    std::size_t run_;
    const Variables& variables_;
    const BesideStated& stated_;
    Response finer_;
    std::uint64_t seed_;
    RecordedData data_;
    Eigen::VectorXd x_; ///< where `there_` is simulated
    Response there_;
};

} // namespace

std::vector<ValidRange> rangesOfValidity(Evaluator& evaluator, const Likelihood& likelihood, std::uint64_t seed) {
    const Variables variables(evaluator.model(), statedPoint(evaluator.model()));
    const BesideStated stated = simulateBesideStated(evaluator, variables);
    const std::vector<Response> finer = likelihood.finerThan(stated.fine);
    std::vector<ValidRange> out;
    for (std::size_t r = 0; r < likelihood.runs(); ++r)
        out.push_back(RunAlone(evaluator, likelihood, r, variables, stated, finer[r], seed).range());
    return out;
}

} // namespace supercircle::diagnosis
