#include "plugin/recording/experiment/recording_quality.h"

#include "plugin/recording/experiment/natural_units.h"
#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace supercircle::experiment {

std::string shown(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", v);
    return text;
}

double commanded(const Run& run, double t) {
    const auto after = std::upper_bound(run.driveTime.begin() + 1, run.driveTime.end() - 1, t);
    const std::size_t i = static_cast<std::size_t>(after - run.driveTime.begin());
    const double share = std::clamp((t - run.driveTime[i - 1]) / (run.driveTime[i] - run.driveTime[i - 1]), 0.0, 1.0);
    return (1.0 - share) * run.driveDisplacement[i - 1] + share * run.driveDisplacement[i];
}

double medianStep(const std::vector<double>& time) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i)
        steps.push_back(time[i] - time[i - 1]);
    return upperMedian(std::move(steps));
}

namespace {

using scene::Problem;

/// Position of a row for messages.
class Place {
public:
    Place(const std::string& path, std::vector<Problem>& problems) : path_(path), problems_(problems) {}

    void error(const std::string& what, const std::string& expected = {}) { report(what, expected, 0); }
    void errorAt(std::size_t row, const std::string& what, const std::string& expected = {}) {
        const auto text = record::readText(path_);
        report(what, expected, text ? static_cast<int>(record::lineOfRow(*text, row)) : 0);
    }
    void note(const std::string& what) {
        report(what, {}, 0);
        problems_.back().severity = Problem::Severity::Note;
    }

private:
    void report(const std::string& what, const std::string& expected, int line) {
        Problem p;
        p.file = path_;
        p.line = line;
        p.column = line > 0 ? 1 : 0;
        p.what = what;
        p.expected = expected;
        problems_.push_back(std::move(p));
    }
    const std::string& path_;
    std::vector<Problem>& problems_;
};

/// Increasing and finite, at least two.
bool goodTimes(const std::vector<double>& time, Place& place) {
    if (time.empty())
        place.error("the file has a header and no rows", "at least two rows");
    else if (time.size() < 2)
        place.error("the file has one row", "at least two");
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (!std::isfinite(time[i])) {
            place.errorAt(i, "time_s of row " + std::to_string(i + 1) + " is missing", "a time in every row");
            return false;
        }
        if (i == 0 || time[i] > time[i - 1])
            continue;
        place.errorAt(i,
                      "time_s of row " + std::to_string(i + 1) + " (" + shown(time[i]) +
                          ") is not later than that of the row before it (" + shown(time[i - 1]) + ")",
                      "increasing times; `supercircle import` repairs clocks that were set back");
        return false;
    }
    return time.size() >= 2;
}

/// Samples outside the drive cannot be replayed.
bool insideDrive(const std::vector<double>& time, const Run& run, Place& place) {
    const double slack = (1e-6 + 0.5) / run.samplingRate;
    for (std::size_t i = 0; i < time.size(); ++i)
        if (time[i] < run.driveTime.front() - slack || time[i] > run.driveTime.back() + slack) {
            place.errorAt(i, "the samples reach beyond drive_time_s",
                          "times from " + shown(run.driveTime.front()) + " s to " + shown(run.driveTime.back()) + " s");
            return false;
        }
    return true;
}

std::size_t missing(const std::vector<double>& values) {
    return static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }));
}

/// Smallest and largest existing value.
std::array<double, 2> range(const std::vector<double>& values) {
    std::array<double, 2> r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double v : values)
        if (std::isfinite(v))
            r = {std::min(r[0], v), std::max(r[1], v)};
    return r;
}

std::string rowsOf(std::size_t n, std::size_t all) {
    return std::to_string(n) + " of " + std::to_string(all);
}

/// "missing", or "missing or infinite"
std::string goneWord(const std::vector<double>& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return std::isinf(v); }) ? "missing or infinite"
                                                                                             : "missing";
}

bool goodForce(std::vector<double>& force, const Channel& channel, Place& place) {
    const std::string column = channel.column;
    const std::string word = goneWord(force);
    const std::size_t gone = missing(force), rows = force.size();
    for (double& f : force)
        if (!std::isfinite(f))
            f = std::numeric_limits<double>::quiet_NaN();
    if (2 * gone > rows) {
        place.error(rowsOf(gone, rows) + " values of " + column + " are missing", "at least half of them");
        return false;
    }
    const auto [least, most] = range(force);
    if (least == most) {
        place.error(column + " is " + shown(channel.perUnit * most) + " in every row",
                    column == "force_N" ? "a force that changes; is the load cell connected, and this its column?"
                                        : "a pose that changes; is the sensor connected, and this its column?");
        return false;
    }
    if (gone > 0)
        place.note(rowsOf(gone, rows) + " values of " + column + " are " + word + "; these rows are ignored");
    return true;
}

