// Corrections of clocks that were set back and counters that were reset. Each compares one step of a channel
// with the usual ones and is reported. A jump of the displacement to zero with a continuing clock is a reset counter;
// with a restarted clock it is another test. Other jumps are kept and reported.

#include "plugin/recording/import/reading/metadata.h"
#include "plugin/recording/import/signals.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

/// Of the finite values.
double quantile(std::vector<double> values, double share) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    return lowerQuantile(std::move(values), share);
}

/// The usual step forward of a clock.
double usualStep(const std::vector<double>& time) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i)
        if (time[i] > time[i - 1])
            steps.push_back(time[i] - time[i - 1]);
    return quantile(std::move(steps), 0.5);
}

double span(const std::vector<double>& values) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double v : values)
        if (std::isfinite(v)) {
            lo = std::min(lo, v);
            hi = std::max(hi, v);
        }
    return hi >= lo ? hi - lo : 0.0;
}

/// Interpolates missing times; rows before the first and after the last known time are removed.
void fillTimes(Signals& signals, std::vector<double>& time, std::vector<Remark>& remarks) {
    const std::size_t rows = signals.rows();
    std::vector<char> gone(rows, 0);
    std::size_t last = rows, missing = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        if (!std::isfinite(time[i])) {
            ++missing;
            gone[i] = 1;
            continue;
        }
        if (last < rows && i > last + 1)
            for (std::size_t k = last + 1; k < i; ++k) {
                time[k] =
                    time[last] + (time[i] - time[last]) * static_cast<double>(k - last) / static_cast<double>(i - last);
                gone[k] = 0;
            }
        last = i;
    }
    if (missing == 0)
        return;
    const auto lost = static_cast<std::size_t>(std::count(gone.begin(), gone.end(), 1));
    remarks.push_back({Kind::Corrected, 0,
                       std::to_string(missing) + " rows have no time: " + std::to_string(missing - lost) +
                           " are interpolated, " + std::to_string(lost) + " left out"});
    signals.erase(gone);
}

/// Continues a clock that was set back; single rows out of order are removed.
/// Fails if too much of it decreases.
Status mendBackwards(Signals& signals, std::vector<Remark>& remarks) {
    std::vector<double>& time = *signals.find(Quantity::Time);
    const double step = usualStep(time);
    std::vector<char> gone(signals.rows(), 0);
    double offset = 0.0, last = time.empty() ? 0.0 : time[0];
    Tally resets(Kind::Corrected, "such resets of the clock"),
        dropped(Kind::Omitted, "rows whose time is out of order");
    std::size_t first = 0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        const double now = time[i] + offset;
        if (now >= last) {
            time[i] = last = now;
            continue;
        }
        first = first == 0 ? signals.line[i] : first;
        const bool resumes = i + 1 < time.size() && time[i + 1] + offset >= last; // one row out of order
        if (last - now <= 10.0 * step && resumes) {
            gone[i] = 1;
            dropped.add(remarks, signals.line[i],
                        "a row whose time, " + shown(now) + " s, is before that of the row above, " + shown(last) +
                            " s");
            continue;
        }
        resets.add(remarks, signals.line[i],
                   "the clock jumps back from " + shown(last) + " s to " + shown(now) +
                       " s: it is taken as continuing");
        offset += last + step - now;
        time[i] = last = time[i] + offset;
    }
    if (const std::size_t back = resets.count() + dropped.count(); 10 * back > time.size())
        return Status::failure(std::to_string(first) + ":1: the time runs back in " + std::to_string(back) + " of " +
                               std::to_string(time.size()) +
                               " rows, here first; expected a clock that runs on (is this column the time?)");
    resets.finish(remarks);
    dropped.finish(remarks);
    signals.lost += dropped.count();
    signals.erase(gone);
    return {};
}

