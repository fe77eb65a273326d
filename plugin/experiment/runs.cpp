// The CSV files of the runs.

#include "plugin/experiment/health.h"
#include "plugin/experiment/load.h"
#include "plugin/record/csv.h"

#include <cstdio>
#include <filesystem>

namespace supercircle::experiment {

namespace {

namespace fs = std::filesystem;

/// The reader's message begins with file:line:column already.
void reportCsv(std::vector<scene::Problem>& problems, const std::string& file, const std::string& message) {
    scene::Problem p;
    p.file = file;
    p.what = message;
    if (message.rfind(file + ":", 0) == 0) {
        const char* rest = message.c_str() + file.size() + 1;
        int used = 0;
        if (std::sscanf(rest, "%d:%d: %n", &p.line, &p.column, &used) != 2 || used == 0)
            p.line = p.column = used = 0;
        p.what = rest + used + (used == 0 && *rest == ' ' ? 1 : 0);
    }
    problems.push_back(std::move(p));
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
    std::vector<double> out(values);
    for (double& v : out)
        v *= factor;
    return out;
}

void readReadings(const Experiment& e, Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
    record::CsvOptions options;
    options.required = {"time_s", "displacement_mm", "force_N"};
    const auto csv = record::readCsv(path, options);
    if (!csv) {
        reportCsv(problems, path, csv.error);
        return;
    }
    run.readings.time = *csv.value.find("time_s");
    run.readings.displacement = scaled(*csv.value.find("displacement_mm"), 1e-3);
    run.readings.force = *csv.value.find("force_N");
    judgeReadings(e, run, path, problems);
}

void readTracks(const Experiment& e, Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
    record::CsvOptions options;
    options.required = {"time_s"};
    for (const Marker& m : e.markers)
        for (const char* axis : {"_x_mm", "_y_mm"})
            options.required.push_back(m.name + axis);
    const auto csv = record::readCsv(path, options);
    if (!csv) {
        reportCsv(problems, path, csv.error);
        return;
    }
    run.markers.time = *csv.value.find("time_s");
    for (const Marker& m : e.markers) {
        run.markers.x.push_back(scaled(*csv.value.find(m.name + "_x_mm"), 1e-3));
        run.markers.y.push_back(scaled(*csv.value.find(m.name + "_y_mm"), 1e-3));
    }
    judgeTracks(e, run, path, problems);
}

} // namespace

void readRuns(Experiment& experiment, std::vector<scene::Problem>& problems) {
    const fs::path folder = fs::path(experiment.file).parent_path();
    for (Run& run : experiment.runs) {
        readReadings(experiment, run, (folder / run.file).string(), problems);
        if (!run.markersFile.empty())
            readTracks(experiment, run, (folder / run.markersFile).string(), problems);
    }
}

} // namespace supercircle::experiment
