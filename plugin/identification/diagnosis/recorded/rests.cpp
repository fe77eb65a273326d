#include "plugin/identification/diagnosis/recorded/rests.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace supercircle::diagnosis {

using Index = Eigen::Index;

std::vector<Rest> restsOf(const Data& data) {
    std::vector<Rest> found;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        for (std::size_t l = 0; l < run.legs.size(); ++l) {
            if (run.legs[l].phase != Phase::Hold)
                continue;
            std::vector<double> t, f;
            const bool first = l == 0;
            // A rest that follows a motion begins with whatever rings on.
            const double from = run.legs[l].from + (first ? 0.0 : 0.1);
            for (Index k = 0; k < run.time.size(); ++k)
                if (run.time[k] >= from && run.time[k] <= run.legs[l].to - 1e-9 && std::isfinite(run.force[k])) {
                    t.push_back(run.time[k]);
                    f.push_back(run.force[k]);
                }
            if (t.size() < 12)
                continue;
            Rest rest;
            rest.run = r;
            const auto n = static_cast<Index>(t.size());
            rest.time = Eigen::Map<Eigen::VectorXd>(t.data(), n);
            rest.force = Eigen::Map<Eigen::VectorXd>(f.data(), n);
            rest.trends.resize(n, first ? 1 : 3);
            rest.trends.col(0).setOnes();
            if (!first) {
                rest.trends.col(1) = (rest.time.array() - t.front()) / (t.back() - t.front());
                rest.trends.col(2) = (1.0 + (rest.time.array() - run.legs[l].from) / 0.3).log();
            }
            found.push_back(std::move(rest));
        }
    }
    return found;
}

double restrictedLogLikelihood(const Rest& rest, double white, double coloured, double memory) {
    const Whitening w(rest.time, white, coloured, memory);
    const Eigen::VectorXd u = w.apply(rest.force);
    const Eigen::MatrixXd x = w.columns(rest.trends);
    const Eigen::LLT<Eigen::MatrixXd> gram(x.transpose() * x);
    const Eigen::VectorXd xu = x.transpose() * u;
    const double left = u.squaredNorm() - xu.dot(gram.solve(xu));
    const double logGram = 2.0 * gram.matrixLLT().diagonal().array().log().sum();
    return -0.5 * (left + w.logDeterminant() + logGram);
}

} // namespace supercircle::diagnosis
