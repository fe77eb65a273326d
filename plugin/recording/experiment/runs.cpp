// The CSV files of the runs.

#include "plugin/recording/experiment/free_scene.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/experiment/natural_units.h"
#include "plugin/recording/experiment/recording_quality.h"
#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>

namespace supercircle::experiment {

namespace {

namespace fs = std::filesystem;

/// The message of the reader begins with file:line:column.
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

/// Fails for a file of another kind.
Status checkForm(const std::string& text) {
    const std::string import = "; `supercircle import` reads exports of other forms";
    if (text.find('\0') != std::string::npos)
        return Status::failure(":1:1: there are zero bytes in it: UTF-16, or no text; expected CSV in UTF-8" + import);
    if (text.find('\n') == std::string::npos && text.find('\r') != std::string::npos)
        return Status::failure(":1:1: its lines end with a carriage return alone; expected LF or CRLF" + import);
    const std::string head = text.substr(0, std::min(text.find('\n'), text.size()));
    const auto strange = std::find_if(head.begin(), head.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r';
    });
    if (strange != head.end())
        return Status::failure(":1:" + std::to_string(strange - head.begin() + 1) +
                               ": a control character; expected names of columns");
    if (head.find(',') == std::string::npos && head.find_first_of(";\t") != std::string::npos)
        return Status::failure(":1:1: cells are separated by " +
                               std::string(head.find(';') != std::string::npos ? "semicolons" : "tabs") +
                               "; expected commas" + import);
    return {};
}

Result<record::Series> readTable(const std::string& path, const record::CsvOptions& options) {
    const auto text = record::readText(path);
    if (!text)
        return Result<record::Series>::failure(text.error());
    if (const Status usual = checkForm(*text); !usual)
        return Result<record::Series>::failure(path + usual.error());
    return record::parseCsv(*text, path, options);
}

/// Rows that are not compared count as missing.
void ignoreRows(Run& run) {
    for (std::size_t i = 0; i < run.readings.force.size(); ++i)
        for (const auto& [from, to] : run.ignored)
            if (run.readings.time[i] + run.start >= from && run.readings.time[i] + run.start <= to) {
                run.readings.force[i] = std::numeric_limits<double>::quiet_NaN();
                for (std::vector<double>& column : run.readings.further)
                    column[i] = std::numeric_limits<double>::quiet_NaN();
            }
}

void readReadings(const Experiment& e, Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
    record::CsvOptions options;
    options.required = {"time_s", "displacement_mm", "force_N"};
    const auto csv = readTable(path, options);
    if (!csv) {
        reportCsv(problems, path, csv.error());
        return;
    }
    run.readings.time = *csv->find("time_s");
    run.readings.displacement = scaled(*csv->find("displacement_mm"), 1e-3);
    run.readings.force = *csv->find("force_N");
    checkReadings(e, run, path, problems);
    ignoreRows(run);
}

/// The drive of a scene's run from a column: break points between which it is straight to 1e-4 of its range, a
/// twentieth of what machines resolve. Half of it makes 1.4 times the break points.
void takeDrive(Run& run, const std::vector<double>& value) {
    constexpr double kStraight = 1e-4;
    const std::vector<double>& time = run.readings.time;
    if (!std::is_sorted(time.begin(), time.end(), std::less_equal<>()))
        return; // checkReadings says where
    run.driveTime.clear();
    run.driveDisplacement.clear();
    std::vector<std::size_t> known; // rows with a reading
    for (std::size_t i = 0; i < time.size(); ++i)
        if (std::isfinite(value[i]))
            known.push_back(i);
    if (known.size() < 2)
        return;
    const auto [lo, hi] = std::minmax_element(known.begin(), known.end(),
                                              [&](std::size_t a, std::size_t b) { return value[a] < value[b]; });
    const double most = kStraight * (value[*hi] - value[*lo]);
    std::vector<bool> kept(known.size(), false);
    kept.front() = kept.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, known.size() - 1}};
    while (!open.empty()) {
        const auto [a, b] = open.back();
        open.pop_back();
        const double slope = (value[known[b]] - value[known[a]]) / (time[known[b]] - time[known[a]]);
        std::size_t at = a;
        double farthest = most;
        for (std::size_t i = a + 1; i < b; ++i)
            if (const double off =
                    std::abs(value[known[i]] - value[known[a]] - slope * (time[known[i]] - time[known[a]]));
                off > farthest) {
                farthest = off;
                at = i;
            }
        if (at == a)
            continue;
        kept[at] = true;
        open.emplace_back(a, at);
        open.emplace_back(at, b);
    }
    for (std::size_t i = 0; i < known.size(); ++i)
        if (kept[i]) {
            run.driveTime.push_back(time[known[i]]);
            run.driveDisplacement.push_back(value[known[i]]);
        }
}