/// Rows of equal time (a clock that ticks more slowly than the rows come) are spread to the next tick.
void spreadEqual(Signals& signals, std::vector<Remark>& remarks) {
    std::vector<double>& time = *signals.find(Quantity::Time);
    std::size_t equal = 0, first = 0;
    for (std::size_t i = 0; i < time.size();) {
        std::size_t end = i + 1;
        while (end < time.size() && time[end] <= time[i])
            ++end;
        const std::size_t count = end - i;
        if (count > 1) {
            first = equal == 0 ? signals.line[i] : first;
            equal += count - 1;
            const double before = i > 0 ? time[i] - time[i - 1] : 1.0;
            const double tick = end < time.size() ? (time[end] - time[i]) / static_cast<double>(count) : before;
            const double start = time[i];
            for (std::size_t k = 1; k < count; ++k)
                time[i + k] = start + tick * static_cast<double>(k);
        }
        i = end;
    }
    if (equal > 0)
        remarks.push_back({Kind::Corrected, first,
                           std::to_string(equal) +
                               " rows have the time of the row before them: they are spread evenly to the next time"});
}

/// Median size of second differences.
double medianBend(const std::vector<double>& v) {
    std::vector<double> bends;
    for (std::size_t i = 1; i + 1 < v.size(); ++i)
        bends.push_back(std::abs(v[i - 1] - 2.0 * v[i] + v[i + 1]));
    return quantile(std::move(bends), 0.5);
}

/// A counter of the rows that never goes back.
bool counts(const std::vector<double>& counter) {
    for (std::size_t i = 0; i < counter.size(); ++i)
        if (!std::isfinite(counter[i]) || (i > 0 && counter[i] <= counter[i - 1]))
            return false;
    return counter.size() > 1 && counter.back() - counter.front() < 10.0 * static_cast<double>(counter.size());
}

void timeFromRate(Signals& signals, double rate) {
    Channel time{Quantity::Time, {}, {}};
    const std::vector<double>* counter = signals.find(Quantity::Counter);
    const bool counted = counter != nullptr && counts(*counter); // rows may have been dropped
    for (std::size_t i = 0; i < signals.rows(); ++i)
        time.values.push_back((counted ? (*counter)[i] - counter->front() : static_cast<double>(i)) / rate);
    signals.channels.push_back(std::move(time));
}

double firstKnown(const std::vector<double>& values) {
    const auto known = std::find_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    return known == values.end() ? std::numeric_limits<double>::quiet_NaN() : *known;
}

/// Way between turning points; noise below `least` turns nothing.
double netTravel(const std::vector<double>& d, double least) {
    double way = 0.0, from = firstKnown(d), furthest = from;
    for (const double v : d) {
        if (!std::isfinite(v))
            continue;
        if ((furthest - from) * (v - furthest) >= 0.0 || std::abs(furthest - from) < least)
            furthest = std::abs(v - from) > std::abs(furthest - from) ? v : furthest;
        if (std::abs(v - furthest) > least) { // back from the turning point
            way += std::abs(furthest - from);
            from = furthest;
            furthest = v;
        }
    }
    return way + std::abs(furthest - from);
}

/// Noise turns a displacement in many rows, a drive in few.
bool isNoisy(const std::vector<double>& d) {
    std::size_t turns = 0;
    double last = 0.0;
    for (std::size_t i = 1; i < d.size(); ++i) {
        const double step = d[i] - d[i - 1];
        turns += step * last < 0.0 ? 1 : 0;
        last = step != 0.0 && std::isfinite(step) ? step : last;
    }
    return 50 * turns > d.size();
}

/// Rows are ticks of equal length; together they take as long as the way at this speed.
void timeFromTicks(Signals& signals, double speed) {
    const std::vector<double>& d = *signals.find(Quantity::Displacement);
    const double noise = 1.4826 * medianBend(d);
    const double duration = netTravel(d, std::max(6.0 * noise, 0.01 * span(d))) / speed;
    const auto isKnown = [](double v) { return std::isfinite(v); };
    const auto first = std::find_if(d.begin(), d.end(), isKnown);
    const auto last = std::find_if(d.rbegin(), d.rend(), isKnown).base(); // behind it
    if (duration > 0.0)
        timeFromRate(signals, static_cast<double>(last - first - 1) / duration);
    else
        signals.erase(std::vector<char>(signals.rows(), 1));
}

