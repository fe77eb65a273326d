// The decimal marks of a column are the path of least change through all places that each could have (dynamic
// programming over the rows). A change counts in shares of the larger value: a mark at a wrong place costs 0.9 twice.

#include "plugin/recording/import/reading/decimal_marks.h"

#include "plugin/recording/import/whole.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

/// Cells that are right beyond doubt. Halved: five cells of remarks could place a column; doubled: short files that are
/// clear to a person are refused.
constexpr std::size_t kFewestRight = 10;

/// Cells of several marks that no number has. Halved: one such cell of a short file opens the column; doubled: single
/// ones stay lost rows, which are told.
constexpr double kMostUnreadable = 0.005;

/// Zeros that can stand behind a lost mark. Halved: numbers below 1e-3 keep none; doubled: twice the places to try.
constexpr std::size_t kSmall = 6;

/// Digits of a cell and where its decimal mark can be.
struct Digits {
    std::size_t line = 0; ///< index
    bool negative = false, open = false;
    std::string digits;     ///< without marks
    std::size_t behind = 0; ///< digits behind the decimal mark as it stands
    std::size_t marks = 0;
};

/// False: no plain number.
bool takeApart(std::string_view cell, Digits& d) {
    char mark = 0;
    std::size_t run = 0;
    bool groups = true, mixed = false;
    for (std::size_t i = 0; i < cell.size(); ++i) {
        const char c = cell[i];
        if (i == 0 && (c == '-' || c == '+')) {
            d.negative = c == '-';
        } else if (c >= '0' && c <= '9') {
            d.digits += c;
            ++run;
        } else if (c == '.' || c == ',') {
            groups = groups && (d.marks == 0 ? run >= 1 && run <= 3 : run == 3);
            mixed = mixed || (mark != 0 && c != mark);
            mark = c;
            run = 0;
            ++d.marks;
        } else {
            return false;
        }
    }
    d.behind = d.marks > 0 ? run : 0;
    // without a mark all of them may be behind it: 0.0082 becomes 82
    d.open = d.marks == 0 ? d.digits != "0" : groups && run == 3 && !mixed && d.digits.front() != '0';
    return !d.digits.empty() && d.digits.size() <= 15 && (d.marks <= 1 || d.open);
}

double valueOf(const Digits& d, std::size_t behind) {
    return (d.negative ? -1.0 : 1.0) * std::stod(d.digits) / math::pow(10.0, static_cast<double>(behind));
}

double change(double a, double b) {
    const double size = std::max(std::abs(a), std::abs(b));
    return size > 0.0 ? std::abs(a - b) / size : 0.0;
}

/// Digits behind the mark for each cell, by the path of least change.
std::vector<std::size_t> smoothest(const std::vector<Digits>& cells) {
    std::vector<std::vector<std::size_t>> from(cells.size()); // best place of the cell before
    std::vector<double> cost, before, values, valuesBefore;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::size_t places = cells[i].open ? cells[i].digits.size() + (cells[i].marks == 0 ? kSmall : 1) : 1;
        values.resize(places);
        cost.assign(places, 0.0);
        from[i].assign(places, 0);
        for (std::size_t k = 0; k < places; ++k) {
            values[k] = valueOf(cells[i], cells[i].open ? k : cells[i].behind);
            double least = i == 0 ? 0.0 : std::numeric_limits<double>::infinity();
            for (std::size_t m = 0; m < before.size(); ++m)
                if (const double c = before[m] + change(valuesBefore[m], values[k]); c < least) {
                    least = c;
                    from[i][k] = m;
                }
            cost[k] = least;
        }
        before.swap(cost);
        valuesBefore.swap(values);
    }
    std::vector<std::size_t> behind(cells.size());
    auto place = static_cast<std::size_t>(std::min_element(before.begin(), before.end()) - before.begin());
    for (std::size_t i = cells.size(); i-- > 0;) {
        behind[i] = cells[i].open ? place : cells[i].behind;
        place = from[i][place];
    }
    return behind;
}

std::string written(const Digits& d, std::size_t behind, char mark) {
    std::string text = d.digits;
    if (behind > 0) {
        if (behind >= text.size())
            text.insert(0, behind - text.size() + 1, '0');
        text.insert(text.size() - behind, 1, mark);
    }
    return (d.negative ? "-" : "") + text;
}

