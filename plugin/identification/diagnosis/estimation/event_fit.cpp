#include "plugin/identification/diagnosis/estimation/event_fit.h"

#include "plugin/identification/diagnosis/box_qp.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Rows of half swing k in the stack of a run: passage, turning point, height.
constexpr Index kRowsOfSwing = 3;

/// Recorded events of a run and their scales.
struct RecordedEvents {
    double level = 0.0, least = 0.0;    ///< middle; smallest height
    std::vector<HalfSwing> swings;      ///< of the recording
    double period = 1.0, largest = 1.0; ///< s, of a half swing; largest height
    double first = 0.0;                 ///< first reading
    Index firstRow = -1;
};

RecordedEvents eventsOf(const RecordedRun& run, double noise) {
    constexpr double kNoise = 5.0; // standard deviations
    RecordedEvents out;
    double sum = 0.0, count = 0.0;
    for (Index k = 0; k < run.force.size(); ++k)
        if (std::isfinite(run.force[k])) {
            sum += run.force[k];
            count += 1.0;
            out.firstRow = out.firstRow < 0 ? k : out.firstRow;
        }
    if (count < 1.0)
        return out;
    out.level = sum / count;
    out.first = run.force[out.firstRow];
    out.least = kNoise * noise;
    out.swings = halfSwingsOf(run.time, run.force, out.level, out.least);
    for (const HalfSwing& s : out.swings)
        out.largest = std::max(&s == &out.swings.front() ? 0.0 : out.largest, std::abs(s.height));
    if (out.swings.size() > 1)
        out.period = (out.swings.back().from - out.swings.front().from) / static_cast<double>(out.swings.size() - 1);
    return out;
}

/// Residuals of events, recorded minus simulated.
class Events {
public:
    explicit Events(const Likelihood& likelihood) : likelihood_(likelihood) {
        for (const RecordedRun& run : likelihood.data().runs) {
            runs_.push_back(eventsOf(run, likelihood.noise().total()));
            rows_ += 1 + kRowsOfSwing * static_cast<Index>(runs_.back().swings.size());
        }
    }
    /// Half swings of the run that has fewest.
    [[nodiscard]] std::size_t fewest() const {
        std::size_t n = runs_.empty() ? 0 : runs_.front().swings.size();
        for (const RecordedEvents& run : runs_)
            n = std::min(n, run.swings.size());
        return n;
    }
    /// In shares of a half swing and of the largest height, over the accuracy of a start. Events that are missing count
    /// as a whole half swing. Nothing if a simulation failed.
    /// @param found share of the recorded events that the simulation has
    [[nodiscard]] std::optional<Eigen::VectorXd> residual(const std::vector<Response>& simulated, double& found) const {
        // Only their ratios count: a passage tells the phase five times as well as a turning point.
        constexpr double kTurn = 0.05, kHeight = 0.01;
        Eigen::VectorXd out = Eigen::VectorXd::Zero(rows_);
        Index row = 0;
        double have = 0.0, all = 0.0;
        for (std::size_t r = 0; r < runs_.size(); ++r) {
            const RecordedEvents& run = runs_[r];
            const Response& s = simulated[r];
            const RecordedRun& recorded = likelihood_.data().runs[r];
            if (!s.failure.empty() || s.force.size() != recorded.force.size())
                return std::nullopt;
            if (run.firstRow >= 0)
                out[row] = (run.first - s.force[run.firstRow]) / (kHeight * run.largest);
            ++row;
            const std::vector<HalfSwing> there = halfSwingsOf(recorded.time, s.force, run.level, 0.2 * run.least);
            // A simulation that begins on the other side passes the middle once more or less.
            const bool shifted =
                !there.empty() && !run.swings.empty() && there.front().height * run.swings.front().height < 0.0;
            const bool extra = shifted && there.front().from < run.swings.front().from;
            for (std::size_t k = 0; k < run.swings.size(); ++k, row += kRowsOfSwing) {
                const std::size_t other = shifted ? (extra ? k + 1 : k - 1) : k;
                all += 1.0;
                const double share = run.swings[k].height / run.largest;
                if (other >= there.size()) { // k - 1 of the first wraps around
                    out.segment(row, kRowsOfSwing) << 1.0 / kPassage, 0.0, share / kHeight;
                    continue;
                }
                have += 1.0;
                out[row] = (run.swings[k].from - there[other].from) / (kPassage * run.period);
                out[row + 1] = (run.swings[k].turn - there[other].turn) / (kTurn * run.period);
                out[row + 2] = (run.swings[k].height - there[other].height) / (kHeight * run.largest);
            }
        }
        found = all > 0.0 ? have / all : 0.0;
        return out.allFinite() ? std::optional(out) : std::nullopt;
    }

