// The CSV files of the runs.

#include "plugin/experiment/load.h"
#include "plugin/record/csv.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace supercircle::experiment {

namespace {

namespace fs = std::filesystem;

void report(std::vector<scene::Problem>& problems, const std::string& file, const std::string& what,
            const std::string& expected = {}) {
    scene::Problem p;
    p.file = file;
    p.what = what;
    p.expected = expected;
    problems.push_back(std::move(p));
}

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

/// Increasing and finite; row numbers in messages count from 1, without the header.
bool goodTimes(const std::vector<double>& time, const std::string& file, std::vector<scene::Problem>& problems) {
    if (time.size() < 2) {
        report(problems, file, "fewer than two rows");
        return false;
    }
    for (std::size_t i = 0; i < time.size(); ++i)
        if (!std::isfinite(time[i]) || (i > 0 && time[i] <= time[i - 1])) {
            report(problems, file, "time_s of row " + std::to_string(i + 1) + " is missing or not later than before",
                   "increasing times");
            return false;
        }
    return true;
}

/// Samples outside the commanded motion cannot be replayed.
bool insideDrive(const std::vector<double>& time, const Run& run, const std::string& file,
                 std::vector<scene::Problem>& problems) {
    const double slack = 1e-6 + 0.5 / run.samplingRate;
    if (time.front() >= run.driveTime.front() - slack && time.back() <= run.driveTime.back() + slack)
        return true;
    report(problems, file, "the samples reach beyond drive_time_s",
           "times from " + std::to_string(run.driveTime.front()) + " s to " + std::to_string(run.driveTime.back()) +
               " s");
    return false;
}

void readReadings(Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
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
    if (goodTimes(run.readings.time, path, problems))
        insideDrive(run.readings.time, run, path, problems);
}

void readTracks(Run& run, const std::vector<Marker>& markers, const std::string& path,
                std::vector<scene::Problem>& problems) {
    record::CsvOptions options;
    options.required = {"time_s"};
    for (const Marker& m : markers)
        for (const char* axis : {"_x_mm", "_y_mm"})
            options.required.push_back(m.name + axis);
    const auto csv = record::readCsv(path, options);
    if (!csv) {
        reportCsv(problems, path, csv.error);
        return;
    }
    run.markers.time = *csv.value.find("time_s");
    for (const Marker& m : markers) {
        run.markers.x.push_back(scaled(*csv.value.find(m.name + "_x_mm"), 1e-3));
        run.markers.y.push_back(scaled(*csv.value.find(m.name + "_y_mm"), 1e-3));
    }
    if (goodTimes(run.markers.time, path, problems))
        insideDrive(run.markers.time, run, path, problems);
}

} // namespace

void readRuns(Experiment& experiment, std::vector<scene::Problem>& problems) {
    const fs::path folder = fs::path(experiment.file).parent_path();
    for (Run& run : experiment.runs) {
        readReadings(run, (folder / run.file).string(), problems);
        if (!run.markersFile.empty())
            readTracks(run, experiment.markers, (folder / run.markersFile).string(), problems);
    }
}

} // namespace supercircle::experiment
