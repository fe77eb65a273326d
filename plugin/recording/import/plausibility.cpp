#include "plugin/recording/import/plausibility.h"

#include "plugin/recording/import/reading/metadata.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

struct Range {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    std::size_t known = 0;
};

Range rangeOf(const std::vector<double>& values) {
    Range r;
    for (const double v : values)
        if (std::isfinite(v)) {
            r.lo = std::min(r.lo, v);
            r.hi = std::max(r.hi, v);
            ++r.known;
        }
    return r;
}

void add(ImportedRun& run, std::size_t line, const std::string& what) {
    run.remarks.push_back({Kind::Doubtful, line, what});
}

/// "stated as kN" or "taken as N"
std::string unitWords(const Table& t, Quantity q) {
    for (std::size_t c = 0; c < t.headings.size(); ++c)
        if (t.channelOf[c] >= 0 && t.headings[c].quantity == q)
            return (t.headings[c].unitStated ? "stated as " : "taken as ") + t.headings[c].unit.name;
    return "unknown";
}

/// Fastest segment of the drive, and the segment speed nearest to `wanted`, m/s.
std::pair<double, double> speeds(const Drive& drive, double wanted) {
    double most = 0.0, nearest = 0.0;
    for (std::size_t i = 1; i < drive.time.size(); ++i) {
        const double way = std::abs(drive.displacement[i] - drive.displacement[i - 1]);
        if (way < 10.0 * drive.tolerance)
            continue; // a dwell, or a rounded corner
        const double v = way / (drive.time[i] - drive.time[i - 1]);
        most = std::max(most, v);
        if (nearest == 0.0 || std::abs(math::log(v / wanted)) < std::abs(math::log(nearest / wanted)))
            nearest = v;
    }
    return {most, nearest};
}

void doubtSizes(ImportedRun& run, const Table& t, double travel, double peak) {
    const double speed = speeds(run.drive, 1.0).first;
    if (travel > 1.0 || (travel > 0.0 && travel < 1e-5))
        add(run, 0,
            "the crosshead travels " + shown(1e3 * travel) + " mm; the unit of the displacement is " +
                unitWords(t, Quantity::Displacement));
    if (travel == 0.0)
        add(run, 0, "the displacement never changes: nothing was commanded in this run");
    if (peak > 1e5 || peak < 1e-4)
        add(run, 0,
            "the largest force is " + shown(peak) + " N; the unit of the force is " + unitWords(t, Quantity::Force));
    if (speed > 1.0)
        add(run, 0,
            "the crosshead moves at " + shown(speed) + " m/s; the unit of the time is " + unitWords(t, Quantity::Time));
    if (run.rate > 1e5 || run.rate < 1e-2)
        add(run, 0, "rows come at " + shown(run.rate) + " Hz; the unit of the time is " + unitWords(t, Quantity::Time));
}

bool differs(double a, double b, double share) {
    return std::abs(a - b) > share * std::max(std::abs(a), std::abs(b));
}

void doubtStatements(ImportedRun& run, const Table& t, double peak) {
    const auto& header = t.layout.metadata;
    if (const auto rate = metadataValue(header, MetadataKey::Rate); rate && differs(rate->value, run.rate, 0.05))
        add(run, rate->line,
            "the header states " + shown(rate->value) + " Hz, the times of the rows " + shown(run.rate) +
                " Hz; the times are taken");
    if (const auto speed = metadataValue(header, MetadataKey::Speed)) {
        const double nearest = speeds(run.drive, speed->value).second;
        if (nearest > 0.0 && differs(speed->value, nearest, 0.1))
            add(run, speed->line,
                "the header states " + shown(1e3 * speed->value) +
                    " mm/s, but no segment of the motion has it (nearest: " + shown(1e3 * nearest) +
                    " mm/s); the rows are taken (is a unit of time or displacement wrong?)");
    }
    if (const auto most = metadataValue(header, MetadataKey::PeakForce); most && differs(most->value, peak, 0.1))
        add(run, most->line,
            "the header states " + shown(most->value) + " N at most, the rows " + shown(peak) +
                " N; the rows are taken (the unit of their force is " + unitWords(t, Quantity::Force) + ")");
}

/// A force in a single row is probably a glitch.
void doubtSpike(ImportedRun& run, const std::vector<double>& f, double peak) {
    std::size_t large = 0, at = 0;
    for (std::size_t i = 0; i < f.size(); ++i)
        if (std::abs(f[i]) > 0.01 * peak) {
            ++large;
            at = i;
        }
    if (large == 1)
        add(run, run.signals.line[at],
            "the force is " + shown(f[at]) +
                " N in this row, and below a hundredth of it in all others: a glitch? (an "
                "empty cell is ignored)");
}

void reportMissing(ImportedRun& run, const std::vector<double>& values, std::size_t known, const char* what,
                   const char* done) {
    if (known == values.size())
        return;
    const auto first = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
    run.remarks.push_back({Kind::Corrected, run.signals.line[static_cast<std::size_t>(first - values.begin())],
                           std::to_string(values.size() - known) + " of " + std::to_string(values.size()) +
                               " values of the " + what + " are missing, here first: " + done});
}

} // namespace

Status checkPlausible(const Signals& signals) {
    const std::string here = std::to_string(signals.line.front()) + ":1: ";
    for (const Quantity q : {Quantity::Force, Quantity::Displacement}) {
        const std::vector<double>* values = signals.find(q);
        if (values == nullptr)
            continue;
        const Range r = rangeOf(*values);
        if (2 * r.known < values->size() || r.known < 2)
            return Status::failure(here + std::to_string(values->size() - r.known) + " of " +
                                   std::to_string(values->size()) + " values of the " + name(q) +
                                   " are missing from here on; expected at least half of them");
        if (q == Quantity::Force && r.lo == r.hi)
            return Status::failure(
                here + "the force is " + shown(r.lo) +
                " N in every row from here on; expected one that changes (is the load cell connected, and this its "
                "column?)");
    }
    return {};
}

void addDoubts(ImportedRun& run, const Table& t, std::size_t runsOfFile) {
    const std::vector<double>* d = run.signals.find(Quantity::Displacement);
    const std::vector<double>* f = run.signals.find(Quantity::Force);
    if (d == nullptr || f == nullptr)
        return;
    const Range way = rangeOf(*d), force = rangeOf(*f);
    reportMissing(run, *f, force.known, "force", "their rows are kept without it");
    reportMissing(run, *d, way.known, "displacement", "the linear segments are used instead");
    const double peak = std::max(std::abs(force.lo), std::abs(force.hi));
    doubtSpike(run, *f, peak);
    doubtSizes(run, t, way.hi - way.lo, peak);
    if (runsOfFile > 1)
        return; // a header above several runs need not describe each
    doubtStatements(run, t, peak);
    if (const auto rows = metadataValue(t.layout.metadata, MetadataKey::Rows);
        rows && differs(rows->value, static_cast<double>(run.signals.rows()), 1e-9))
        add(run, rows->line,
            "the header states " + shown(rows->value) + " rows, " + std::to_string(run.signals.rows()) +
                " were read: is the file whole?");
}

} // namespace supercircle::importing