/// The unit that explains a constant factor between `small` and `large`.
const char* unitOf(double factor) {
    constexpr std::array<std::pair<double, const char*>, 5> kUnits = {{{1e3, "metres"},
                                                                       {25.4, "inches"},
                                                                       {10.0, "centimetres"},
                                                                       {1e-3, "micrometres"},
                                                                       {0.0254, "thousandths of an inch"}}};
    for (const auto& [size, name] : kUnits)
        if (std::abs(factor / size - 1.0) < 0.03)
            return name;
    return nullptr;
}

/// Best factor from recorded to commanded displacement, and the remaining difference.
struct Scaling {
    double factor = 1.0;
    double rest = 0.0;    ///< rms after scaling, m
    double largest = 0.0; ///< without scaling, m
    std::size_t largestRow = 0;
};

Scaling scaling(const Run& run) {
    Scaling s;
    double yy = 0.0, xy = 0.0, xx = 0.0, n = 0.0;
    const Readings& r = run.readings;
    for (std::size_t i = 0; i < r.time.size(); ++i) {
        if (!std::isfinite(r.displacement[i]))
            continue;
        const double want = commanded(run, r.time[i]), have = r.displacement[i];
        yy += want * want;
        xy += want * have;
        xx += have * have;
        n += 1.0;
        if (std::abs(have - want) > s.largest) {
            s.largest = std::abs(have - want);
            s.largestRow = i;
        }
    }
    s.factor = xx > 0.0 ? xy / xx : 1.0;
    s.rest = n > 0.0 ? std::sqrt(std::max(0.0, yy - xy * s.factor) / n) : 0.0;
    return s;
}

/// @param natural unit of length of the set-up, m
bool goodDisplacement(Run& run, double natural, Place& place) {
    Readings& r = run.readings;
    const auto [from, to] = std::minmax_element(run.driveDisplacement.begin(), run.driveDisplacement.end());
    const double travel = *to - *from;
    const std::size_t gone = missing(r.displacement), rows = r.displacement.size();
    const auto [least, most] = range(r.displacement);
    if (gone < rows && travel > 0.0 && most == least) {
        place.error("displacement_mm is " + shown(1e3 * most) +
                        " in every row, though drive_displacement_mm moves by " + shown(1e3 * travel) + " mm",
                    "the displacement of the crosshead");
        return false;
    }
    if (gone > 0)
        place.note(rowsOf(gone, rows) + " values of displacement_mm are " + goneWord(r.displacement) +
                   "; the commanded motion is used instead");
    if (gone == rows || travel == 0.0) {
        for (std::size_t i = 0; i < rows; ++i)
            r.displacement[i] = std::isfinite(r.displacement[i]) ? r.displacement[i] : commanded(run, r.time[i]);
        return true;
    }
    const Scaling s = scaling(run);
    if (const char* unit = unitOf(s.factor); unit != nullptr && s.rest < 0.05 * travel) {
        place.error("displacement_mm is " + shown(1.0 / s.factor) +
                        " times drive_displacement_mm: it appears to be in " + unit,
                    "millimetres in both");
        return false;
    }
    if (std::abs(s.factor + 1.0) < 0.03 && s.rest < 0.05 * travel) {
        place.error("displacement_mm runs against drive_displacement_mm",
                    "the same sign in both: positive when the crosshead moves down");
        return false;
    }
    const std::string where = "displacement_mm is " + shown(1e3 * s.largest) + " mm off the commanded motion at " +
                              shown(r.time[s.largestRow]) + " s (" + shown(1e3 * r.displacement[s.largestRow]) +
                              " mm, commanded " + shown(1e3 * commanded(run, r.time[s.largestRow])) + " mm)";
    if (s.largest > 0.05 * travel + 5e-5 * natural) {
        place.errorAt(s.largestRow, where, "drive_time_s and drive_displacement_mm as the machine did it");
        return false;
    }
    if (s.largest > 0.005 * travel + 1e-5 * natural)
        place.note(where + "; the commanded motion is simulated");
    for (std::size_t i = 0; i < rows; ++i)
        if (!std::isfinite(r.displacement[i]))
            r.displacement[i] = commanded(run, r.time[i]);
    return true;
}

