#include "plugin/identification/diagnosis/selection/heldout.h"

#include "plugin/identification/diagnosis/box.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Rows of one fold, as 1 and 0.
Eigen::VectorXd maskOf(const Grouping& g, int fold) {
    Eigen::VectorXd m(static_cast<Index>(g.fold.size()));
    for (Index k = 0; k < m.size(); ++k)
        m[k] = g.fold[static_cast<std::size_t>(k)] == fold ? 1.0 : 0.0;
    return m;
}

Eigen::MatrixXd priorOf(const Variables& v) {
    Eigen::VectorXd p(v.size());
    for (Index i = 0; i < v.size(); ++i) {
        const double width = std::min(v.upper[i] - v.lower[i], i < v.nominal ? 1e9 : 20.0);
        p[i] = 12.0 / (width * width); // of a uniform distribution
    }
    return p.asDiagonal();
}

/// (1 + A A')^(-1/2) e and log det(1 + A A') by the small eigenproblem of A'A.
double standardise(const Eigen::MatrixXd& A, Eigen::VectorXd& e) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A.transpose() * A);
    double logDet = 0.0;
    Eigen::VectorXd out = e;
    for (Index i = 0; i < A.cols(); ++i) {
        const double s2 = std::max(0.0, eigen.eigenvalues()[i]);
        logDet += std::log1p(s2);
        if (s2 < 1e-12)
            continue;
        const Eigen::VectorXd u = A * eigen.eigenvectors().col(i) / std::sqrt(s2);
        out += u * (u.dot(e) * (1.0 / std::sqrt(1.0 + s2) - 1.0));
    }
    e = out;
    return logDet;
}

/// When each row was read, s; infinite: jumps, which belong to the force.
std::vector<double> timesOf(const Misfit& misfit) {
    std::vector<double> time(static_cast<std::size_t>(misfit.rows()), std::numeric_limits<double>::infinity());
    for (std::size_t r = 0; r < misfit.runs(); ++r) {
        const RecordedRun& run = misfit.data().runs[r];
        for (Index k = 0; k < run.rows(); ++k)
            time[static_cast<std::size_t>(misfit.start(r) + k)] =
                misfit.isForce(r, k) ? run.time[k] : run.markerTime[(k - run.force.size()) % run.markerTime.size()];
    }
    return time;
}

/// One run that goes one way only: stretches of time, a part of its rows in each, are foretold from the others. What
/// was read at one time is not foretold from each other.
void cutInto(Grouping& g, const Misfit& misfit, int parts) {
    const std::vector<double> time = timesOf(misfit);
    std::vector<double> present;
    for (std::size_t k = 0; k < g.fold.size(); ++k)
        if (g.fold[k] >= 0)
            present.push_back(time[k]);
    std::sort(present.begin(), present.end());
    const auto rows = static_cast<long>(present.size());
    for (std::size_t k = 0; k < g.fold.size(); ++k)
        if (g.fold[k] >= 0) {
            const long before = std::lower_bound(present.begin(), present.end(), time[k]) - present.begin();
            g.fold[k] = g.block[k] = static_cast<int>(std::min<long>(parts - 1, parts * before / rows));
        }
    g.folds = g.blocks = parts;
}

/// Which runs are left out together: those that repeat one another, as long as others remain to learn from. A run whose
/// repeats have been seen has been seen.
std::vector<int> foldsOf(const Data& data) {
    std::vector<int> fold;
    int folds = 0;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const std::size_t first = data.firstOf(r);
        fold.push_back(first < r ? fold[first] : folds++);
    }
    if (folds < 2)
        std::iota(fold.begin(), fold.end(), 0);
    return fold;
}

/// "run_1.csv", "run_4.csv and 2 repeats".
std::string nameOf(const Data& data, const std::vector<int>& folds, int fold) {
    std::string name;
    std::size_t repeats = 0;
    for (std::size_t r = 0; r < folds.size(); ++r)
        if (folds[r] == fold) {
            repeats += name.empty() ? 0 : 1;
            name = name.empty() ? data.runs[r].name : name;
        }
    return repeats == 0 ? name : name + " and " + std::to_string(repeats) + (repeats == 1 ? " repeat" : " repeats");
}

/// A jump belongs to where the force jumps.
void joinForce(Grouping& g, const Misfit& misfit, std::size_t r, Index row) {
    const RecordedRun& run = misfit.data().runs[r];
    const double at = misfit.jumps(r)[static_cast<std::size_t>(row - run.rows())].time;
    Index nearest = -1;
    for (Index k = 0; k < run.force.size(); ++k)
        if (misfit.counts(r, k) && (nearest < 0 || std::abs(run.time[k] - at) < std::abs(run.time[nearest] - at)))
            nearest = k;
    if (nearest < 0)
        return;
    const auto from = static_cast<std::size_t>(misfit.start(r) + nearest),
               to = static_cast<std::size_t>(misfit.start(r) + row);
    g.fold[to] = g.fold[from];
    g.block[to] = g.block[from];
}

} // namespace