/// Times of a clean displacement from its steps. Dwells cannot be timed: their rows go.
void timeFromSpeed(Signals& signals, double speed) {
    Channel time{Quantity::Time, {}, {}};
    const std::vector<double>& d = *signals.find(Quantity::Displacement);
    double way = 0.0, last = std::numeric_limits<double>::quiet_NaN();
    std::vector<char> gone(signals.rows(), 0);
    for (std::size_t i = 0; i < d.size(); ++i) {
        const bool first = std::isfinite(d[i]) && !std::isfinite(last);
        const double step = std::isfinite(d[i]) && !first ? std::abs(d[i] - last) : 0.0;
        gone[i] = first || step > 0.0 ? 0 : 1;
        way += step;
        last = std::isfinite(d[i]) ? d[i] : last;
        time.values.push_back(way / speed);
    }
    signals.channels.push_back(std::move(time));
    signals.erase(gone);
}

/// Where a clock starts again at the beginning of another test.
bool startsAgain(const Signals& signals, std::size_t begin, std::size_t i, double step) {
    const std::vector<double>& time = *signals.find(Quantity::Time);
    if (!(time[i] < time[i - 1] - 10.0 * step))
        return false;
    if (std::binary_search(signals.breaks.begin(), signals.breaks.end(), i))
        return true;
    const bool atStart = std::abs(time[i] - time[begin]) <= 3.0 * step || std::abs(time[i]) <= 3.0 * step;
    const std::vector<double>* d = signals.find(Quantity::Displacement);
    if (!atStart || d == nullptr)
        return atStart;
    const double travel = span(*d);
    return std::abs((*d)[i] - (*d)[begin]) <= 0.02 * travel;
}

Status timeWithoutClock(Signals& signals, const Hints& hints, const std::vector<HeaderEntry>& metadata,
                        std::vector<Remark>& remarks) {
    const auto rate = metadataValue(metadata, MetadataKey::Rate), speed = metadataValue(metadata, MetadataKey::Speed);
    if (hints.rate > 0.0 || rate) {
        const double hz = hints.rate > 0.0 ? hints.rate : rate->value;
        timeFromRate(signals, hz);
        remarks.push_back({hints.rate > 0.0 || rate->unitStated ? Kind::Understood : Kind::Assumed,
                           hints.rate > 0.0 ? 0 : rate->line,
                           "there is no time; rows come at " + shown(hz) + " Hz" +
                               (hints.rate > 0.0   ? " as given"
                                : rate->unitStated ? " as stated in the header"
                                                   : ": the header states it without a unit")});
        return {};
    }
    if (signals.find(Quantity::Displacement) == nullptr)
        return Status::failure(std::to_string(signals.line.front()) +
                               ":1: there is no column of times; expected one, or the rate of the rows with --rate HZ");
    if (const auto unclear = unclearSpeeds(metadata); hints.speed <= 0.0 && !unclear.empty()) {
        std::string list;
        for (const StatedValue& s : unclear)
            list += (list.empty() ? "" : ", ") + ("\"" + s.key + "\" of ") + shown(1e3 * s.value.value) +
                    " mm/s (line " + std::to_string(s.value.line) + ")";
        return Status::failure(
            std::to_string(unclear.front().value.line) +
            ":1: there is no time, and the header states no speed that is clearly that of the test: " + list +
            "; state it with --speed MM_PER_S, or the rate of the rows with --rate HZ");
    }
    const bool known = hints.speed > 0.0 || speed;
    const double metresPerSecond = hints.speed > 0.0 ? hints.speed : speed ? speed->value : 1e-3;
    const std::size_t rows = signals.rows();
    const std::vector<double>& d = *signals.find(Quantity::Displacement);
    const auto missing = std::count_if(d.begin(), d.end(), [](double v) { return !std::isfinite(v); });
    const bool ticks = signals.find(Quantity::Counter) != nullptr || isNoisy(*signals.find(Quantity::Displacement));
    (ticks ? timeFromTicks : timeFromSpeed)(signals, metresPerSecond);
    if (signals.rows() < 2)
        return Status::failure("there is no time, and the displacement never changes; expected one of them to");
    if (signals.rows() < rows)
        remarks.push_back({Kind::Omitted, 0,
                           std::to_string(rows - signals.rows()) + " rows in which the displacement does not change" +
                               (missing > 0 ? " or is missing" : "") +
                               ": dwells have no time without a clock "
                               "(--rate gives them one)"});
    remarks.push_back(
        {known ? Kind::Understood : Kind::Assumed, hints.speed > 0.0 || !speed ? 0 : speed->line,
         known ? "there is no time; the crosshead moves at " + shown(1e3 * metresPerSecond) + " mm/s as " +
                     (hints.speed > 0.0 ? "given" : "stated in the header") + (ticks ? ", one tick a row" : "")
               : std::string("there is no time; the crosshead is assumed to move at 1 mm/s") +
                     (ticks ? " on the whole, one tick a row" : "") +
                     ": rates are not known (state them better with --speed or --rate; points read at rest: --scene)"});
    return {};
}

} // namespace