/// White noise from second differences before the first motion, N; 0: unknown.
double noiseAtRest(const Run& run) {
    double sum = 0.0, n = 0.0;
    const Readings& r = run.readings;
    const double until = run.driveDisplacement[0] == run.driveDisplacement[1] ? run.driveTime[1] : run.driveTime[0];
    for (std::size_t i = 2; i < r.time.size() && r.time[i] < until; ++i)
        if (const double d = r.force[i] - 2.0 * r.force[i - 1] + r.force[i - 2]; std::isfinite(d)) {
            sum += d * d / 6.0;
            n += 1.0;
        }
    return n >= 10.0 ? std::sqrt(sum / n) : 0.0;
}

/// The largest force is in one row with unrelated neighbours: a glitch.
bool aloneIn(const std::vector<double>& force, double peak, Place& place) {
    const auto at = std::find_if(force.begin(), force.end(), [&](double f) { return std::abs(f) == peak; });
    const auto quiet = [&](double f) { return !(std::abs(f) > 0.01 * peak); };
    if (!std::all_of(force.begin(), at, quiet) || !std::all_of(at + 1, force.end(), quiet))
        return false;
    place.errorAt(static_cast<std::size_t>(at - force.begin()),
                  "force_N is " + shown(*at) + " in this row, and below a hundredth of it in all others",
                  "a reading, or an empty cell where there is none");
    return true;
}

/// At first contact a specimen resists.
void judgeSign(const Run& run, Place& place) {
    const std::vector<double>& f = run.readings.force;
    const auto [least, most] = range(f);
    const double level = 0.2 * (most - least), rest = std::isfinite(f.front()) ? f.front() : 0.0;
    const auto touch = std::find_if(f.begin(), f.end(), [&](double v) { return std::abs(v - rest) > level; });
    if (touch != f.end() && *touch < rest)
        place.note("force_N falls first, to " + shown(*touch) + " N at " +
                   shown(run.readings.time[static_cast<std::size_t>(touch - f.begin())]) +
                   " s; it is positive while the specimen resists: is its sign wrong?");
}

/// Intervals of the drive without samples.
void judgeCoverage(const Run& run, Place& place) {
    const std::vector<double>& t = run.readings.time;
    const double step = 1.0 / run.samplingRate, from = run.driveTime.front(), to = run.driveTime.back(),
                 slack = std::max(3.5 * step, 0.02 * (to - from));
    if (t.front() > from + slack || t.back() < to - slack)
        place.note("there are samples from " + shown(t.front()) + " to " + shown(t.back()) + " s of a motion from " +
                   shown(from) + " to " + shown(to) + " s; the rest is not compared");
    std::size_t gaps = 0, longest = 1;
    for (std::size_t i = 1; i < t.size(); ++i) {
        gaps += t[i] - t[i - 1] > 3.5 * step ? 1 : 0;
        longest = t[i] - t[i - 1] > t[longest] - t[longest - 1] ? i : longest;
    }
    if (gaps > 0)
        place.note(std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") + " in the samples, the longest from " +
                   shown(t[longest - 1]) + " to " + shown(t[longest]) + " s; nothing is compared there");
}

/// Force unit wrong by a factor of a thousand. Neither the scale of bending forces nor the stated noise is proof alone:
/// an error needs both.
void judgeForceUnit(const Experiment& e, const Run& run, Place& place) {
    const Specimen& s = e.specimens.front();
    const double length = std::max(std::abs(s.naturalCurvature.value), M_PI / s.length);
    const double scale = s.bendingModulus.value * length * length;
    const auto [least, most] = range(run.readings.force);
    const double peak = std::max(std::abs(least), std::abs(most));
    const double noise = noiseAtRest(run), stated = e.sensors.forceNoise;
    const double ratio = noise > 0.0 && stated > 0.0 ? noise / stated : 0.0;
    const bool small = peak<5e-3 * scale, large = peak> 2e3 * scale;
    if (large && aloneIn(run.readings.force, peak, place))
        return;
    if (!small && !large) {
        if (peak > 20.0 * scale && ratio > 3e2 && ratio < 3e3)
            place.note("the noise of force_N is " + shown(ratio) + " times the stated one; is it in millinewtons?");
        return;
    }
    const bool confirmed = small ? ratio > 1e-4 && ratio < 1e-2 : ratio > 1e2 && ratio < 1e4;
    const std::string what = "the largest force, " + shown(peak) + " N, is " + shown(peak / scale) +
                             " times the scale of bending forces, " + shown(scale) + " N";
    if (confirmed && !e.sensors.forceUnitConfirmed)
        place.error(what + ", and its noise " + shown(ratio) + " times the stated one: it appears to be in " +
                        (small ? "kilonewtons" : "millinewtons"),
                    "force_N in newtons; if it is, state \"force_unit_confirmed\": true in /sensors (import: --accept "
                    "units)");
    else
        place.note(what + (small ? "; is it in kilonewtons?" : "; is it in millinewtons?"));
}

