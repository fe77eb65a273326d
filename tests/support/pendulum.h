#pragma once
// The shipped pendulum as an experiment: a rod on a bearing whose angle is recorded.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/document.h"

#include <cmath>
#include <string>
#include <vector>

namespace supercircle::test {

/// Without runs. @param length of the rod, m
inline experiment::Experiment pendulum(experiment::Stated length) {
    experiment::Experiment e;
    e.protocol = experiment::Protocol::FreeScene;
    e.gravity = {0.0, -9.81};
    experiment::FreeScene s;
    s.file = "pendulum.json";
    std::vector<scene::Problem> problems;
    s.text = scene::readFile(std::string(SC_SOURCE_DIR) + "/scenes/pendulum.json", problems).value();
    s.parameters = {{"length", length, "m", ""}};
    s.observation.target = "rod";
    s.observation.quantity = scene::Observation::Quantity::Angle;
    s.channel = {"angle", "deg", "angle_deg", 180.0 / M_PI, 1.0};
    e.scene = s;
    return e;
}

/// Adds a run without readings. @param duration s  @param rate Hz  @param angle rad  @param spin rad/s
inline void addSwing(experiment::Experiment& e, double duration, double rate, experiment::Stated angle,
                     experiment::Stated spin) {
    experiment::Run run;
    run.file = "run_" + std::to_string(e.runs.size() + 1) + ".csv";
    run.driveTime = {0.0, duration};
    run.driveDisplacement = {0.0, 0.0};
    run.samplingRate = rate;
    run.parameters = {{"release_angle", angle, "rad", ""}, {"release_spin", spin, "rad/s", ""}};
    e.runs.push_back(run);
}

} // namespace supercircle::test
