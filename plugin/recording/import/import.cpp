#include "plugin/recording/import/import.h"

#include "plugin/recording/import/free_run.h"
#include "plugin/recording/import/plausibility.h"

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/table/csv.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

constexpr double kZeroWindow = 0.5; ///< s, by the convention of the recordings

/// White noise from second differences (median: jumps do not count).
double whiteNoise(const std::vector<double>& f) {
    std::vector<double> bends;
    for (std::size_t i = 1; i + 1 < f.size(); ++i)
        if (const double b = std::abs(f[i - 1] - 2.0 * f[i] + f[i + 1]); std::isfinite(b))
            bends.push_back(b);
    if (bends.size() < 10)
        return 0.0;
    return 1.4826 * upperMedian(std::move(bends)) / std::sqrt(6.0);
}

double meanOf(const std::vector<double>& values, std::size_t n) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < n; ++i)
        if (std::isfinite(values[i])) {
            sum += values[i];
            count += 1.0;
        }
    return count > 0.0 ? sum / count : 0.0;
}

/// First contact: the force exceeds 5 sigma and 1 % of its range in three consecutive rows.
std::size_t touchRow(const ImportedRun& run, const std::vector<double>& f, double rest) {
    double least = 0.0;
    for (const double v : f)
        least = std::isfinite(v) ? std::max(least, std::abs(v - rest)) : least;
    const double level = std::max(5.0 * run.forceNoise, 0.01 * least);
    std::size_t in = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        in = std::abs(f[i] - rest) > level ? in + 1 : 0;
        if (in == 3)
            return i - 2;
    }
    return f.size();
}

/// The force before first contact is the zero, if there are enough rows.
void zeroForce(ImportedRun& run) {
    std::vector<double>* force = run.signals.find(Quantity::Force);
    const std::vector<double>* time = run.signals.find(Quantity::Time);
    if (force == nullptr)
        return;
    std::vector<double>& f = *force;
    run.forceNoise = whiteNoise(f);
    const std::size_t few = std::min<std::size_t>(f.size(), 5);
    const std::size_t firstContact = touchRow(run, f, meanOf(f, few));
    if (const std::vector<double>* d = run.signals.find(Quantity::Displacement))
        run.firstContact = firstContact < d->size() ? (*d)[firstContact] : std::numeric_limits<double>::quiet_NaN();
    std::size_t rows = 0;
    while (rows < firstContact && (*time)[rows] < kZeroWindow - 1e-9)
        ++rows;
    if (rows < 5 || rows == firstContact) {
        run.remarks.push_back(
            {Kind::Assumed, run.signals.line.front(),
             "first contact is within the first 0.5 s, or rows are too few there: the zero of the force "
             "is that of the machine"});
        return;
    }
    run.forceZeroWindow = kZeroWindow;
    run.forceZero = meanOf(f, rows);
    for (double& v : f)
        v -= run.forceZero;
    run.remarks.push_back({Kind::Corrected, run.signals.line.front(),
                           "the mean force of the first 0.5 s, " + shown(run.forceZero) + " N, is taken as zero"});
}

void findMotion(ImportedRun& run, const Hints& hints) {
    const std::vector<double>& time = *run.signals.find(Quantity::Time);
    run.rate = 1.0 / experiment::medianStep(time);
    std::size_t gaps = 0, firstGap = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
        if (time[i] - time[i - 1] > 3.5 / run.rate) {
            firstGap = gaps++ == 0 ? i : firstGap;
        }
    if (gaps > 0)
        run.remarks.push_back({Kind::Understood, run.signals.line[firstGap],
                               std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") +
                                   " in the samples, the first after " + shown(time[firstGap - 1]) + " s"});
    const std::vector<double>* d = run.signals.find(Quantity::Displacement);
    if (d == nullptr)
        return;
    const auto known = std::count_if(d->begin(), d->end(), [](double v) { return std::isfinite(v); });
    if (known < 2)
        return;
    run.drive = findDrive(time, *d, hints.driveTolerance);
    run.remarks.push_back({Kind::Understood, 0,
                           "the crosshead moves along " + std::to_string(run.drive.time.size() - 1) +
                               (run.drive.time.size() == 2 ? " linear segment" : " linear segments") +
                               "; samples are at most " + shown(std::max(1e6 * run.drive.largestDistance, 1e-3)) +
                               " um off (tolerance " + shown(1e6 * run.drive.tolerance) + " um)"});
    if (run.drive.time.size() > 200)
        run.remarks.push_back(
            {Kind::Assumed, 0, "this number of segments is unlikely: the displacement may be noisy (--tolerance)"});
}

/// Channels that a run's own file holds, and those that go to the file of markers.
bool isMarker(const Channel& c) {
    return c.quantity == Quantity::MarkerX || c.quantity == Quantity::MarkerY;
}

Signals select(const Signals& from, bool markers) {
    Signals t = from;
    t.channels.clear();
    for (const Channel& c : from.channels)
        if (c.quantity == Quantity::Time || isMarker(c) == markers)
            t.channels.push_back(c);
    return t;
}

bool measures(const Signals& t, Quantity q) {
    return t.find(q) != nullptr;
}

