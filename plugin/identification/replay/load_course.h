#pragma once
// Loads of a scene that follow a driven parameter (private to replay/).

#include "plugin/identification/replay/scene_of_run.h"
#include "plugin/identification/replay/test_rig.h"

namespace supercircle::replay {

class LoadCourse {
public:
    /// The scene of a run at the ends of its drive. Loads must change in proportion to the parameter.
    LoadCourse(const experiment::Experiment& e, std::size_t run, const Parameters& p);
    /// Why they do not; empty: they do.
    [[nodiscard]] const std::string& failure() const { return failure_; }
    /// The resolution that readings at rest need: what swings on the way there is not followed.
    [[nodiscard]] static Resolution forRest(Resolution resolution);
    /// Gives the specimens of the rig the loads at a value of the parameter.
    void set(TestRig& rig, double value) const;

private:
    double from_ = 0.0, to_ = 0.0;               ///< values of the parameter
    std::vector<scene::PointLoad> first_, last_; ///< loads there
    std::string failure_;
};

} // namespace supercircle::replay
