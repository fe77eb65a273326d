// Which column is what. Headings give candidates for each quantity. Candidates of equal rank are scored by their
// values: a clock runs on evenly, a sensor in use varies. Two candidates that are proportional are one.

#include "plugin/recording/import/signals.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

/// Evidence that decides. Halved, 5 : 1 passes for certain; doubled, clear files are asked about.
constexpr double kDecisive = 10.0;

/// One step of rank (a word of the heading) counts as much as decisive evidence of the values.
constexpr double kRankStep = 10.0;

void remark(Table& t, Remark::Kind kind, std::size_t line, const std::string& what) {
    t.remarks.push_back({kind, line, what});
}

/// A table to be, with its lines.
struct Draft {
    const std::vector<std::string_view>& lines;
    Table table;
    std::vector<std::size_t> chosen; ///< column of each quantity that is used
    std::size_t wrong = 0;           ///< column that an error is about
};

/// Values of a column in lines spread over the file, as they stand there.
std::vector<double> sampleOf(const Draft& d, std::size_t column) {
    const Layout& l = d.table.layout;
    std::vector<double> values;
    for (const std::size_t i : sampledLines(d.lines.size())) {
        if (i + 1 < l.firstDataLine)
            continue;
        const std::vector<std::string> cells = cellsOf(d.lines[i], l);
        double v = 0.0;
        if (isRow(cells, l) && readCell(cells[column], l.styles[column], v) == Cell::Number)
            values.push_back(v);
    }
    return values;
}

double spanOf(const std::vector<double>& v) {
    const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
    return v.empty() ? 0.0 : *hi - *lo;
}

/// 1 for a clock that runs on evenly; a tenth for one that goes back once in a thousand rows, or stands in most.
double clockQuality(const std::vector<double>& v) {
    if (v.size() < 3)
        return 0.0;
    double back = 0.0, still = 0.0;
    for (std::size_t i = 1; i < v.size(); ++i) {
        back += v[i] < v[i - 1] ? 1.0 : 0.0;
        still += v[i] == v[i - 1] ? 1.0 : 0.0;
    }
    const double n = static_cast<double>(v.size());
    return 1.0 / ((1.0 + 1e4 * back / n) * (1.0 + 10.0 * still / n));
}

/// How much a sensor varies beyond its last digits: 1, or less than a tenth for one that is not connected.
double sensorQuality(const std::vector<double>& v) {
    if (v.size() < 3 || spanOf(v) == 0.0)
        return 1e-3;
    std::vector<double> steps;
    for (std::size_t i = 1; i < v.size(); ++i)
        steps.push_back(std::abs(v[i] - v[i - 1]));
    const double usual = upperMedian(std::move(steps));
    return std::min(1.0, spanOf(v) / (spanOf(v) + 20.0 * usual) + (usual == 0.0 ? 0.5 : 0.0)) *
           (spanOf(v) < 1e-2 * std::abs(v.front()) ? 1e-2 : 1.0);
}

/// Equal up to factor, sign and offset within the last digits.
bool proportional(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size() || a.size() < 3)
        return false;
    double ma = 0.0, mb = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ma += a[i] / static_cast<double>(a.size());
        mb += b[i] / static_cast<double>(a.size());
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        aa += (a[i] - ma) * (a[i] - ma);
        bb += (b[i] - mb) * (b[i] - mb);
        ab += (a[i] - ma) * (b[i] - mb);
    }
    return ab * ab > 0.999998 * aa * bb; // 0.1 % of the range
}

bool sameQuantity(const Heading& a, const Heading& b) {
    return a.quantity == b.quantity && a.marker == b.marker;
}

/// --columns with what is chosen so far.
std::string suggestion(const Draft& d) {
    std::string list;
    for (std::size_t c = 0; c < d.table.layout.columns; ++c) {
        const Heading& h = d.table.headings[c];
        const bool used = std::find(d.chosen.begin(), d.chosen.end(), c) != d.chosen.end();
        list += (c == 0 ? "" : ",") + (used && h.marker.empty() && h.quantity != Quantity::Counter
                                           ? name(h.quantity) + ("[" + h.unit.name + "]")
                                           : std::string("-"));
    }
    return list;
}

