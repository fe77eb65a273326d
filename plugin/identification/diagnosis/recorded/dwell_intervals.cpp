#include "plugin/identification/diagnosis/recorded/dwell_intervals.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "supercircle/support/elementary.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

using Index = Eigen::Index;

namespace {

/// First rows of the levels of a run, and their end; empty where rows were read in motion.
std::vector<Index> levelsOf(const RecordedRun& run) {
    constexpr Index kFewest = 3; // a second difference; fewer show no noise
    std::vector<Index> starts = {0};
    for (Index k = 1; k <= run.displacement.size(); ++k)
        if (k == run.displacement.size() || run.displacement[k] != run.displacement[k - 1]) {
            if (k - starts.back() < kFewest)
                return {};
            starts.push_back(k);
        }
    return starts;
}

} // namespace

RecordedData levelsApart(RecordedData data) {
    for (RecordedRun& run : data.runs) {
        const std::vector<Index> starts = levelsOf(run);
        std::vector<double> time, force;
        for (std::size_t l = 0; l + 1 < starts.size(); ++l) {
            if (l > 0) {
                time.push_back(0.5 * (run.time[starts[l] - 1] + run.time[starts[l]]));
                force.push_back(std::numeric_limits<double>::quiet_NaN());
            }
            time.insert(time.end(), run.time.begin() + starts[l], run.time.begin() + starts[l + 1]);
            force.insert(force.end(), run.force.begin() + starts[l], run.force.begin() + starts[l + 1]);
        }
        if (starts.size() < 3)
            continue;
        run.time = Eigen::Map<Eigen::VectorXd>(time.data(), static_cast<Index>(time.size()));
        run.force = Eigen::Map<Eigen::VectorXd>(force.data(), static_cast<Index>(force.size()));
    }
    return data;
}

std::vector<DwellInterval> dwellIntervalsOf(const RecordedData& data) {
    std::vector<DwellInterval> found;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        for (std::size_t l = 0; l < run.segments.size(); ++l) {
            if (run.segments[l].phase != Phase::Hold)
                continue;
            std::vector<double> t, f;
            const bool first = l == 0;
            // Oscillation after a motion is excluded.
            const double from = run.segments[l].from + (first ? 0.0 : 0.1 * run.units.time);
            for (Index k = 0; k < run.time.size(); ++k)
                if (run.time[k] >= from && run.time[k] <= run.segments[l].to - 1e-9 * run.units.time &&
                    std::isfinite(run.force[k])) {
                    t.push_back(run.time[k]);
                    f.push_back(run.force[k]);
                }
            if (t.size() < 12)
                continue;
            DwellInterval dwell;
            dwell.run = r;
            const auto n = static_cast<Index>(t.size());
            dwell.time = Eigen::Map<Eigen::VectorXd>(t.data(), n);
            dwell.force = Eigen::Map<Eigen::VectorXd>(f.data(), n);
            dwell.trends.resize(n, first ? 1 : 3);
            dwell.trends.col(0).setOnes();
            if (!first) {
                dwell.trends.col(1) = (dwell.time.array() - t.front()) / (t.back() - t.front());
                dwell.trends.col(2) = (1.0 + (dwell.time.array() - run.segments[l].from) / (0.3 * run.units.time))
                                          .unaryExpr([](double each) { return math::log(each); });
            }
            found.push_back(std::move(dwell));
        }
    }
    return found;
}

double restrictedLogLikelihood(const DwellInterval& dwell, double white, double correlated, double correlationTime) {
    const Whitening w(dwell.time, white, correlated, correlationTime);
    const Eigen::VectorXd u = w.apply(dwell.force);
    const Eigen::MatrixXd x = w.columns(dwell.trends);
    const Eigen::LLT<Eigen::MatrixXd> gram(x.transpose() * x);
    const Eigen::VectorXd xu = x.transpose() * u;
    const double left = u.squaredNorm() - xu.dot(gram.solve(xu));
    const double logGram =
        2.0 * gram.matrixLLT().diagonal().array().unaryExpr([](double each) { return math::log(each); }).sum();
    return -0.5 * (left + w.logDeterminant() + logGram);
}

} // namespace supercircle::diagnosis
