#include "plugin/recording/import/import.h"

#include "plugin/recording/import/events.h"
#include "plugin/recording/import/force_zero.h"
#include "plugin/recording/import/free_run.h"
#include "plugin/recording/import/plausibility.h"
#include "plugin/recording/import/release_state.h"
#include "plugin/recording/import/velocity.h"
#include "plugin/recording/import/whole.h"

#include "plugin/recording/experiment/experiment.h"
#include "supercircle/support/printable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30; ///< ten million rows have 0.3 GB and take 1 GB of memory

void findMotion(ImportedRun& run, const Hints& hints) {
    const std::vector<double>& time = *run.signals.find(Quantity::Time);
    run.rate = 1.0 / experiment::medianStep(time);
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
                               "; samples are at most " + shownLength(std::max(run.drive.largestDistance, 1e-9)) +
                               " off (tolerance " + shownLength(run.drive.tolerance) + ")"});
    if (run.drive.time.size() > 200)
        run.remarks.push_back(
            {Kind::Assumed, 0, "this number of segments is unlikely: the displacement may be noisy (--tolerance)"});
}

/// Channels that a run's own file holds, or those that go to the file of markers.
Signals select(const Signals& from, bool markers) {
    Signals t = from;
    t.channels.clear();
    for (const Channel& c : from.channels)
        if (c.quantity == Quantity::Time || (isMarker(c) == markers && c.quantity != Quantity::Counter))
            t.channels.push_back(c);
    return t;
}

bool measures(const Signals& t, Quantity q) {
    return t.find(q) != nullptr;
}

