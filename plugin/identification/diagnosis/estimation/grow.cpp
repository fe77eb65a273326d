#include "plugin/identification/diagnosis/estimation/grow.h"

#include <limits>

namespace supercircle::diagnosis {

namespace {

/// The first `share` of every run.
Data beginning(const Data& data, double share) {
    Data out = data;
    for (RecordedRun& run : out.runs) {
        if (run.time.size() < 2)
            continue;
        const double until = run.time[0] + share * (run.time[run.time.size() - 1] - run.time[0]);
        for (Eigen::Index k = 0; k < run.time.size(); ++k)
            if (run.time[k] > until)
                run.force[k] = std::numeric_limits<double>::quiet_NaN();
        for (Eigen::Index k = 0; k < run.markers.size(); ++k)
            if (run.markerTime[k % run.markerTime.size()] > until)
                run.markers[k] = std::numeric_limits<double>::quiet_NaN();
    }
    return out;
}

} // namespace

Point grown(Evaluator& evaluator, const Misfit& misfit, const Point& start, const FitSettings& settings) {
    Point at = start;
    if (!misfit.data().free)
        return at;
    for (const double share : {0.125, 0.25, 0.5}) {
        const Data part = beginning(misfit.data(), share);
        const auto there = evaluator.everywhere({at}, Fineness::Fine).front();
        const Misfit shorter(part, misfit.noise(), there, there, misfit.settings());
        FitSettings given = settings;
        given.grow = false;
        given.rival = 0.0;
        const Fitted f = fit(evaluator, shorter, at, given);
        if (!f.failure.empty() || evaluator.stopped())
            break;
        at = f.point;
    }
    return at;
}

} // namespace supercircle::diagnosis