Grouping groupingOf(const Misfit& misfit) {
    Grouping g;
    const bool byRun = misfit.runs() > 1;
    const std::vector<int> runFolds = foldsOf(misfit.data());
    for (std::size_t r = 0; r < misfit.runs(); ++r) {
        const RecordedRun& run = misfit.data().runs[r];
        // Cycles of a single run: a new one begins with each loading.
        std::vector<int> cycle;
        for (const Stroke& stroke : run.strokes)
            cycle.push_back((cycle.empty() ? 0 : cycle.back()) + (stroke.phase == Phase::Loading ? 1 : 0));
        std::map<std::pair<std::size_t, bool>, int> blocks;
        for (Index k = 0; k < misfit.rowsOf(r); ++k) {
            const std::size_t stroke = misfit.stroke(r, k);
            if (!misfit.counts(r, k)) {
                g.fold.push_back(-1);
                g.block.push_back(-1);
                continue;
            }
            g.fold.push_back(byRun ? runFolds[r] : std::max(0, cycle[stroke] - 1));
            const auto at = blocks.emplace(std::pair(stroke, misfit.isMarker(r, k)), g.blocks);
            g.blocks += at.second ? 1 : 0;
            g.block.push_back(at.first->second);
        }
    }
    for (const int f : g.fold)
        g.folds = std::max(g.folds, f + 1);
    for (int f = 0; f < g.folds; ++f)
        g.names.push_back(byRun ? nameOf(misfit.data(), runFolds, f) : "cycle " + std::to_string(f + 1));
    if (g.folds < 2) {
        constexpr int kParts = 5;
        cutInto(g, misfit, kParts);
        g.names.clear();
        for (int f = 0; f < kParts; ++f)
            g.names.push_back("fifth " + std::to_string(f + 1));
        for (std::size_t r = 0; r < misfit.runs(); ++r)
            for (Index k = misfit.data().runs[r].rows(); k < misfit.rowsOf(r); ++k)
                joinForce(g, misfit, r, k);
    }
    return g;
}

double forceRmse(const Misfit& misfit, const std::vector<Response>& simulated, const Grouping* grouping, int fold,
                 double* squares, double* count) {
    double sum = 0.0, rows = 0.0;
    for (std::size_t r = 0; r < misfit.runs(); ++r) {
        const RecordedRun& run = misfit.data().runs[r];
        const Departure departure = misfit.departure(r, simulated[r]);
        if (departure.rows.size() == 0)
            continue;
        std::vector<double> d;
        double mean = 0.0;
        for (Index k = 0; k < run.force.size(); ++k)
            if (std::isfinite(misfit.errors(r).force[k]) && !departure.hidden[static_cast<std::size_t>(k)] &&
                (grouping == nullptr || grouping->fold[static_cast<std::size_t>(misfit.start(r) + k)] == fold)) {
                d.push_back(departure.rows[k]);
                mean += d.back();
            }
        mean /= std::max<double>(1.0, static_cast<double>(d.size()));
        const double known = 2.0 * misfit.zeroOf(r); // more than that is no matter of the zero
        mean = std::clamp(mean, -known, known);
        for (const double v : d)
            sum += (v - mean) * (v - mean);
        rows += static_cast<double>(d.size());
    }
    if (squares != nullptr)
        *squares += sum;
    if (count != nullptr)
        *count += rows;
    return rows > 0.0 ? std::sqrt(sum / rows) : 0.0;
}

HeldOut inSample(const Misfit& misfit, const Grouping& g, const Fitted& fitted) {
    HeldOut out;
    out.energy = out.volume = out.rows = Eigen::VectorXd::Zero(g.blocks);
    out.error = Eigen::VectorXd::Zero(misfit.rows());
    const Eigen::VectorXd charge = misfit.charge(fitted.responses);
    for (Index k = 0; k < misfit.rows(); ++k)
        if (const int b = g.block[static_cast<std::size_t>(k)]; b >= 0) {
            out.energy[b] += fitted.residual[k] * fitted.residual[k] + charge[k];
            out.rows[b] += 1.0;
            out.error[k] = fitted.residual[k];
        }
    out.forceRmse = forceRmse(misfit, fitted.responses);
    return out;
}

namespace {

Eigen::VectorXd variances(const Eigen::MatrixXd& precision) {
    return precision.llt().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols())).diagonal();
}

/// Numbers of which the runs know much, and nothing without a fold.
/// @param known, left their variances by all rows and by those of the other folds
void markOnly(const Variables& v, const Eigen::VectorXd& known, const Eigen::VectorXd& left,
              const Eigen::MatrixXd& prior, int fold, std::vector<int>& only) {
    constexpr double kNothing = 0.5, kMuch = 0.05; // of the prior's variance
    for (Index k = v.nominal; k < v.size(); ++k)
        if (known[k] * prior(k, k) < kMuch && left[k] * prior(k, k) > kNothing)
            only[static_cast<std::size_t>(k)] = fold;
}

/// Of the effect's numbers the one that moved most, in deviations of its prior.
Index mostMoved(const Variables& v, const Eigen::VectorXd& step, const Eigen::MatrixXd& prior) {
    Index most = v.nominal;
    for (Index k = v.nominal; k < v.size(); ++k)
        if (std::abs(step[k]) * std::sqrt(prior(k, k)) > std::abs(step[most]) * std::sqrt(prior(most, most)))
            most = k;
    return most;
}

