#pragma once
// A block on a belt, whose force is the friction, as an experiment without readings; and a diagnosis in short.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/effects/effect.h"

#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// @param parameters entries of "scene_parameters", @param drive "drive_time_s" and "drive_displacement_mm"
inline Result<experiment::Experiment> beltOf(const std::string& parameters, const std::string& drive) {
    const test::Folder folder;
    folder.write("run.csv", "time_s,force_N\n0,0\n0.01,1\n");
    return experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "block_on_belt", "scene_parameters": {)" + parameters +
                                                                R"(}, "channels": [{"observe": "force",
        "column": "force_N", "noise_std": 0.003}], "runs": [{"file": "run.csv", )" +
                                                                drive + "}]}"));
}

/// The same at 50 Hz, without the rows of the file.
inline experiment::Experiment belt(const std::string& parameters, const std::string& drive) {
    const auto loaded = beltOf(parameters, drive);
    INFO(loaded.error());
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    e.runs.front().readings = {};
    e.runs.front().samplingRate = 50.0;
    return e;
}

/// All effects but some.
inline std::vector<std::string> catalogueWithout(const std::vector<std::string>& some) {
    std::vector<std::string> labels;
    for (const effects::Effect& effect : effects::catalog())
        if (std::find(some.begin(), some.end(), effect.name) == some.end())
            labels.push_back(effect.name);
    return labels;
}

/// With few draws, and without a next experiment.
inline Diagnosis shortDiagnosis(const ReplayModel& model, const experiment::Experiment& e) {
    const RecordedData data = recordedDataOf(e);
    SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), {}, cache);
    DiagnosisSettings settings;
    settings.draws = 199;
    settings.nextExperiment = false;
    return diagnose(data, evaluator, settings);
}

} // namespace supercircle::diagnosis