/// A message about a file: "FILE:LINE:COLUMN: ..." or "FILE: ...".
std::string about(const std::string& file, const std::string& why) {
    const bool placed = !why.empty() && why[0] >= '0' && why[0] <= '9' && why.find(':') < 12;
    return file + (placed ? ":" : ": ") + why;
}

Status addMarkers(Signals&& part, Imported& all) {
    const std::string here = std::to_string(part.line.front()) + ":1: ";
    if (all.runs.empty())
        return Status::failure(here +
                               "positions of markers without a force before them; expected the file of the run first");
    if (!all.runs.back().markers.channels.empty())
        return Status::failure(
            here + "these are markers again, but the run before already has markers; expected the file of a run");
    ImportedRun& run = all.runs.back();
    std::vector<double>& time = *part.find(Quantity::Time);
    const double shift = part.clockStart - run.signals.clockStart, end = run.signals.find(Quantity::Time)->back();
    const double slack = 1.0 / run.rate;
    if (time.front() + shift >= -slack && time.back() + shift <= end + slack) {
        for (double& t : time)
            t += shift;
    } else {
        run.remarks.push_back({Kind::Assumed, 0,
                               "the clock of its markers, from " + shown(part.clockStart) +
                                   " s on, is not that of the run" + ", from " + shown(run.signals.clockStart) +
                                   " s on: both are taken to start together"});
        if (time.back() > end + slack)
            run.remarks.push_back(
                {Kind::Doubtful, 0, "the markers last " + shown(time.back()) + " s, the run " + shown(end) + " s"});
    }
    run.markers = std::move(part);
    return {};
}

/// One run of a file.
Status addRun(Signals&& part, std::size_t source, const Table& table, std::size_t runsOfFile, const Hints& hints,
              Imported& all) {
    ImportedRun run;
    run.source = source;
    if (Status plausible = checkPlausible(part); !plausible)
        return plausible;
    const bool clock = measures(part, Quantity::Time);
    if (!clock)
        repairCounter(part, run.remarks); // times derived from travel need the original travel
    if (Status repaired = repairTime(part, hints, table.layout.metadata, run.remarks); !repaired)
        return repaired;
    if (clock)
        repairCounter(part, run.remarks);
    if (measures(part, Quantity::Angle) && !measures(part, Quantity::Force)) {
        if (hints.fromTurningPoint > 0)
            cutToTurningPoint(part, hints.fromTurningPoint, run.remarks);
        average(part, hints.average, run.remarks);
        if (part.rows() < 10)
            return Status::failure("1:1: fewer than ten rows are left of a run");
    }
    orient(part, hints, run.remarks);
    run.markers = select(part, true);
    if (run.markers.channels.size() < 2)
        run.markers = {};
    part.channels.erase(std::remove_if(part.channels.begin(), part.channels.end(), isMarker), part.channels.end());
    run.signals = std::move(part);
    findMotion(run, hints);
    zeroForce(run);
    addDoubts(run, table, runsOfFile);
    all.runs.push_back(std::move(run));
    return {};
}

Status checkColumns(const Signals& t, const Layout& l) {
    const std::string here = std::to_string(l.namesLine > 0 ? l.namesLine : l.firstDataLine) + ":1: ";
    if (!measures(t, Quantity::Force) && !measures(t, Quantity::Angle))
        return Status::failure(here + "there is neither a force nor an angle; name the columns with --columns " +
                               exampleOfColumns(l.columns));
    if (measures(t, Quantity::Force) && !measures(t, Quantity::Displacement))
        return Status::failure(
            here + "there is a force but no displacement; expected both, or name the column with --columns " +
            exampleOfColumns(l.columns));
    return {};
}

/// Runs of one file are added; a file of markers alone goes to the last run.
Status addFile(const std::string& file, const Hints& hints, Imported& all) {
    const auto failed = [&](const std::string& why) { return Status::failure(about(file, why)); };
    if (std::any_of(all.sources.begin(), all.sources.end(), [&](const Source& s) { return s.file == file; }))
        return failed("this file is given twice");
    auto bytes = record::readText(file);
    if (!bytes)
        return Status::failure(bytes.error());
    Source source;
    source.file = file;
    {
        auto text = decode(*std::move(bytes));
        if (!text)
            return failed(text.error());
        auto read = readTable(*text, hints);
        if (!read)
            return failed(read.error());
        source.text = {{}, text->encoding, text->lineEnds};
        source.table = *std::move(read);
    }
    Signals whole = std::move(source.table.signals);
    source.rows = whole.rows();
    const std::size_t index = all.sources.size();
    const bool onlyMarkers = !measures(whole, Quantity::Force) && !measures(whole, Quantity::Angle) &&
                             std::any_of(whole.channels.begin(), whole.channels.end(), isMarker);
    if (!onlyMarkers)
        if (const Status complete = checkColumns(whole, source.table.layout); !complete)
            return failed(complete.error());
    std::vector<Signals> parts = splitRuns(std::move(whole), source.table.remarks);
    for (Signals& part : parts) {
        Status added;
        if (onlyMarkers) {
            added = repairTime(part, hints, source.table.layout.metadata, source.table.remarks);
            if (added)
                added = addMarkers(std::move(part), all);
        } else {
            added = addRun(std::move(part), index, source.table, parts.size(), hints, all);
        }
        if (!added)
            return failed(added.error());
    }
    all.sources.push_back(std::move(source));
    return {};
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
    std::vector<double> out(values);
    for (double& v : out)
        v *= factor;
    return out;
}

