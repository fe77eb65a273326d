#pragma once
// The motion or load of a run, played on the test rig (private to replay/).

#include "plugin/identification/replay/load_course.h"
#include "plugin/identification/replay/trace.h"

namespace supercircle::replay {

struct Driven {
    Trace trace;
    bool stopped = false;                ///< interrupted
    double largestCurvatureChange = 0.0; ///< 1/m
};

/// @param compliance in series with the specimens, m/N
/// @param loads of a prescribed load; nullptr: the machine moves
Driven drive(TestRig& rig, const experiment::Experiment& experiment, const experiment::Run& run, double compliance,
             const effects::ApparatusModel& apparatus, const Options& options, const LoadCourse* loads);

} // namespace supercircle::replay