/// Cells of a column that are numbers, in the lines of the table.
std::vector<Digits> digitsOf(const std::vector<std::string_view>& lines, const Layout& l, std::size_t column) {
    std::vector<Digits> found;
    const std::size_t begin = l.namesLine > 0 ? std::max(l.namesLine, l.unitsLine) : l.firstDataLine - 1;
    for (std::size_t i = begin; i < lines.size(); ++i) { // the first rows may be no rows with these marks
        const std::vector<std::string> cells = cellsOf(lines[i], l);
        Digits d;
        d.line = i;
        if (cells.size() == l.columns && takeApart(cells[column], d))
            found.push_back(std::move(d));
    }
    return found;
}

/// A cell is replaced; cells with the separator in them stay between quotes.
void replaceCell(MarkedLines& m, std::size_t line, std::size_t column, const std::string& text, const Layout& l) {
    std::vector<std::string> cells = cellsOf(m.lines[line], l);
    cells[column] = text;
    std::string whole;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const bool quoted = cells[c].find(l.separator) != std::string::npos;
        whole += c == 0 ? "" : std::string(1, l.separator);
        whole += (quoted ? "\"" : "") + cells[c] + (quoted ? "\"" : "");
    }
    m.texts.push_back(std::move(whole));
    m.lines[line] = m.texts.back();
}

void placeColumn(const Table& t, std::size_t column, MarkedLines& m) {
    const Layout& l = t.layout;
    const std::vector<double>& values = t.signals.channels[static_cast<std::size_t>(t.channelOf[column])].values;
    const bool jumps = jumpsTooOften(values, t.headings[column].quantity);
    if (!jumps && static_cast<double>(t.lost + t.odd) <= kMostUnreadable * static_cast<double>(values.size()))
        return; // a sound file is not read twice
    const std::vector<Digits> cells = digitsOf(m.lines, l, column);
    const auto count = [&](const auto& which) {
        return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), which));
    };
    const std::size_t open = count([](const Digits&d) { return d.open; }),
                      right = count([](const Digits&d) { return d.marks == 1 && !d.open; }),
                      several = count([](const Digits&d) { return d.marks > 1; });
    if (open == 0 || right < kFewestRight ||
        (!jumps && static_cast<double>(several) <= kMostUnreadable * static_cast<double>(cells.size())))
        return;
    const std::vector<std::size_t> behind = smoothest(cells);
    std::size_t moved = 0, first = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (behind[i] == cells[i].behind && cells[i].marks <= 1)
            continue;
        first = moved++ == 0 ? i : first;
    }
    if (moved == 0)
        return;
    const char mark = l.styles[column].decimal;
    const std::string from(cellsOf(m.lines[cells[first].line], l)[column]);
    for (std::size_t i = 0; i < cells.size(); ++i)
        if (cells[i].marks > 0 || behind[i] > 0)
            replaceCell(m, cells[i].line, column, written(cells[i], behind[i], mark), l);
    m.remarks.push_back(
        {Remark::Kind::Doubtful, cells[first].line + 1,
         "a spreadsheet has taken decimal marks of " + columnText(t, column) + " for marks of thousands in " +
             std::to_string(moved) + " of " + std::to_string(cells.size()) + " cells, here first: " + from +
             " is read as " + written(cells[first], behind[first], mark) +
             ", which follows its neighbours; every digit is kept (--accept marks reads them as they stand)"});
    m.decisions.push_back({"decimal marks of " + columnText(t, column), "placed by the neighbours", "as they stand",
                           static_cast<double>(1 + moved), "--accept marks"});
}

} // namespace

MarkedLines placeDecimalMarks(const std::vector<std::string_view>& lines, const Table& t) {
    MarkedLines m;
    if (t.layout.separator == ' ')
        return m; // groups of digits may stand apart
    m.lines = lines;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        if (t.channelOf[c] >= 0 && t.headings[c].quantity != Quantity::Counter)
            placeColumn(t, c, m);
    if (m.texts.empty())
        m.lines.clear();
    return m;
}

} // namespace supercircle::importing
