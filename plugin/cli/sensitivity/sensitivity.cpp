#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/replay/experiment_input.h"
#include "plugin/cli/subcommands.h"
#include "plugin/pages/sensitivity/sensitivity_page.h"

#include "plugin/recording/experiment/load.h"
#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/json_text.h"
#include "plugin/recording/table/text.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;
using record::NamedText;
using sensitivity::Quality;
using sensitivity::RunSensitivity;

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& v : values)
        v *= factor;
    return values;
}

std::vector<double> columnOf(const Eigen::MatrixXd& m, Eigen::Index c, double factor) {
    return scaled({m.col(c).data(), m.col(c).data() + m.rows()}, factor);
}

/// d force / d parameter over time, N (of poses degrees or mm) per unit of the parameter, with a column of usable rows.
record::Series forceTable(const SensitivityStudy& study, const RunSensitivity& run) {
    record::Series s;
    const experiment::Channel& channel = experiment::channel(study.experiment);
    const double k = channel.perUnit;
    const experiment::DriveAxis drive = experiment::driveAxis(study.experiment);
    s.names = {"time_s", drive.column(), channel.column, std::string("solver_noise_") + channel.unit};
    s.columns = {run.base.readings.time, scaled(run.base.readings.displacement, drive.perUnit),
                 scaled(run.base.readings.force, k),
                 scaled({run.forceNoise.data(), run.forceNoise.data() + run.forceNoise.size()}, k)};
    for (std::size_t c = 0; c < study.result.columns.size(); ++c) {
        const auto at = static_cast<Eigen::Index>(c);
        const std::string& name = study.result.columns[c].name;
        s.names.insert(s.names.end(), {"d" + std::string(channel.name) + "_d" + name, "usable_" + name});
        s.columns.push_back(columnOf(run.force, at, k));
        s.columns.emplace_back();
        for (Eigen::Index i = 0; i < run.usable.rows(); ++i)
            s.columns.back().push_back(run.usable(i, at) ? 1.0 : 0.0);
    }
    return s;
}

/// d marker / d parameter over time, m per unit of the parameter.
record::Series markerTable(const SensitivityStudy& study, const RunSensitivity& run) {
    record::Series s;
    s.names = {"time_s"};
    s.columns = {run.base.markers.time};
    const std::size_t rows = run.base.markers.time.size();
    for (std::size_t m = 0; m < study.experiment.markers.size(); ++m)
        for (std::size_t axis = 0; axis < 2; ++axis)
            for (std::size_t c = 0; c < study.result.columns.size(); ++c) {
                s.names.push_back("d" + study.experiment.markers[m].name + (axis == 0 ? "_x_d" : "_y_d") +
                                  study.result.columns[c].name);
                const double* from = run.markers.col(static_cast<Eigen::Index>(c)).data() + (2 * m + axis) * rows;
                s.columns.emplace_back(from, from + rows);
            }
    return s;
}

/// One row per landmark: value, computational noise, then derivative and its error per column.
std::string landmarkTable(const SensitivityStudy& study) {
    std::string text = "run,landmark,unit,value,solver_noise";
    for (const sensitivity::Column& c : study.result.columns)
        text += ",d_d" + c.name + ",error_" + c.name;
    text += '\n';
    for (std::size_t r = 0; r < study.result.runs.size(); ++r) {
        const RunSensitivity& run = study.result.runs[r];
        for (std::size_t i = 0; i < run.landmarks.names.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            text += record::csvCell(study.runName(r)) + "," + run.landmarks.names[i] + "," + run.landmarks.units[i];
            const auto put = [&](double v) {
                text += ',';
                record::appendNumber(text, v);
            };
            put(run.landmarks.values[i]);
            put(run.landmarkNoise[row]);
            for (Eigen::Index c = 0; c < run.landmarkJacobian.cols(); ++c) {
                put(run.landmarkJacobian(row, c));
                put(run.landmarkError(row, c));
            }
            text += '\n';
        }
    }
    return text;
}

Json qualityOf(const Quality& q) {
    return {{"step", q.step},
            {"one_sided", q.oneSided},
            {"signal", q.signal},
            {"marker_signal", q.markerSignal},
            {"two_step_error", q.twoStepError},
            {"noise_error", q.noiseError},
            {"below_solver_noise", q.belowNoise},
            {"markers_below_solver_noise", q.markersBelowNoise},
            {"jump_shift_samples", q.jumpShift},
            {"changes_jumps", q.changesJumps},
            {"failure", q.failure.empty() ? Json(nullptr) : Json(q.failure)}};
}

std::string summary(const SensitivityStudy& study) {
    const sensitivity::Sensitivities& s = study.result;
    const experiment::Channel& channel = experiment::channel(study.experiment);
    Json columns = Json::array(), runs = Json::array(), cosines = Json::array();
    for (const sensitivity::Column& c : s.columns)
        columns.push_back(
            {{"name", c.name}, {"unit", c.unit}, {"about", c.about}, {"value", c.value}, {"scale", c.scale}});
    for (std::size_t r = 0; r < s.runs.size(); ++r) {
        Json quality = Json::object();
        for (std::size_t c = 0; c < s.columns.size(); ++c)
            quality[s.columns[c].name] = qualityOf(s.runs[r].quality[c]);
        runs.push_back({{"run", study.runName(r)},
                        {std::string("solver_noise_") + channel.name + "_" + channel.unit,
                         channel.perUnit * s.runs[r].forceNoiseRms},
                        {"solver_noise_markers_m", s.runs[r].markerNoiseRms},
                        {"columns", quality}});
    }
    const Eigen::MatrixXd m = sensitivity::similarity(s);
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        cosines.push_back(Json::array());
        for (Eigen::Index j = 0; j < m.cols(); ++j)
            cosines.back().push_back(m(i, j));
    }
    const Json json = {{"experiment", study.experiment.file},
                       {"elements", study.resolution.elements},
                       {"position_tolerance_m", study.resolution.positionTolerance},
                       {"columns", columns},
                       {"similarity", cosines},
                       {"runs", runs},
                       {"simulations", s.simulations},
                       {"cpu_s", s.cpuSeconds}};
    return record::jsonText(json) + "\n";
}

