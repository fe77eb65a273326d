#include "plugin/recording/import/events.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

constexpr std::size_t kFlat = 5;    ///< equal rows at the largest force; halved: a rounded top counts as saturated
constexpr double kFlatLonger = 4.0; ///< times any other stretch of equal forces; doubled: coarse sensors hide it
constexpr double kGap = 3.5; ///< usual steps; halved: a single late row is a gap; doubled: six rows are lost unsaid
constexpr std::size_t kStuck = 3; ///< equal readings of a gauge under growing loads; halved: two readings may be equal
constexpr double kBroken = 0.05;  ///< of the largest force is what a broken specimen may carry at most
constexpr double kSudden = 0.2;   ///< of the largest force lost within two rows; halved: snaps of noise are told

double peakOf(const std::vector<double>& f) {
    double peak = 0.0;
    for (const double v : f)
        peak = std::isfinite(v) ? std::max(peak, std::abs(v)) : peak;
    return peak;
}

/// Longest stretch of equal values, first to last - 1, of those that `counts`.
template <class Counts>
std::pair<std::size_t, std::size_t> longestFlat(const std::vector<double>& f, const Counts& counts) {
    std::pair<std::size_t, std::size_t> longest{0, 0};
    for (std::size_t i = 0; i < f.size();) {
        std::size_t end = i + 1;
        while (end < f.size() && f[end] == f[i])
            ++end;
        if (counts(f[i]) && end - i > longest.second - longest.first)
            longest = {i, end};
        i = end;
    }
    return longest;
}

/// The sensor is at its limit: the largest reading repeats to the last digit, as no other one does.
void censor(ImportedRun& run, std::vector<double>& f, bool keep) {
    const double peak = peakOf(f);
    if (peak == 0.0)
        return;
    const auto top = longestFlat(f, [&](double v) { return std::abs(v) == peak; });
    const auto other = longestFlat(f, [&](double v) { return std::abs(v) > 0.1 * peak && std::abs(v) < peak; });
    const std::size_t length = top.second - top.first;
    if (length < kFlat || static_cast<double>(length) < kFlatLonger * static_cast<double>(other.second - other.first))
        return;
    const double limit = f[top.first];
    std::size_t rows = 0;
    for (double& v : f)
        if (v == limit) {
            ++rows;
            v = keep ? v : std::numeric_limits<double>::quiet_NaN();
        }
    run.remarks.push_back({Kind::Doubtful, run.signals.line[top.first],
                           "the force stays at its largest value, " + shown(limit) + " N, in " + std::to_string(rows) +
                               " rows: the sensor is saturated" +
                               (keep ? ", the rows are kept"
                                     : ", they are kept without a force (--keep saturation "
                                       "keeps it)")});
}

/// Removes the rows from `at` on and finds the drive of the others.
void cutFrom(ImportedRun& run, std::size_t at, double tolerance) {
    std::vector<char> gone(run.signals.rows(), 0);
    std::fill(gone.begin() + static_cast<std::ptrdiff_t>(at), gone.end(), 1);
    run.signals.erase(gone);
    if (const std::vector<double>* d = run.signals.find(Quantity::Displacement); d != nullptr && d->size() >= 2)
        run.drive = findDrive(*run.signals.find(Quantity::Time), *d, tolerance);
}

/// Row from which the force is gone for good after a sudden fall; rows: there is none.
std::size_t breakRow(const std::vector<double>& f, double peak) {
    std::size_t i = f.size();
    while (i > 0 && std::abs(f[i - 1]) <= kBroken * peak) // what a saturated sensor did not see is no fall
        --i;
    // i is the first row of the empty rest; the force must have been large just before
    const bool sudden =
        i >= 3 && std::max({std::abs(f[i - 1]), std::abs(f[i - 2]), std::abs(f[i - 3])}) > kSudden * peak;
    return sudden && i + kFlat <= f.size() ? i : f.size();
}

void tellBreak(ImportedRun& run, const std::vector<double>& f, const Hints& hints) {
    const bool cut = hints.cut.count("break") > 0;
    const std::size_t at = breakRow(f, peakOf(f));
    if (at == f.size())
        return;
    run.remarks.push_back({cut ? Kind::Omitted : Kind::Understood, run.signals.line[at],
                           "the force falls to nothing within three rows and stays there: a break, or the specimen has "
                           "come off; the " +
                               std::to_string(f.size() - at) + " rows from here on are " +
                               (cut ? "left out" : "kept (--cut break leaves them out)")});
    if (cut)
        cutFrom(run, at, hints.driveTolerance);
}