/// The rows of a scene's run from its start on, with what the description leaves to them.
void beginAtStart(Run& run) {
    Readings& r = run.readings;
    const auto first =
        static_cast<std::ptrdiff_t>(std::lower_bound(r.time.begin(), r.time.end(), run.start - 1e-9) - r.time.begin());
    r.time.erase(r.time.begin(), r.time.begin() + first);
    r.force.erase(r.force.begin(), r.force.begin() + first);
    for (std::vector<double>& column : r.further)
        column.erase(column.begin(), column.begin() + first);
    for (double& t : r.time)
        t = std::max(0.0, t - run.start);
    if (r.time.size() < 2)
        return;
    if (run.samplingRate <= 0.0)
        run.samplingRate = 1.0 / medianStep(r.time);
    if (run.driveDisplacement.empty() && run.driveTime.back() <= 0.0)
        run.driveTime.back() = r.time.back();
}

/// Columns beside the first channel's. @return whether all are there
bool readFurther(const Experiment& e, const record::Series& csv, Run& run, const std::string& path,
                 std::vector<scene::Problem>& problems) {
    for (std::size_t k = 0; k < furtherChannels(e).size(); ++k) {
        const Channel& c = furtherChannels(e)[k].channel;
        const std::vector<double>* column = csv.find(c.column);
        if (column == nullptr) {
            reportCsv(problems, path,
                      path + ":1:1: there is no column " + c.column + "; expected what /channels/" +
                          std::to_string(k + 1) + " names");
            return false;
        }
        run.readings.further.push_back(scaled(*column, c.sign / c.perUnit));
    }
    return true;
}

/// Gives a table of states of rest a clock of equal steps, and drives it through all of its rows.
/// @param drive its column, as written
void takeTable(const Experiment& e, Run& run, const std::vector<double>& drive) {
    // Natural s between rows. Half moves readings of a strip that is unloaded from 0.81 of its length by 1e-9 of the
    // largest and saves a third of the steps, a quarter by 3.5e-4. Double costs half as much again.
    constexpr double kRow = 8.0;
    const double step = kRow * unitsOfSpecimens(e).settling;
    for (std::size_t i = 0; i < drive.size(); ++i)
        run.readings.time.push_back(step * static_cast<double>(i));
    run.samplingRate = 1.0 / step;
    run.driveTime = run.readings.time;
    run.driveDisplacement = scaled(drive, e.scene->driveScale);
}

/// Whether a file without times is a table of states of rest, and not a mistake.
bool goodTable(const Experiment& e, const Run& run, const record::Series& csv, const std::string& path,
               std::vector<scene::Problem>& problems) {
    constexpr std::size_t kFewest = 6;
    const auto refuse = [&](const std::string& what, std::size_t line = 1) {
        reportCsv(problems, path, path + ":" + std::to_string(line) + ":1: " + what);
        return false;
    };
    const std::vector<double>* drive = csv.find(e.scene->driveColumn);
    if (e.scene->driveColumn.empty() || !nearestName("time_s", csv.names).empty())
        return refuse("there is no column time_s" + didYouMean("time_s", csv.names) +
                      "; a table of states of rest has no times, but a \"drive\" with a \"column\"");
    if (isMechanism(e))
        return refuse("there is no column time_s; expected one: bodies on joints are simulated in motion, and a table "
                      "has states of rest");
    if (drive == nullptr)
        return refuse("there is no column " + e.scene->driveColumn + "; expected what /drive names");
    if (drive->size() < kFewest)
        return refuse("a table of " + std::to_string(drive->size()) + " rows; expected at least " +
                      std::to_string(kFewest));
    if (run.start != 0.0 || !run.ignored.empty() || !run.markersFile.empty() || run.driveTime.back() > 0.0)
        return refuse("there is no column time_s; without it the run has no clock, and start_s, ignore_s, duration_s, "
                      "drive_time_s and markers_file mean nothing");
    for (std::size_t i = 0; i < drive->size(); ++i)
        if (!std::isfinite((*drive)[i])) {
            const auto text = record::readText(path);
            return refuse(e.scene->driveColumn + " of row " + std::to_string(i + 1) + " is missing; expected a value " +
                              "in every row of a table",
                          text ? record::lineOfRow(*text, i) : 1);
        }
    return true;
}

