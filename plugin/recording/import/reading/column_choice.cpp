#include "plugin/recording/import/reading/column_choice.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace supercircle::importing {

namespace {

/// Evidence that decides. Halved, 5 : 1 passes for certain; doubled, clear files are asked about.
constexpr double kDecisive = 10.0;

/// One step of rank (a word of the heading) counts as much as decisive evidence of the values.
constexpr double kRankStep = 10.0;

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

const char* unitsFor(Quantity q) {
    return q == Quantity::Time    ? "s, ms, min, h"
           : q == Quantity::Force ? "N, kN, mN, lbf, kgf"
           : q == Quantity::Angle ? "deg, rad"
                                  : "mm, m, in, um";
}

/// Two digits are enough to write it.
bool isRound(double x) {
    const double digits = x / math::pow(10.0, std::floor(math::log10(x)) - 1.0);
    return std::abs(digits - std::round(digits)) < 0.02;
}

/// Hours, minutes and seconds: they are read as seconds, whatever the heading says.
bool isClock(const Draft& d, std::size_t column) {
    const Layout& l = d.table.layout;
    const std::vector<std::string> cells = cellsOf(d.lines[l.firstDataLine - 1], l);
    return column < cells.size() && cells[column].find(':') != std::string::npos;
}

/// A clock in seconds has fractions, and no step that is round in minutes only.
bool saysSeconds(const Draft& d, std::size_t column) {
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

} // namespace

bool mayBeClock(const Draft& d, std::size_t column) {
    const Heading& h = d.table.headings[column];
    if (h.unit.measures == Quantity::Time)
        return true;
    if (h.other || h.unit.measures != Quantity::None || !h.unknownUnit.empty())
        return false;
    const std::vector<double> all = sampleOf(d, column);
    const std::size_t rows = std::min<std::size_t>(all.size(), 1000); // of a long file the sample has gaps
    if (rows < 10)
        return false;
    const double step = (all[rows - 1] - all[0]) / static_cast<double>(rows - 1);
    bool counts = true;
    for (std::size_t i = 1; i < rows; ++i) {
        if (!(all[i] > all[i - 1]) || std::abs(all[i] - all[0] - step * static_cast<double>(i)) > 0.5 * step)
            return false;
        counts = counts && all[i] == all[i - 1] + 1.0;
    }
    return !counts; // numbers of rows say nothing about times
}

std::string columnsOf(const Table& t, std::size_t time) {
    std::string list;
    std::set<Quantity> named;
    for (std::size_t c = 0; c < t.layout.columns; ++c) {
        const Heading& h = t.headings[c];
        const Quantity q = c == time ? Quantity::Time : h.quantity;
        const bool used = q != Quantity::None && q != Quantity::Counter && h.marker.empty() && t.layout.numeric[c] &&
                          named.insert(q).second;
        const std::string unit = h.unit.measures == Quantity::None ? usualUnit(q).name : h.unit.name;
        list += (c == 0 ? "" : ",") + (used ? name(q) + ("[" + unit + "]") : std::string("-"));
    }
    return list;
}

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

Status checkUnit(Draft& d, std::vector<std::size_t>& candidates) {
    Table& t = d.table;
    std::vector<std::size_t> good;
    for (const std::size_t c : candidates)
        if (t.headings[c].unknownUnit.empty())
            good.push_back(c);
    if (good.empty()) {
        const Heading& h = t.headings[candidates.front()];
        d.wrong = candidates.front();
        const bool weight = h.quantity == Quantity::Force && (h.unknownUnit == "kg" || h.unknownUnit == "g");
        if (h.twoUnits)
            return Status::failure(columnText(t, candidates.front()) + " has two units, " + h.unknownUnit +
                                   ": in its name, and below it; state the one that holds with --columns " +
                                   columnsOf(t, t.layout.columns));
        return Status::failure(columnText(t, candidates.front()) + ": \"" + h.unknownUnit + "\" is no unit of " +
                               name(h.quantity) + "; expected one of " + unitsFor(h.quantity) +
                               (weight ? "; a weight is stated with --columns as force[" + h.unknownUnit + "f]"
                                       : "; state it with --columns " + columnsOf(t, t.layout.columns)));
    }
    for (const std::size_t c : candidates)
        if (!t.headings[c].unknownUnit.empty())
            remark(t, Remark::Kind::Omitted, t.layout.namesLine,
                   columnText(t, c) + ": \"" + t.headings[c].unknownUnit + "\" is no unit of " +
                       name(t.headings[c].quantity));
    candidates = good;
    return {};
}

Status completeUnits(Draft& d, const Hints& hints) {
    Table& t = d.table;
    std::string missing, answer;
    for (const std::size_t c : d.chosen) {
        Heading& h = t.headings[c];
        if (h.quantity == Quantity::Time && isClock(d, c)) {
            h.unit = usualUnit(Quantity::Time);
            h.unitStated = true;
        }
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

} // namespace supercircle::importing