/// A message about a file: "FILE:LINE:COLUMN: ..." or "FILE: ...".
std::string about(const std::string& file, const std::string& why) {
    const bool placed = !why.empty() && why[0] >= '0' && why[0] <= '9' && why.find(':') < 12;
    return printable(file + (placed ? ":" : ": ") + why);
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

/// One table of points that were read at rest: order, zeros and signs stay as they are.
Status addTableOfPoints(Signals&& part, ImportedRun&& run, const Table& table, std::size_t runsOfFile,
                        const Hints& hints, Imported& all) {
    constexpr std::size_t kPoints = 6; // as an experiment wants them (docs/reference/experiment_format.md, "Tables")
    if (part.rows() < kPoints)
        return Status::failure(std::to_string(part.line.front()) + ":1: " + std::to_string(part.rows()) +
                               " rows without a clock; a table of points read at rest needs " +
                               std::to_string(kPoints));
    run.atRest = true;
    run.rate = 1.0;
    std::vector<double> row(part.rows());
    std::iota(row.begin(), row.end(), 0.0);
    std::erase_if(part.channels, [](const Channel& c) {
        return c.quantity != Quantity::Force && c.quantity != Quantity::Displacement;
    });
    part.channels.insert(part.channels.begin(), {Quantity::Time, {}, std::move(row)});
    run.signals = std::move(part);
    run.remarks.push_back({Kind::Understood, 0,
                           "there is no clock: the rows are points that were read at rest (--rate or --speed makes "
                           "times)"});
    censorGauge(run, hints);
    addDoubts(run, table, runsOfFile);
    all.runs.push_back(std::move(run));
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
    if (!clock && hints.atRest && hints.rate == 0.0 && hints.speed == 0.0 && measures(part, Quantity::Force) &&
        measures(part, Quantity::Displacement))
        return addTableOfPoints(std::move(part), std::move(run), table, runsOfFile, hints, all);
    if (!clock)
        repairCounter(part, run.remarks); // times derived from travel need the original travel
    if (Status repaired = repairTime(part, hints, table.layout.metadata, run.remarks); !repaired)
        return repaired;
    if (clock)
        repairCounter(part, run.remarks);
    if (measures(part, Quantity::Angle) && !measures(part, Quantity::Force)) {
        dropDifferences(part, run.remarks);
        if (hints.fromTurningPoint > 0)
            cutToTurningPoint(part, hints.fromTurningPoint, run.remarks);
        average(part, hints.average, run.remarks);
        if (part.rows() < 10)
            return Status::failure("1:1: fewer than ten rows are left of a run");
    }
    const std::vector<double> velocity = takeVelocity(part, run.remarks); // behind all that takes rows away
    if (Status oriented = orient(part, hints, run.remarks); !oriented)
        return oriented;
    run.markers = select(part, true);
    if (run.markers.channels.size() < 2)
        run.markers = {};
    part.channels.erase(std::remove_if(part.channels.begin(), part.channels.end(),
                                       [](const Channel& c) { return isMarker(c) || c.quantity == Quantity::Counter; }),
                        part.channels.end());
    run.signals = std::move(part);
    findMotion(run, hints);
    compareVelocity(run, velocity);
    censorSaturation(run, hints);
    if (Status zeroed = zeroForce(run, hints.forceZero); !zeroed)
        return zeroed;
    findEvents(run, hints);
    addDoubts(run, table, runsOfFile);
    all.runs.push_back(std::move(run));
    return {};
}

/// Names for --columns: those that are known, and weights as forces.
std::string suggestion(const Table& t) {
    std::string list;
    bool weights = false;
    for (std::size_t c = 0; c < t.headings.size(); ++c) {
        const Heading& h = t.headings[c];
        const std::string text = folded(h.text);
        const bool weight = text.rfind("mass", 0) == 0 || text.rfind("weight", 0) == 0 || text.rfind("gewicht", 0) == 0;
        const bool grams = text.find("(g)") != std::string::npos || text.find("[g]") != std::string::npos;
        weights = weights || weight;
        list += c == 0 ? "" : ",";
        list += weight                ? (grams ? "force[gf]" : "force[kgf]")
                : t.channelOf[c] >= 0 ? name(h.quantity) + ("[" + h.unit.name + "]")
                                      : "-";
    }
    return weights ? list : exampleOfColumns(t.layout.columns);
}

Status checkColumns(const Signals& s, const Table& t) {
    const Layout& l = t.layout;
    const std::string here = std::to_string(l.namesLine > 0 ? l.namesLine : l.firstDataLine) + ":1: ";
    if (!measures(s, Quantity::Force) && !measures(s, Quantity::Angle))
        return Status::failure(here + "there is neither a force nor an angle; name the columns with --columns " +
                               suggestion(t));
    if (measures(s, Quantity::Force) && !measures(s, Quantity::Displacement) && !measures(s, Quantity::Velocity))
        return Status::failure(
            here + "there is a force but no displacement; expected both, or name the column with --columns " +
            suggestion(t));
    return {};
}

/// Angles that jump by a turn, 176, 179, -178, go on instead, if that leaves no step of a quarter turn.
void unwrap(Signals& signals, std::vector<Remark>& remarks) {
    std::vector<double>* angle = signals.find(Quantity::Angle);
    if (angle == nullptr)
        return;
    constexpr double kTurn = 2.0 * M_PI;
    const std::vector<double>* time = signals.find(Quantity::Time);
    std::vector<double> on = *angle;
    double turns = 0.0, last = std::nan(""), lo = last, hi = last;
    std::size_t jumps = 0, first = 0;
    for (std::size_t i = 0; i < on.size(); ++i) {
        if (!std::isfinite(on[i]))
            continue;
        lo = std::fmin(lo, on[i]);
        hi = std::fmax(hi, on[i]);
        if (std::binary_search(signals.breaks.begin(), signals.breaks.end(), i) ||
            (time != nullptr && i > 0 && (*time)[i] < (*time)[i - 1])) { // another run
            turns = 0.0;
            last = std::nan("");
        }
        const double step = on[i] + turns * kTurn - last;
        if (std::abs(step) > 0.5 * kTurn) {
            turns += step > 0.0 ? -1.0 : 1.0;
            first = jumps++ == 0 ? signals.line[i] : first;
        }
        on[i] += turns * kTurn;
        if (std::abs(on[i] - last) > 0.25 * kTurn)
            return; // too fast to tell which way it went
        last = on[i];
    }
    if (jumps == 0 || hi - lo > (1.0 + 1e-6) * kTurn) // beyond a turn it counts on by itself
        return;
    *angle = std::move(on);
    remarks.push_back({Kind::Corrected, first,
                       "the angle jumps by a turn " + std::to_string(jumps) + (jumps == 1 ? " time" : " times") +
                           ", here first: it is taken as going on"});
}

/// Runs of a table are added; a table of markers alone goes to the last run.
Status addTable(const std::string& file, const Text& text, Table&& table, const Hints& hints, Imported& all) {
    Signals whole = std::move(table.signals);
    table.signals = {};
    const std::size_t index = all.sources.size();
    Signals raw = table.unplaced.rows() > 0 ? std::move(table.unplaced) : whole.thinned();
    table.unplaced = {};
    Source source{file, text, std::move(table), whole.rows(), std::move(raw), 0, 0};
    const bool onlyMarkers = !measures(whole, Quantity::Force) && !measures(whole, Quantity::Angle) &&
                             std::any_of(whole.channels.begin(), whole.channels.end(), isMarker);
    if (!onlyMarkers)
        if (Status complete = checkColumns(whole, source.table); !complete)
            return complete;
    unwrap(whole, source.table.remarks);
    if (Status sound = checkWhole(whole, source.table, hints); !sound)
        return sound;
    source.candidates = source.table.candidates;
    source.lost = source.table.lost;
    std::vector<Signals> parts = splitRuns(std::move(whole), source.table.remarks);
    for (Signals& part : parts) {
        Status added;
        if (onlyMarkers) {
            added = repairTime(part, hints, source.table.layout.metadata, source.table.remarks);
            if (added)
                added = addMarkers(std::move(part), all);
        } else {
            added = addRun(std::move(part), index, source.table, parts.size(), hints, all);
            source.lost += added ? all.runs.back().signals.lost : 0;
        }
        if (!added)
            return added;
    }
    if (Status few = checkLost(source.lost, source.candidates, source.table.firstLost, hints); !few)
        return few;
    all.sources.push_back(std::move(source));
    return {};
}

/// Runs of one file are added.
Status addFile(const std::string& file, std::string&& bytes, const Hints& hints, Imported& all) {
    const auto failed = [&](const std::string& why) { return Status::failure(about(file, why)); };
    auto text = decode(std::move(bytes), hints.encoding);
    if (!text)
        return failed(text.error());
    auto tables = readTables(*text, hints);
    if (!tables)
        return failed(tables.error());
    text->utf8 = {}; // the tables hold what is needed
    for (Table& table : *tables)
        if (const Status added = addTable(file, *text, std::move(table), hints, all); !added)
            return failed(added.error());
    return {};
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

void finish(Imported& all, const Hints& hints) {
    all.forceUnitConfirmed = hints.accept.count("units") > 0;
    nameMarkers(all);
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        ImportedRun& run = all.runs[k];
        run.file = "run_" + std::to_string(k + 1) + ".csv";
        if (run.markers.channels.size() > 2)
            run.markersFile = "run_" + std::to_string(k + 1) + "_markers.csv";
    }
}

} // namespace

Result<Imported> readExports(const std::vector<std::string>& files, const Hints& hints) {
    Imported all;
    for (std::size_t k = 0; k < files.size(); ++k) {
        const auto here = files.begin() + static_cast<std::ptrdiff_t>(k);
        if (std::find(files.begin(), here, files[k]) != here)
            return Result<Imported>::failure(about(files[k], "this file is given twice"));
        auto bytes = record::readText(files[k], kMostBytes);
        if (!bytes)
            return Result<Imported>::failure(bytes.error());
        if (const Status added = addFile(files[k], *std::move(bytes), hints, all); !added)
            return Result<Imported>::failure(added.error());
    }
    finish(all, hints);
    return all;
}

Result<Imported> readTexts(std::vector<record::NamedText> texts, const Hints& hints) {
    Imported all;
    for (record::NamedText& text : texts)
        if (const Status added = addFile(text.first, std::move(text.second), hints, all); !added)
            return Result<Imported>::failure(added.error());
    finish(all, hints);
    return all;
}

} // namespace supercircle::importing