/// Snaps of the specimen and slips of a grip look alike in the force.
void tellFalls(ImportedRun& run, const std::vector<double>& f, const Hints& hints) {
    const double least = kSudden * peakOf(f);
    std::size_t count = 0, first = 0;
    for (std::size_t i = 2; i < f.size(); ++i)
        if (f[i - 2] - f[i] > least) {
            first = count++ == 0 ? i : first;
            i += kFlat;
        }
    if (count == 0 || 20 * count > f.size()) // a coarse recording falls everywhere
        return;
    const bool cut = hints.cut.count("falls") > 0 && first >= kFlat;
    run.remarks.push_back(
        {cut ? Kind::Omitted : Kind::Understood, run.signals.line[first],
         std::to_string(count) + (count == 1 ? " sudden fall" : " sudden falls") +
             " of the force, here first: snaps of the specimen, or slips of a grip" +
             (cut ? "; the " + std::to_string(f.size() - first) + " rows from here on are left out" : "")});
    if (cut)
        cutFrom(run, first, hints.driveTolerance);
}

/// Dropped samples.
void tellGaps(ImportedRun& run, const Hints& hints) {
    const std::vector<double>& time = *run.signals.find(Quantity::Time);
    std::size_t gaps = 0, first = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
        if (time[i] - time[i - 1] > kGap / run.rate)
            first = gaps++ == 0 ? i : first;
    if (gaps == 0)
        return;
    const bool cut = hints.cut.count("gaps") > 0 && first >= kFlat;
    run.remarks.push_back(
        {cut ? Kind::Omitted : Kind::Understood, run.signals.line[first],
         std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") + " in the samples, the first after " +
             shown(time[first - 1]) + " s" +
             (cut ? "; the " + std::to_string(time.size() - first) + " rows behind it are left out" : "")});
    if (cut)
        cutFrom(run, first, hints.driveTolerance);
}

} // namespace

void censorSaturation(ImportedRun& run, const Hints& hints) {
    if (std::vector<double>* force = run.signals.find(Quantity::Force); force != nullptr && force->size() >= 10)
        censor(run, *force, hints.keep.count("saturation") > 0);
}

void censorGauge(ImportedRun& run, const Hints& hints) {
    std::vector<double>& y = *run.signals.find(Quantity::Displacement);
    const std::vector<double>& f = *run.signals.find(Quantity::Force);
    double farthest = 0.0, limit = 0.0;
    for (const double v : y)
        if (std::isfinite(v) && std::abs(v - y.front()) > farthest) {
            farthest = std::abs(v - y.front());
            limit = v;
        }
    const auto top = longestFlat(y, [&](double v) { return v == limit; });
    std::size_t moved = 0; // rows that another load should have moved
    for (std::size_t i = top.first + 1; i < top.second; ++i)
        moved += f[i] != f[i - 1] ? 1 : 0;
    if (farthest == 0.0 || moved + 1 < kStuck)
        return;
    const bool keep = hints.keep.count("saturation") > 0;
    for (std::size_t i = top.first; i < top.second && !keep; ++i)
        y[i] = std::numeric_limits<double>::quiet_NaN();
    run.remarks.push_back(
        {Kind::Doubtful, run.signals.line[top.first],
         "the displacement stays at " + shownLength(limit) + " in " + std::to_string(top.second - top.first) +
             " rows of different loads: the gauge is at its end" +
             (keep ? ", the rows are kept" : ", they are kept without a displacement (--keep saturation keeps it)")});
}

void findEvents(ImportedRun& run, const Hints& hints) {
    tellGaps(run, hints);
    const std::vector<double>* force = run.signals.find(Quantity::Force);
    if (force == nullptr || force->size() < 10)
        return;
    tellBreak(run, *force, hints); // it is a fall too
    if (force = run.signals.find(Quantity::Force); force->size() >= 10)
        tellFalls(run, *force, hints);
}

} // namespace supercircle::importing
