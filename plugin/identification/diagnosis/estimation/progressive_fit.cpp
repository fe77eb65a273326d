#include "plugin/identification/diagnosis/estimation/progressive_fit.h"

#include "plugin/identification/diagnosis/estimation/event_fit.h"

#include <limits>

namespace supercircle::diagnosis {

RecordedData firstPart(const RecordedData& data, double share) {
    RecordedData out = data;
    for (RecordedRun& run : out.runs) {
        if (run.time.size() < 2)
            continue;
        const double until = run.time[0] + share * (run.time[run.time.size() - 1] - run.time[0]);
        for (Eigen::Index k = 0; k < run.time.size(); ++k)
            if (run.time[k] > until) {
                run.force[k] = std::numeric_limits<double>::quiet_NaN();
                for (std::size_t c = 0; c < run.furtherCount; ++c)
                    run.further[static_cast<Eigen::Index>(c) * run.time.size() + k] =
                        std::numeric_limits<double>::quiet_NaN();
            }
        for (Eigen::Index k = 0; k < run.markers.size(); ++k)
            if (run.markerTime[k % run.markerTime.size()] > until)
                run.markers[k] = std::numeric_limits<double>::quiet_NaN();
    }
    return out;
}

ParameterPoint progressiveStart(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
                                const FitSettings& settings) {
    ParameterPoint at = start;
    if (!likelihood.data().free)
        return at;
    if (const auto events = fitEvents(evaluator, likelihood, start))
        return *events;
    for (const double share : {0.125, 0.25, 0.5}) {
        const RecordedData part = firstPart(likelihood.data(), share);
        const auto there = evaluator.simulateAllRuns({at}, Fidelity::Fine).front();
        const Likelihood shorter(part, likelihood.noise(), there, likelihood.finerThan(there), likelihood.settings());
        FitSettings given = settings;
        given.progressive = false;
        given.competitor = 0.0;
        const FitResult f = fit(evaluator, shorter, at, given);
        if (!f.failure.empty() || evaluator.stopped())
            break;
        at = f.point;
    }
    return at;
}

} // namespace supercircle::diagnosis