std::string writeAll(const SensitivityStudy& study, const std::string& folder) {
    std::vector<NamedText> files = {{"sensitivity.json", summary(study)}, {"landmarks.csv", landmarkTable(study)}};
    for (std::size_t r = 0; r < study.result.runs.size(); ++r) {
        const RunSensitivity& run = study.result.runs[r];
        auto force = record::csvText(forceTable(study, run));
        if (!force)
            return force.error();
        files.emplace_back(study.runName(r) + "_sensitivity.csv", *std::move(force));
        if (run.markers.rows() == 0)
            continue;
        auto markers = record::csvText(markerTable(study, run));
        if (!markers)
            return markers.error();
        files.emplace_back(study.runName(r) + "_sensitivity_markers.csv", *std::move(markers));
    }
    auto pages = sensitivityPages(study);
    if (!pages)
        return pages.error();
    std::move(pages->begin(), pages->end(), std::back_inserter(files));
    return record::writeAtomically(folder, files).error();
}

void print(const SensitivityStudy& study, const std::string& folder) {
    const sensitivity::Sensitivities& s = study.result;
    for (std::size_t r = 0; r < s.runs.size(); ++r) {
        const RunSensitivity& run = s.runs[r];
        std::printf("%s: solver noise %.2g N\n", study.runName(r).c_str(), run.forceNoiseRms);
        for (std::size_t c = 0; c < s.columns.size(); ++c) {
            const Quality& q = run.quality[c];
            const auto at = static_cast<Eigen::Index>(c);
            double most = 0.0;
            for (Eigen::Index i = 0; i < run.force.rows(); ++i)
                if (run.usable(i, at))
                    most = std::max(most, std::abs(run.force(i, at)));
            std::printf("  %-40s changes the force by up to %-9.3g N for %.3g %s%s%s\n", s.columns[c].name.c_str(),
                        most * s.columns[c].scale, s.columns[c].scale,
                        s.columns[c].unit == "1" ? "" : s.columns[c].unit.c_str(),
                        q.belowNoise ? "; below the solver noise" : "",
                        q.changesJumps ? "; shifts, adds or removes jumps" : "");
        }
    }
    std::printf("%zu simulations, %.1f s of processor time\n", s.simulations, s.cpuSeconds);
    std::printf("results: %s/sensitivity.json, landmarks.csv, run files; pictures: %s/sensitivity.html\n",
                folder.c_str(), folder.c_str());
}

/// The experiment with its overrides as a model; empty after a message.
std::optional<sensitivity::Model> prepare(const SensitivityArguments& a, SensitivityStudy& study) {
    auto loaded = loadExperiment(a.file, a.quiet, a.channel);
    if (!loaded)
        return std::nullopt;
    study.experiment = std::move(*loaded);
    study.resolution = a.full ? replay::Resolution::fine() : replay::Resolution::coarse();
    if (a.elements > 0)
        study.resolution.elements = a.elements;
    replay::Parameters parameters = replay::nominal(study.experiment);
    std::vector<scene::Override> overrides;
    if (!readOverrides(a.parameters, overrides))
        return std::nullopt;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(parameters, study.experiment, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return std::nullopt;
        }
    std::string error;
    std::vector<std::string> columns = a.columns;
    if (a.effects) {
        if (columns.empty())
            for (const replay::ParameterInfo& info : replay::parameterList(study.experiment))
                if (info.name.find('.') == std::string::npos)
                    columns.push_back(info.name);
        const std::vector<std::string> effects = sensitivity::effectNames(study.experiment);
        columns.insert(columns.end(), effects.begin(), effects.end());
    }
    sensitivity::Model model = sensitivity::replayModel(study.experiment, parameters, study.resolution, columns, error);
    if (!error.empty()) {
        std::fprintf(stderr, "--column: %s\n", error.c_str());
        return std::nullopt;
    }
    return model;
}

} // namespace

std::string SensitivityStudy::runName(std::size_t run) const {
    return experiment::runNames(experiment, false)[run];
}

int sensitivity(const SensitivityArguments& a) {
    SensitivityStudy study;
    const auto model = prepare(a, study);
    if (!model)
        return kBadInput;
    OutputFolder folder(resultsFolder(a.file, a.out, "sensitivity"));
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    {
        ProgressLine line(a.quiet);
        sensitivity::SensitivitySettings settings;
        settings.jobs = a.jobs;
        settings.interrupt = &interrupted;
        settings.progress = [&](double fraction) { line.show(fraction, "simulations"); };
        study.result = sensitivity::differentiate(*model, study.experiment, settings);
    }
    if (interrupted) {
        std::fprintf(stderr, "interrupted; nothing was written\n");
        return kInterrupted;
    }
    if (!study.result.failure.empty()) {
        std::fprintf(stderr, "%s\n", study.result.failure.c_str());
        return kCannotGoOn;
    }
    if (const std::string error = writeAll(study, folder.path()); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        print(study, folder.path());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