/// The best of the columns that could be one quantity.
Status chooseOne(Draft& d, const std::vector<std::size_t>& candidates) {
    Table& t = d.table;
    const bool clock = t.headings[candidates.front()].quantity == Quantity::Time;
    std::size_t best = candidates.front(), second = candidates.front();
    double most = -1.0, next = -1.0;
    for (const std::size_t c : candidates) {
        double score = math::pow(10.0, t.headings[c].rank / kRankStep) * (t.headings[c].unitStated ? kDecisive : 1.0);
        if (candidates.size() > 1) {
            const std::vector<double> values = sampleOf(d, c);
            score *= clock ? clockQuality(values) : sensorQuality(values);
        }
        if (score > most) {
            next = most;
            second = best;
            most = score;
            best = c;
        } else if (score > next) {
            next = score;
            second = c;
        }
    }
    d.chosen.push_back(best);
    if (most < kDecisive * next && t.headings[best].marker.empty() &&
        t.headings[best].rank < t.headings[second].rank + static_cast<int>(0.5 * kRankStep) &&
        !proportional(sampleOf(d, best), sampleOf(d, second))) {
        d.wrong = second;
        return Status::failure(columnText(t, best) + " and " + columnText(t, second) + " are both a " +
                               name(t.headings[best].quantity) +
                               ", and they differ; name the one that counts, with --columns " + suggestion(d));
    }
    if (candidates.size() > 1)
        t.layout.decisions.push_back(
            {name(t.headings[best].quantity), columnText(t, best), columnText(t, second), most / next, "--columns"});
    for (const std::size_t c : candidates)
        if (c != best)
            remark(t, Remark::Kind::Omitted, t.layout.namesLine,
                   columnText(t, c) + " is also a " + name(t.headings[c].quantity) + "; " + columnText(t, best) +
                       " is taken (choose with --columns)");
    return {};
}

const char* unitsFor(Quantity q) {
    return q == Quantity::Time    ? "s, ms, min, h"
           : q == Quantity::Force ? "N, kN, mN, lbf, kgf"
           : q == Quantity::Angle ? "deg, rad"
                                  : "mm, m, in, um";
}

/// A column whose unit is none of its quantity is no candidate; without another one the unit is asked for.
Status checkUnit(Draft& d, std::vector<std::size_t>& candidates) {
    Table& t = d.table;
    std::vector<std::size_t> good;
    for (const std::size_t c : candidates)
        if (t.headings[c].unknownUnit.empty())
            good.push_back(c);
    if (good.empty()) {
        const Heading& h = t.headings[candidates.front()];
        d.wrong = candidates.front();
        return Status::failure(columnText(t, candidates.front()) + ": \"" + h.unknownUnit + "\" is no unit of " +
                               name(h.quantity) + "; expected one of " + unitsFor(h.quantity));
    }
    for (const std::size_t c : candidates)
        if (!t.headings[c].unknownUnit.empty())
            remark(t, Remark::Kind::Omitted, t.layout.namesLine,
                   columnText(t, c) + ": \"" + t.headings[c].unknownUnit + "\" is no unit of " +
                       name(t.headings[c].quantity));
    candidates = good;
    return {};
}

/// Two digits are enough to write it.
bool isRound(double x) {
    const double digits = x / math::pow(10.0, std::floor(math::log10(x)) - 1.0);
    return std::abs(digits - std::round(digits)) < 0.02;
}

/// A clock of hours, minutes and seconds, or one in seconds: it has fractions, and no step that is round in minutes
/// only.
bool saysSeconds(const Draft& d, std::size_t column) {
    const Layout& l = d.table.layout;
    const std::vector<std::string> cells = cellsOf(d.lines[l.firstDataLine - 1], l);
    if (column < cells.size() && cells[column].find(':') != std::string::npos)
        return true;
    const std::vector<double> v = sampleOf(d, column);
    std::vector<double> steps;
    for (std::size_t i = 1; i < std::min<std::size_t>(v.size(), 1000); ++i)
        if (v[i] > v[i - 1])
            steps.push_back(v[i] - v[i - 1]);
    if (steps.empty())
        return false;
    const double step = upperMedian(std::move(steps));
    return (isRound(step) || !isRound(60.0 * step)) &&
           std::any_of(v.begin(), v.end(), [](double x) { return x != std::floor(x); });
}

/// Units that no heading states: from the user, or asked for.
Status completeUnits(Draft& d, const Hints& hints) {
    Table& t = d.table;
    std::string missing, answer;
    for (const std::size_t c : d.chosen) {
        Heading& h = t.headings[c];
        if (h.unitStated || h.quantity == Quantity::Counter)
            continue;
        const Quantity kind = h.marker.empty() ? h.quantity : Quantity::Displacement;
        const auto given =
            std::find_if(hints.units.begin(), hints.units.end(), [&](const Unit& u) { return u.measures == kind; });
        if (given != hints.units.end()) {
            h.unit = *given;
            h.unitStated = true;
            continue;
        }
        if (h.quantity == Quantity::Time && saysSeconds(d, c))
            continue;
        d.wrong = missing.empty() ? c : d.wrong;
        missing += (missing.empty() ? "" : " and ") + std::string(name(h.quantity)) + " (" + columnText(t, c) + ")";
        if (answer.find(usualUnit(kind).name) == std::string::npos)
            answer += (answer.empty() ? "" : ",") + usualUnit(kind).name;
        if (kind == Quantity::Angle)
            answer += " or --units rad";
    }
    if (missing.empty())
        return {};
    return Status::failure("no unit is stated for " + missing + "; state it with --units, for instance --units " +
                           answer);
}