Status repairTime(Signals& signals, const Hints& hints, const std::vector<HeaderEntry>& metadata,
                  std::vector<Remark>& remarks) {
    if (std::vector<double>* time = signals.find(Quantity::Time)) {
        const std::string here = std::to_string(signals.line.front()) + ":1: ";
        const auto known = static_cast<std::size_t>(
            std::count_if(time->begin(), time->end(), [](double v) { return std::isfinite(v); }));
        if (known < 2 || 2 * known < time->size())
            return Status::failure(here + std::to_string(time->size() - known) + " of " + std::to_string(time->size()) +
                                   " times are missing from here on; expected at least half of them");
        if (span(*time) == 0.0)
            return Status::failure(
                here + "the time never changes from here on; expected a clock that runs (without a column of times, "
                       "--rate or --speed gives them)");
        fillTimes(signals, *time, remarks);
        if (Status repaired = mendBackwards(signals, remarks); !repaired)
            return repaired;
        spreadEqual(signals, remarks);
        std::vector<double>& t = *signals.find(Quantity::Time);
        if (t.front() != 0.0) {
            remarks.push_back({Kind::Understood, signals.line.front(),
                               "the clock starts at " + shown(t.front()) + " s, which becomes 0"});
            signals.clockStart = t.front();
            for (double& v : t)
                v -= signals.clockStart;
        }
        return {};
    }
    return timeWithoutClock(signals, hints, metadata, remarks);
}

std::vector<Signals> splitRuns(Signals&& signals, std::vector<Remark>& remarks) {
    const std::vector<double>* time = signals.find(Quantity::Time);
    std::vector<std::size_t> starts{0};
    // fewer rows each: the column counts something else
    const bool named = 10 * (signals.renamed.size() + 1) <= signals.rows();
    const auto renames = [&](std::size_t i) {
        return named && std::binary_search(signals.renamed.begin(), signals.renamed.end(), i);
    };
    if (time != nullptr) {
        const double step = usualStep(*time);
        for (std::size_t i = 1; i < signals.rows(); ++i)
            if (startsAgain(signals, starts.back(), i, step) || (renames(i) && (*time)[i] < (*time)[i - 1]))
                starts.push_back(i);
    } else {
        std::set<std::size_t> all(signals.breaks.begin(), signals.breaks.end());
        if (named)
            all.insert(signals.renamed.begin(), signals.renamed.end());
        starts.insert(starts.end(), all.begin(), all.end());
    }
    std::vector<Signals> runs;
    for (std::size_t k = 1; k < starts.size(); ++k)
        remarks.push_back({Kind::Understood, signals.line[starts[k]],
                           renames(starts[k]) ? "another run begins: another specimen or test is named"
                           : time != nullptr  ? "another run begins: the clock starts again"
                                              : "another run begins: the header is repeated"});
    if (starts.size() == 1) {
        runs.push_back(std::move(signals));
        return runs;
    }
    for (std::size_t k = 0; k < starts.size(); ++k)
        runs.push_back(signals.part(starts[k], k + 1 < starts.size() ? starts[k + 1] : signals.rows()));
    return runs;
}