/// Numbers and what is left with them.
struct Place {
    Eigen::VectorXd x, residual, charge;
    std::vector<Response> responses;
    /// Squares of the rows of a mask.
    [[nodiscard]] double squares(const Eigen::VectorXd& rows) const {
        return rows.cwiseProduct(residual).squaredNorm() + rows.dot(charge);
    }
};

/// Where the rows of a fold put the numbers: the linearised minimum inside the box, simulated, and one correction.
Place fittedTo(Evaluator& evaluator, const Misfit& misfit, const Variables& v, const Eigen::MatrixXd& J,
               const Eigen::MatrixXd& damped, const Eigen::VectorXd& train, Place at) {
    constexpr double kPromises = 0.1; // a step that lowers the misfit by less is not worth its simulations
    for (int correction = 0; correction < 2; ++correction) {
        const Eigen::VectorXd far = Eigen::VectorXd::Constant(v.size(), 2.0);
        const Eigen::VectorXd downhill = J.transpose() * train.cwiseProduct(at.residual) - v.penalty * at.x;
        const Eigen::VectorXd step =
            boxMinimum(damped, downhill, (v.lower - at.x).cwiseMax(-far), (v.upper - at.x).cwiseMin(far));
        if (2.0 * downhill.dot(step) - step.dot(damped * step) < kPromises)
            break;
        Place to{at.x + step, {}, {}, evaluator.everywhere({v.at(at.x + step)}, Fineness::Fine).front()};
        const auto residual = misfit.residual(to.responses);
        if (!residual)
            break;
        to.residual = *residual;
        to.charge = misfit.charge(to.responses);
        // A step that the training rows themselves reject is not taken.
        if (to.squares(train) > at.squares(train) + 1.0)
            break;
        at = std::move(to);
    }
    return at;
}

} // namespace

HeldOut leaveOut(Evaluator& evaluator, const Misfit& misfit, const Grouping& g, const Fitted& fitted) {
    // The density counts as bent where it is so many squares off what the fit to all rows contributes to it
    // (heldout.h), and the others as indifferent to so few.
    constexpr double kBent = 6.0, kIndifferent = 2.0;
    HeldOut out;
    const Variables v(evaluator.model(), fitted.point);
    out.energy = out.volume = out.rows = Eigen::VectorXd::Zero(g.blocks);
    out.error = Eigen::VectorXd::Zero(misfit.rows());
    const Eigen::MatrixXd& J = fitted.jacobian;
    const Eigen::MatrixXd prior = priorOf(v) + v.penalty;
    const Eigen::VectorXd known = variances(J.transpose() * J + prior);
    out.only.assign(static_cast<std::size_t>(v.size()), -1);
    double squares = 0.0, count = 0.0;
    const Place best{fitted.x, fitted.residual, misfit.charge(fitted.responses), fitted.responses};
    for (int f = 0; f < g.folds; ++f) {
        const Eigen::VectorXd held = maskOf(g, f);
        const Eigen::VectorXd train = Eigen::VectorXd::Ones(held.size()) - held;
        const Eigen::MatrixXd G = J.transpose() * train.asDiagonal() * J;
        markOnly(v, known, variances(G + prior), prior, f, out.only);
        // What the rest does not see stays where it is.
        Place at = fittedTo(evaluator, misfit, v, J, G + 1e-3 * prior + v.penalty, train, best);
        Eigen::VectorXd e = held.cwiseProduct(at.residual);
        const Eigen::LLT<Eigen::MatrixXd> precision(G + prior);
        const Eigen::MatrixXd root =
            precision.matrixL().solve(Eigen::MatrixXd::Identity(v.size(), v.size())).transpose();
        const double logDet = standardise(held.asDiagonal() * (J * root), e);
        const double rows = held.sum();
        const auto others = [&](const Place& p) { return p.squares(train) + p.x.dot(v.penalty * p.x); };
        const double object = std::max(0.0, others(best) - others(at));
        const double direct = e.squaredNorm() + held.dot(at.charge), whole = best.squares(held) + object;
        if (std::abs(direct - whole) > kBent) {
            e = held.cwiseProduct(best.residual);
            at.charge = best.charge + object / rows * held;
            if (direct > whole && object < kIndifferent) {
                at.responses = best.responses;
                if (v.size() > v.nominal)
                    out.only[static_cast<std::size_t>(mostMoved(v, at.x - best.x, prior))] = f;
            }
        }
        for (Index k = 0; k < e.size(); ++k)
            if (const int b = g.block[static_cast<std::size_t>(k)]; b >= 0 && held[k] > 0.0) {
                out.energy[b] += e[k] * e[k] + at.charge[k];
                out.volume[b] += logDet / rows;
                out.rows[b] += 1.0;
                out.error[k] = e[k];
            }
        forceRmse(misfit, at.responses, &g, f, &squares, &count);
    }
    out.forceRmse = count > 0.0 ? std::sqrt(squares / count) : 0.0;
    return out;
}

} // namespace supercircle::diagnosis