/// Reports the columns; many markers in one line.
void tellColumns(Draft& d, bool alone) {
    Table& t = d.table;
    const Layout& l = t.layout;
    const auto isMarker = [&](std::size_t c) {
        return t.headings[c].quantity == Quantity::MarkerX || t.headings[c].quantity == Quantity::MarkerY;
    };
    std::size_t count = 0, firstMarker = 0, lastMarker = 0;
    for (std::size_t c = 0; c < l.columns; ++c)
        if (t.channelOf[c] >= 0 && isMarker(c)) {
            firstMarker = count++ == 0 ? c : firstMarker;
            lastMarker = c;
        }
    std::string idle;
    for (std::size_t c = 0; c < l.columns; ++c) {
        const Heading& h = t.headings[c];
        if (alone && h.quantity == Quantity::None && !h.text.empty() && h.text != "-")
            idle += (idle.empty() ? "column " : ", ") + std::to_string(c + 1) + " \"" + h.text + "\"";
        if (t.channelOf[c] < 0)
            continue;
        if (count > 2 && lastMarker - firstMarker + 1 == count && isMarker(c) &&
            h.unit.name == t.headings[firstMarker].unit.name) {
            if (c == firstMarker)
                remark(t, Remark::Kind::Understood, l.namesLine,
                       "columns " + std::to_string(firstMarker + 1) + " to " + std::to_string(lastMarker + 1) +
                           " hold markers, " + h.marker + " to " + t.headings[lastMarker].marker + ", x and y [" +
                           h.unit.name + "]");
            continue;
        }
        const std::string unit = h.quantity == Quantity::Counter ? "" : " [" + h.unit.name + "]";
        const std::string what =
            columnText(t, c) + " is " + name(h.quantity) + (h.marker.empty() ? "" : " of " + h.marker) + unit;
        if (h.unitStated || h.quantity == Quantity::Counter)
            remark(t, Remark::Kind::Understood, l.unitsLine > 0 ? l.unitsLine : l.namesLine, what);
        else
            remark(t, Remark::Kind::Assumed, l.namesLine, what + ": no unit is stated, and its numbers have fractions");
    }
    if (!idle.empty())
        remark(t, Remark::Kind::Omitted, l.namesLine, idle + ": not needed here");
}

Status choose(Draft& d, const Hints& hints, bool alone) {
    Table& t = d.table;
    const Layout& l = t.layout;
    std::vector<char> done(l.columns, 0);
    for (std::size_t c = 0; c < l.columns; ++c) {
        if (done[c] || t.headings[c].quantity == Quantity::None)
            continue;
        std::vector<std::size_t> candidates;
        for (std::size_t k = c; k < l.columns; ++k) {
            if (!sameQuantity(t.headings[c], t.headings[k]))
                continue;
            done[k] = 1;
            if (l.numeric[k])
                candidates.push_back(k);
            else
                remark(t, Remark::Kind::Omitted, l.namesLine, columnText(t, k) + " holds no numbers");
        }
        if (candidates.empty())
            continue;
        if (Status usable = checkUnit(d, candidates); !usable)
            return usable;
        if (Status one = chooseOne(d, candidates); !one)
            return one;
    }
    const auto uses = [&](Quantity q) {
        return std::find_if(d.chosen.begin(), d.chosen.end(),
                            [&](std::size_t c) { return t.headings[c].quantity == q; });
    };
    if (uses(Quantity::Counter) != d.chosen.end() && (uses(Quantity::Time) != d.chosen.end() || d.chosen.size() == 1)) {
        t.headings[*uses(Quantity::Counter)].quantity = Quantity::None; // there is a clock
        d.chosen.erase(std::find_if(d.chosen.begin(), d.chosen.end(),
                                    [&](std::size_t c) { return t.headings[c].quantity == Quantity::None; }));
    }
    if (Status complete = completeUnits(d, hints); !complete)
        return complete;
    std::sort(d.chosen.begin(), d.chosen.end());
    t.channelOf.assign(l.columns, -1);
    for (const std::size_t c : d.chosen) {
        t.channelOf[c] = static_cast<int>(t.signals.channels.size());
        t.signals.channels.push_back({t.headings[c].quantity, t.headings[c].marker, {}});
    }
    tellColumns(d, alone);
    return {};
}