/// Averages blocks of rows.
std::vector<double> blockMeans(const std::vector<double>& values, std::size_t block) {
    std::vector<double> means;
    means.reserve(values.size() / block + 1);
    for (std::size_t i = 0; i < values.size(); i += block) {
        double sum = 0.0, n = 0.0;
        for (std::size_t k = i; k < std::min(i + block, values.size()); ++k)
            if (std::isfinite(values[k])) {
                sum += values[k];
                n += 1.0;
            }
        means.push_back(n > 0.0 ? sum / n : std::numeric_limits<double>::quiet_NaN());
    }
    return means;
}

void thin(Run& run, Place& place) {
    Readings& r = run.readings;
    const std::size_t rows = r.time.size();
    if (rows <= maxRows)
        return;
    const std::size_t block = (rows + maxRows - 1) / maxRows;
    for (std::vector<double>* column : {&r.time, &r.displacement, &r.force})
        *column = blockMeans(*column, block);
    for (std::vector<double>& column : r.further)
        column = blockMeans(column, block);
    run.samplingRate /= static_cast<double>(block);
    place.note(std::to_string(rows) + " rows are more than a simulation resolves: blocks of " + std::to_string(block) +
               " are averaged, which leaves " + std::to_string(r.time.size()) + " at " + shown(run.samplingRate) +
               " Hz");
}

void judgeRate(Run& run, Place& place) {
    const double rate = 1.0 / medianStep(run.readings.time);
    if (std::abs(rate / run.samplingRate - 1.0) < 0.02)
        return;
    place.note("sampling_hz says " + shown(run.samplingRate) + " Hz, the times of the rows " + shown(rate) +
               " Hz; the latter is taken");
    run.samplingRate = rate;
}

} // namespace

void checkReadings(const Experiment& e, Run& run, const std::string& path, std::vector<Problem>& problems) {
    Place place(path, problems);
    if (!goodTimes(run.readings.time, place) || !insideDrive(run.readings.time, run, place))
        return;
    if (!goodForce(run.readings.force, channel(e), place) || !goodDisplacement(run, unitsOfSpecimens(e).length, place))
        return;
    for (std::size_t k = 0; k < run.readings.further.size(); ++k)
        if (!goodForce(run.readings.further[k], furtherChannels(e)[k].channel, place))
            return;
    judgeRate(run, place);
    judgeCoverage(run, place);
    if (!e.scene) {
        judgeForceUnit(e, run, place);
        judgeSign(run, place);
    }
    thin(run, place);
}

void checkTracks(const Experiment& e, Run& run, const std::string& path, std::vector<Problem>& problems) {
    Place place(path, problems);
    if (!goodTimes(run.markers.time, place) || !insideDrive(run.markers.time, run, place))
        return;
    double length = 0.0, most = 0.0;
    for (const Specimen& s : e.specimens)
        length = std::max(length, s.length);
    if (e.scene)
        return;
    for (const auto* axis : {&run.markers.x, &run.markers.y})
        for (const std::vector<double>& track : *axis)
            if (const auto [lo, hi] = range(track); hi >= lo)
                most = std::max({most, std::abs(lo), std::abs(hi)});
    if (most == 0.0)
        place.error("every position of a marker is missing or 0", "positions in millimetres");
    else if (most < 0.01 * length)
        place.error("markers are at most " + shown(1e3 * most) + " mm from the origin, with a specimen of " +
                        shown(1e3 * length) + " mm: they appear to be in metres",
                    "millimetres");
    else if (most > 100.0 * length)
        place.error("markers are up to " + shown(1e3 * most) + " mm from the origin, with a specimen of " +
                        shown(1e3 * length) + " mm",
                    "millimetres");
}

} // namespace supercircle::experiment
