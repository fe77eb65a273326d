#include "plugin/identification/diagnosis/estimation/beside_stated.h"

#include <algorithm>

namespace supercircle::diagnosis {

BesideStated simulateBesideStated(Evaluator& evaluator, const Variables& stated) {
    const double difference = FitSettings{}.differenceStep;
    BesideStated out;
    out.span.resize(stated.size());
    std::vector<ParameterPoint> points;
    for (Eigen::Index i = 0; i < stated.size(); ++i) {
        const double up = std::min(difference, stated.upper[i]), down = std::max(-difference, stated.lower[i]);
        out.span[i] = up - down;
        for (const double side : {up, down}) {
            Eigen::VectorXd x = Eigen::VectorXd::Zero(stated.size());
            x[i] = side;
            points.push_back(stated.at(x));
        }
    }
    out.fine = evaluator.simulateAllRuns({statedPoint(evaluator.model())}, Fidelity::Fine).front();
    const auto beside = evaluator.simulateAllRuns(points, Fidelity::Coarse);
    for (std::size_t i = 0; i < beside.size(); i += 2) {
        out.up.push_back(beside[i]);
        out.down.push_back(beside[i + 1]);
    }
    return out;
}

} // namespace supercircle::diagnosis
