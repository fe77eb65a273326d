#include "plugin/diagnosis/next.h"

#include "plugin/diagnosis/whitening.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>

namespace supercircle::diagnosis {

namespace {

/// Distance of two simulated runs in noise units, a constant shift taken out.
double distance(const DesignResponse& a, const DesignResponse& b, const Noise& noise) {
    if (!a.failure.empty() || !b.failure.empty() || a.force.size() != b.force.size() || a.force.size() < 8)
        return 0.0;
    const Eigen::VectorXd d = a.force - b.force;
    if (!d.allFinite())
        return 0.0;
    const Whitening w(a.time, noise.white, noise.coloured, noise.memory);
    Eigen::VectorXd u = w.apply(d), one = w.apply(Eigen::VectorXd::Ones(d.size()));
    u -= one * (one.dot(u) / one.squaredNorm());
    return u.norm();
}

} // namespace

std::optional<NextExperiment> nextExperiment(const Model& model, const std::vector<Rival>& rivals, const Noise& noise,
                                             const std::vector<std::string>& group) {
    if (rivals.size() < 2 || noise.total() <= 0.0)
        return std::nullopt;
    // A rival that these runs cannot tell from the first is the one that matters.
    std::size_t other = 1;
    for (std::size_t i = 1; i < rivals.size(); ++i)
        if (std::find(group.begin() + 1, group.end(), rivals[i].label) != group.end()) {
            other = i;
            break;
        }
    double farthest = 0.0;
    NextExperiment best;
    const std::vector<Design> designs = model.designs();
    constexpr double kEnough =
        5.0; // noise units beyond which runs are all as good: the first one listed is the simplest
    for (std::size_t i = 0; i < designs.size() && farthest < kEnough; ++i) {
        const double d = distance(model.simulateDesign(i, rivals[0].point, nullptr),
                                  model.simulateDesign(i, rivals[other].point, nullptr), noise);
        if (d > farthest) {
            farthest = d;
            best.run = designs[i];
        }
    }
    if (farthest <= 0.0)
        return std::nullopt;
    best.separates = {rivals[0].label, rivals[other].label};
    best.power = boost::math::cdf(boost::math::normal(), farthest - 1.6448536269514722);
    return best;
}

} // namespace supercircle::diagnosis