/// Headings from the file or from the hints.
Status readHeadings(Table& t, const Hints& hints) {
    const Layout& l = t.layout;
    if (!hints.columns.empty() && hints.columns.size() != l.columns)
        return Status::failure(std::to_string(hints.columns.size()) + " columns are named, but the table has " +
                               std::to_string(l.columns) +
                               "; expected one name per column, \"-\" for one that is not used");
    for (std::size_t c = 0; c < l.columns; ++c) {
        if (hints.columns.empty()) {
            t.headings.push_back(headingOf(l.names[c], l.units[c]));
            continue;
        }
        t.headings.push_back(headingOf(hints.columns[c], ""));
        if (hints.columns[c] != "-" && t.headings.back().quantity == Quantity::None)
            return Status::failure(
                "\"" + hints.columns[c] +
                "\" is no quantity; expected time, displacement, force, angle, NAME_x, NAME_y or -, with a unit in "
                "brackets: \"force[kN]\"");
    }
    return {};
}

bool isMeasured(Quantity q) {
    return q == Quantity::Time || q == Quantity::Displacement || q == Quantity::Force;
}

/// First column of each specimen where specimens stand side by side: the same quantities in the same order, each with
/// its own clock or under its own title. Empty: the table has one specimen.
std::vector<std::size_t> specimensOf(const Table& t) {
    std::vector<std::size_t> at;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        if (t.layout.numeric[c] && isMeasured(t.headings[c].quantity))
            at.push_back(c);
    for (const std::size_t period : {std::size_t{3}, std::size_t{2}}) {
        if (at.size() < 2 * period || at.size() % period != 0)
            continue;
        bool repeats = true, titled = true;
        std::set<Quantity> first;
        for (std::size_t i = 0; i < at.size(); ++i) {
            repeats = repeats && t.headings[at[i]].quantity == t.headings[at[i % period]].quantity;
            titled = titled && (i % period != 0 || !t.layout.titles[at[i]].empty());
            if (i < period)
                first.insert(t.headings[at[i]].quantity);
        }
        if (!repeats || first.size() != period || first.count(Quantity::Force) == 0 ||
            (first.count(Quantity::Time) == 0 && !titled))
            continue;
        std::vector<std::size_t> starts;
        for (std::size_t i = 0; i < at.size(); i += period)
            starts.push_back(at[i]);
        return starts;
    }
    return {};
}

std::string titleOf(const Layout& l, std::size_t from, std::size_t to, std::size_t number) {
    for (std::size_t c = from; c < to; ++c)
        if (!l.titles[c].empty())
            return l.titles[c];
    return "specimen " + std::to_string(number);
}

} // namespace

std::string columnText(const Table& t, std::size_t c) {
    const std::string& text = t.headings[c].text;
    return "column " + std::to_string(c + 1) + (text.empty() ? "" : " \"" + text + "\"");
}

Result<std::vector<Table>> chooseColumns(const std::vector<std::string_view>& lines, Layout&& layout,
                                         const Hints& hints) {
    using Tables = Result<std::vector<Table>>;
    Table whole;
    whole.layout = std::move(layout);
    const Layout& l = whole.layout;
    const std::size_t heading = l.namesLine > 0 ? std::max(l.namesLine, l.unitsLine) : l.firstDataLine;
    const auto failed = [&](const std::string& why, std::size_t column) {
        return Tables::failure(std::to_string(heading) + ":" +
                               std::to_string(columnOf(lines[heading - 1], l.separator, column)) + ": " + why);
    };
    if (const Status read = readHeadings(whole, hints); !read)
        return failed(read.error(), 0);
    std::vector<std::size_t> starts = specimensOf(whole);
    const bool alone = starts.empty();
    if (alone)
        starts = {0};
    starts.push_back(l.columns);
    std::vector<Table> tables;
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
        Draft d{lines, whole, {}, 0};
        for (std::size_t c = 0; c < l.columns && !alone; ++c)
            if (c < starts[k] || c >= starts[k + 1])
                d.table.headings[c].quantity = Quantity::None;
        if (!alone)
            d.table.specimen = titleOf(l, starts[k], starts[k + 1], k + 1);
        if (const Status chosen = choose(d, hints, alone); !chosen)
            return failed(chosen.error(), d.wrong);
        if (d.table.signals.channels.empty()) {
            std::string names;
            for (const std::string& n : l.names)
                names += (names.empty() ? "\"" : ", \"") + n + "\"";
            return failed((l.namesLine == 0 ? "there are no headings" : "no column is recognised among " + names) +
                              "; expected time, displacement and force, or name them with --columns " +
                              exampleOfColumns(l.columns),
                          0);
        }
        tables.push_back(std::move(d.table));
    }
    return tables;
}

} // namespace supercircle::importing