    /// Of all recorded passages from the simulated ones, half swings; 1 where a simulation lacks one. The last passage
    /// of a run does not count: a simulation that is a little slower lacks it.
    [[nodiscard]] double farthestPassage(const Eigen::VectorXd& residual) const {
        double farthest = 0.0;
        Index row = 0;
        for (const RecordedEvents& run : runs_) {
            ++row;
            for (std::size_t k = 0; k < run.swings.size(); ++k, row += kRowsOfSwing)
                if (k + 1 < run.swings.size())
                    farthest = std::max(farthest, std::abs(residual[row]) * kPassage);
        }
        return farthest;
    }

private:
    static constexpr double kPassage = 0.01; ///< accuracy of a passage, half swings
    const Likelihood& likelihood_;
    std::vector<RecordedEvents> runs_;
    Index rows_ = 0;
};

class EventFit {
public:
    EventFit(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start)
        : evaluator_(evaluator), events_(likelihood), start_(start), v_(evaluator.model(), start), x_(v_.of(start)),
          shells_(likelihood.data().freeShells) {}

    std::optional<ParameterPoint> run() {
        constexpr std::size_t kFewest = 3;
        constexpr int kIterations = 40, kRejected = 5;
        // Half swings: samples a quarter of a turn off have their minimum where the events have it. Half of it fits
        // events of runs whose phase is known well enough; at twice as much a passage may be nearer to another one.
        constexpr double kNear = 0.25;
        if (events_.fewest() < kFewest || !begin())
            return std::nullopt;
        if (shells_ && events_.farthestPassage(residual_) < kNear)
            return x_ == v_.of(start_) ? start_ : v_.at(x_);
        int rejected = 0;
        for (int i = 0; i < kIterations && rejected < kRejected && !evaluator_.stopped(); ++i) {
            if (rejected == 0 && !differentiate())
                break;
            const double before = residual_.squaredNorm();
            if (!step()) {
                ++rejected;
                damping_ = std::max(10.0 * damping_, 0.1);
                continue;
            }
            rejected = 0;
            damping_ = std::max(1e-6, 0.1 * damping_);
            if (before - residual_.squaredNorm() < 1e-3 * before + 1e-3)
                break;
        }
        return v_.at(x_);
    }

private:
    [[nodiscard]] std::optional<Eigen::VectorXd> residualAt(const Eigen::VectorXd& x, double& found,
                                                            Fidelity fidelity = Fidelity::Fine) {
        return events_.residual(evaluator_.simulateAllRuns({v_.at(x)}, fidelity).front(), found);
    }
    /// Effects so strong that the simulation hardly oscillates are weakened.
    bool begin() {
        constexpr int kTimes = 4;
        constexpr double kWeaker = 0.3, kEnough = 0.6;
        for (int i = 0; i <= kTimes; ++i) {
            double found = 0.0;
            const auto here = residualAt(x_, found);
            if (here && (found > kEnough || (i == kTimes && found > 0.0))) {
                residual_ = *here;
                return true;
            }
            for (Index k = v_.nominal; k < v_.size(); ++k)
                if (v_.scalar(k).amplitude)
                    x_[k] *= kWeaker;
        }
        return false;
    }
    /// False: the present point cannot be simulated as coarsely.
    [[nodiscard]] bool differentiate() {
        // Change of the events by a difference step, root mean square of their accuracies. Events are smooth in the
        // parameters, so a tenth or ten times of it gives the same columns.
        constexpr double kChange = 0.3, kFirst = 0.01;
        if (step_.size() == 0)
            step_ = Eigen::VectorXd::Constant(v_.size(), kFirst);
        J_.setZero(residual_.size(), v_.size());
        double all = 0.0;
        const Fidelity fidelity = shells_ ? Fidelity::Coarse : Fidelity::Fine;
        const auto here = residualAt(x_, all, fidelity);
        if (!here)
            return false;
        for (Index c = 0; c < v_.size(); ++c)
            for (int pass = 0; pass < 2; ++pass) {
                Eigen::VectorXd to = x_;
                to[c] = x_[c] + step_[c] <= v_.upper[c] ? x_[c] + step_[c] : std::max(x_[c] - step_[c], v_.lower[c]);
                const double by = to[c] - x_[c];
                double found = 0.0;
                const auto there = by != 0.0 ? residualAt(to, found, fidelity) : std::nullopt;
                if (!there)
                    break;
                J_.col(c) = (*here - *there) / by;
                const double change = (*there - *here).norm() / std::sqrt(static_cast<double>(residual_.size()));
                const double old = step_[c];
                step_[c] = std::clamp(change > 0.0 ? old * kChange / change : 30.0 * old, old / 100.0, 30.0 * old);
                step_[c] = std::clamp(step_[c], 1e-6, 0.5 * std::min(v_.upper[c] - v_.lower[c], 20.0));
                if (step_[c] > 0.1 * old && step_[c] < 10.0 * old)
                    break;
            }
        return true;
    }
    bool step() {
        Eigen::MatrixXd G = J_.transpose() * J_ + v_.penalty;
        const Eigen::VectorXd g = J_.transpose() * residual_ - v_.penalty * x_;
        const double typical = std::max(1e-12, G.diagonal().mean());
        G.diagonal() += (damping_ * G.diagonal().array() + 1e-9 * typical).matrix();
        const Eigen::VectorXd d = solveBoxQp(G, g, v_.lower - x_, v_.upper - x_);
        double found = 0.0;
        const auto there = residualAt(x_ + d, found);
        if (!there || there->squaredNorm() >= residual_.squaredNorm())
            return false;
        x_ += d;
        residual_ = *there;
        return true;
    }