/// Tells whether the first file is a table; all others must be of the same kind.
bool sameKind(Experiment& e, const Run& run, bool table, const std::string& path,
              std::vector<scene::Problem>& problems) {
    if (&run == &e.runs.front())
        e.scene->table = table;
    if (e.scene->table == table)
        return true;
    reportCsv(problems, path,
              path + ":1:1: it has " + (table ? "no times" : "times") + ", " + e.runs.front().file +
                  (table ? " has" : " has none") + "; tables are an experiment of their own");
    return false;
}

/// A scene's run: times and the columns of its channels.
void readPose(Experiment& e, Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
    auto csv = readTable(path, {});
    if (!csv) {
        reportCsv(problems, path, csv.error());
        return;
    }
    const bool table = csv->find("time_s") == nullptr;
    if ((table && !goodTable(e, run, *csv, path, problems)) || !sameKind(e, run, table, path, problems))
        return;
    std::string wanted;
    for (const Channel& c : columnsOf(e)) {
        wanted += (wanted.empty() ? "" : " or ") + c.column;
        const std::vector<double>* column = csv->find(c.column);
        if (column == nullptr)
            continue;
        run.readings.force = scaled(*column, c.sign / c.perUnit);
        if (!readFurther(e, *csv, run, path, problems))
            return;
        if (table)
            takeTable(e, run, *csv->find(e.scene->driveColumn));
        else
            run.readings.time = *csv->find("time_s");
        if (e.protocol == Protocol::Scene && !table)
            beginAtStart(run);
        if (!e.scene->driveColumn.empty() && !table) {
            const std::vector<double>* drive = csv->find(e.scene->driveColumn);
            if (drive == nullptr) {
                reportCsv(problems, path,
                          path + ":1:1: there is no column " + e.scene->driveColumn + "; expected what /drive names");
                return;
            }
            takeDrive(run, scaled({drive->end() - static_cast<std::ptrdiff_t>(run.readings.time.size()), drive->end()},
                                  e.scene->driveScale));
        }
        if (run.driveDisplacement.empty())
            run.driveDisplacement = {0.0, 0.0};
        run.readings.displacement.clear();
        for (const double t : run.readings.time)
            run.readings.displacement.push_back(commanded(run, t));
        checkReadings(e, run, path, problems);
        ignoreRows(run);
        return;
    }
    reportCsv(problems, path, path + ":1:1: there is no column " + wanted + "; expected what /observed names");
}

void readTracks(const Experiment& e, Run& run, const std::string& path, std::vector<scene::Problem>& problems) {
    record::CsvOptions options;
    options.required = {"time_s"};
    for (const Marker& m : e.markers)
        for (const char* axis : {"_x_mm", "_y_mm"})
            options.required.push_back(m.name + axis);
    const auto csv = readTable(path, options);
    if (!csv) {
        reportCsv(problems, path, csv.error());
        return;
    }
    run.markers.time = *csv->find("time_s");
    for (const Marker& m : e.markers) {
        run.markers.x.push_back(scaled(*csv->find(m.name + "_x_mm"), 1e-3));
        run.markers.y.push_back(scaled(*csv->find(m.name + "_y_mm"), 1e-3));
    }
    checkTracks(e, run, path, problems);
}

} // namespace

void refuseOutside(const Experiment& e, std::vector<scene::Problem>& problems) {
    const auto look = [&](const std::string& file, const std::string& pointer) {
        const fs::path path = fs::path(file).lexically_normal();
        if (file.empty() || (path.is_relative() && *path.begin() != ".."))
            return;
        scene::Problem p;
        p.file = e.file;
        p.pointer = pointer;
        p.what = "\"" + file + "\" lies outside of the experiment's folder";
        p.expected = "a file in it; --allow-outside reads others";
        problems.push_back(std::move(p));
    };
    if (e.scene && !namesShipped(*e.scene))
        look(e.scene->file, "/scene");
    for (std::size_t i = 0; i < e.runs.size(); ++i) {
        look(e.runs[i].file, "/runs/" + std::to_string(i) + "/file");
        look(e.runs[i].markersFile, "/runs/" + std::to_string(i) + "/markers_file");
    }
}

void readRuns(Experiment& experiment, std::vector<scene::Problem>& problems) {
    const fs::path folder = fs::path(experiment.file).parent_path();
    for (Run& run : experiment.runs) {
        const std::string path = (folder / run.file).string();
        if (experiment.scene)
            readPose(experiment, run, path, problems);
        else
            readReadings(experiment, run, path, problems);
        if (!run.markersFile.empty())
            readTracks(experiment, run, (folder / run.markersFile).string(), problems);
    }
}

} // namespace supercircle::experiment