void repairCounter(Signals& signals, std::vector<Remark>& remarks) {
    std::vector<double>* displacement = signals.find(Quantity::Displacement);
    const std::vector<double>* time = signals.find(Quantity::Time);
    if (displacement == nullptr || displacement->size() < 10)
        return;
    std::vector<double>& d = *displacement;
    const auto clock = [&](std::size_t i) { return time != nullptr ? (*time)[i] : static_cast<double>(i); };
    std::vector<double> speeds;
    speeds.reserve(d.size());
    for (std::size_t i = 1; i < d.size(); ++i)
        speeds.push_back(std::abs(d[i] - d[i - 1]) / (clock(i) - clock(i - 1)));
    const double travel = span(d);
    double usual = quantile(speeds, 0.95);
    const bool stepwise = usual == 0.0; // it rests in nearly all rows and moves within one
    if (stepwise) {
        speeds.erase(std::remove(speeds.begin(), speeds.end(), 0.0), speeds.end());
        usual = quantile(std::move(speeds), 0.5);
    }
    const std::vector<double>* force = signals.find(Quantity::Force);
    const double forces = force != nullptr ? span(*force) : 0.0;
    // a counter that is reset leaves the force as it is, a head that returns does not
    const auto unloads = [&](std::size_t i) {
        return force != nullptr && std::abs((*force)[i] - (*force)[i - 1]) > 0.2 * forces;
    };
    const auto isSudden = [&](std::size_t from, std::size_t to) {
        const double jump = std::abs(d[to] - d[from]);
        return jump > 20.0 * usual * (clock(to) - clock(from)) && jump > 0.01 * travel;
    };
    // steps of a head that only creeps between them are sudden too
    std::size_t steps = 0, before = 0;
    for (std::size_t i = 1; i < d.size(); ++i)
        if (std::isfinite(d[i])) {
            steps += isSudden(before, i) && std::abs(d[i]) >= 0.02 * travel ? 1 : 0;
            before = i;
        }
    const bool moves = stepwise || steps >= 3;
    double offset = 0.0;
    std::size_t last = 0;
    double lastRaw = d[0];
    Tally zeroed(Kind::Corrected, "resets of the counter"), jumps(Kind::Doubtful, "jumps of the displacement");
    for (std::size_t i = 1; i < d.size(); ++i) {
        const double raw = d[i];
        if (!std::isfinite(raw))
            continue;
        const double jump = raw - lastRaw, gap = clock(i) - clock(last);
        const bool sudden = std::abs(jump) > 20.0 * usual * gap && std::abs(jump) > 0.01 * travel;
        if (sudden && !moves && !unloads(i) && std::abs(raw) < 0.02 * travel && std::abs(lastRaw) > std::abs(raw)) {
            const double going = last > 0 ? (d[last] - d[last - 1]) / (clock(last) - clock(last - 1)) : 0.0;
            offset = d[last] + (std::isfinite(going) ? going * gap : 0.0) - raw;
            zeroed.add(remarks, signals.line[i],
                       "the displacement falls from " + shown(1e3 * lastRaw) + " mm to " + shown(1e3 * raw) +
                           " mm within a row: the counter was reset and is taken as continuing");
        } else if (sudden) {
            jumps.add(remarks, signals.line[i],
                      "the displacement jumps from " + shown(1e3 * lastRaw) + " mm to " + shown(1e3 * raw) +
                          " mm within a row; it is kept");
        }
        lastRaw = raw;
        d[i] = raw + offset;
        last = i;
    }
    zeroed.finish(remarks);
    jumps.finish(remarks);
}

} // namespace supercircle::importing