    Evaluator& evaluator_;
    Events events_;
    const ParameterPoint& start_;
    Variables v_;
    Eigen::VectorXd x_, residual_, step_;
    Eigen::MatrixXd J_;
    double damping_ = 1e-3;
    bool shells_; ///< move, whose simulations are saved
};

} // namespace

std::vector<HalfSwing> halfSwingsOf(const Eigen::VectorXd& time, const Eigen::VectorXd& value, double level,
                                    double least) {
    const double beyond = 0.5 * least; // a passage counts when the reading is so far on the other side
    std::vector<HalfSwing> out;
    int side = 0;
    double passage = 0.0;
    Index last = -1, top = -1, before = -1, after = -1; // rows: last number, extremum and its neighbours
    const auto close = [&] {
        if (out.empty() || top < 0)
            return true;
        HalfSwing& s = out.back();
        s.turn = time[top];
        s.height = value[top] - level;
        if (before >= 0 && after >= 0) { // parabola through three rows, equal for recording and simulation
            const double a = time[before] - time[top], b = time[after] - time[top];
            const double p = (value[before] - value[top]) / a, q = (value[after] - value[top]) / b;
            const double curvature = (q - p) / (b - a), slope = p - curvature * a;
            if (curvature != 0.0 && std::abs(slope / (2.0 * curvature)) < std::max(-a, b)) {
                s.turn -= slope / (2.0 * curvature);
                s.height -= slope * slope / (4.0 * curvature);
            }
        }
        return std::abs(s.height) >= least;
    };
    for (Index k = 0; k < value.size(); ++k) {
        if (!std::isfinite(value[k]))
            continue;
        const double v = value[k] - level;
        if (last >= 0 && (value[last] - level) * v <= 0.0 && v != value[last] - level)
            passage = time[last] + (time[k] - time[last]) * (level - value[last]) / (value[k] - value[last]);
        if (std::abs(v) > beyond && (v > 0.0 ? 1 : -1) != side) {
            if (!close()) {
                out.pop_back();
                return out;
            }
            if (side != 0)
                out.push_back({passage, 0.0, 0.0});
            side = v > 0.0 ? 1 : -1;
            top = -1;
        }
        if (top == last && top >= 0)
            after = k;
        if (side != 0 && v * side > 0.0 && (top < 0 || (value[k] - value[top]) * side > 0.0)) {
            top = k;
            before = last;
            after = -1;
        }
        last = k;
    }
    // The last half swing may have no turning point yet.
    if (!out.empty() && (!close() || after < 0))
        out.pop_back();
    return out;
}

std::optional<ParameterPoint> fitEvents(Evaluator& evaluator, const Likelihood& likelihood,
                                        const ParameterPoint& start) {
    return EventFit(evaluator, likelihood, start).run();
}

} // namespace supercircle::diagnosis
