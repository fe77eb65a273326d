#include "plugin/identification/diagnosis/recorded/dwell_intervals.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "supercircle/support/elementary.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace supercircle::diagnosis {

using Index = Eigen::Index;

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