record::Series tableOf(const ImportedRun& run) {
    record::Series s;
    s.names = {"time_s"};
    s.columns = {*run.signals.find(Quantity::Time)};
    const auto add = [&](const char* name, Quantity q, double factor) {
        if (const std::vector<double>* v = run.signals.find(q)) {
            s.names.emplace_back(name);
            s.columns.push_back(scaled(*v, factor));
        }
    };
    add("displacement_mm", Quantity::Displacement, 1e3);
    add("force_N", Quantity::Force, 1.0);
    add("angle_deg", Quantity::Angle, 180.0 / M_PI);
    return s;
}

record::Series markersOf(const ImportedRun& run) {
    record::Series s;
    s.names = {"time_s"};
    s.columns = {*run.markers.find(Quantity::Time)};
    for (const Channel& c : run.markers.channels)
        if (isMarker(c)) {
            s.names.push_back(c.marker + (c.quantity == Quantity::MarkerX ? "_x_mm" : "_y_mm"));
            s.columns.push_back(scaled(c.values, 1e3));
        }
    return s;
}

/// Markers of which both coordinates are there, in the order of the file.
void nameMarkers(Imported& all) {
    std::set<std::string> seen;
    for (ImportedRun& run : all.runs) {
        std::set<std::string> xs, ys;
        for (const Channel& c : run.markers.channels)
            (c.quantity == Quantity::MarkerX ? xs : ys).insert(c.quantity == Quantity::Time ? "" : c.marker);
        std::vector<Channel> whole;
        for (Channel& c : run.markers.channels)
            if (c.quantity == Quantity::Time || (xs.count(c.marker) > 0 && ys.count(c.marker) > 0))
                whole.push_back(std::move(c));
            else
                run.remarks.push_back({Kind::Omitted, 0, "marker " + c.marker + " has only one coordinate"});
        run.markers.channels = std::move(whole);
        for (const Channel& c : run.markers.channels)
            if (c.quantity == Quantity::MarkerX && seen.insert(c.marker).second)
                all.markerNames.push_back(c.marker);
    }
}

std::string atLine(const Remark& r) {
    return r.line > 0 ? "line " + std::to_string(r.line) + ": " : "";
}

void write(std::string& out, const std::vector<Remark>& remarks) {
    for (const Kind kind : {Kind::Understood, Kind::Assumed, Kind::Doubtful, Kind::Corrected, Kind::Omitted})
        for (const Remark& r : remarks)
            if (r.kind == kind)
                out += "  " + std::string(word(kind)) + std::string(11 - std::string(word(kind)).size(), ' ') +
                       atLine(r) + r.what + "\n";
}

} // namespace

Result<Imported> readExports(const std::vector<std::string>& files, const Hints& hints) {
    Imported all;
    for (const std::string& file : files)
        if (const Status added = addFile(file, hints, all); !added)
            return Result<Imported>::failure(added.error());
    nameMarkers(all);
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        ImportedRun& run = all.runs[k];
        run.file = "run_" + std::to_string(k + 1) + ".csv";
        if (run.markers.channels.size() > 2)
            run.markersFile = "run_" + std::to_string(k + 1) + "_markers.csv";
    }
    return all;
}

std::string account(const Imported& all) {
    std::string out;
    for (std::size_t i = 0; i < all.sources.size(); ++i) {
        const Source& s = all.sources[i];
        out += s.file + ": " + std::to_string(s.rows) + " rows\n";
        write(out, s.table.remarks);
        for (const HeaderEntry& m : s.table.layout.metadata)
            out += "  header     line " + std::to_string(m.line) + ": " + m.key +
                   (m.value.empty() ? "" : ": " + m.value) + "\n";
        for (const ImportedRun& run : all.runs) {
            if (run.source != i)
                continue;
            const std::vector<double>& t = *run.signals.find(Quantity::Time);
            out += " -> " + run.file + ": " + std::to_string(t.size()) + " rows, " + shown(t.back() - t.front()) +
                   " s at " + shown(run.rate) + " Hz\n";
            write(out, run.remarks);
        }
    }
    return out;
}

Result<std::vector<record::NamedText>> runFiles(const Imported& all) {
    using Files = Result<std::vector<record::NamedText>>;
    std::vector<record::NamedText> files;
    for (const ImportedRun& run : all.runs) {
        auto text = record::csvText(tableOf(run));
        if (!text)
            return Files::failure(text.error());
        files.emplace_back(run.file, *std::move(text));
        if (run.markersFile.empty())
            continue;
        auto markers = record::csvText(markersOf(run));
        if (!markers)
            return Files::failure(markers.error());
        files.emplace_back(run.markersFile, *std::move(markers));
    }
    return files;
}

} // namespace supercircle::importing
