// From lines to channels.

#include "plugin/recording/import/signals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string columnText(const Table& t, std::size_t c) {
    const std::string& text = t.headings[c].text;
    return "column " + std::to_string(c + 1) + (text.empty() ? "" : " \"" + text + "\"");
}

void remark(Table& t, Remark::Kind kind, std::size_t line, const std::string& what) {
    t.remarks.push_back({kind, line, what});
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

/// Without headings: two columns are displacement and force, three begin with the time if the first one grows.
void guessColumns(Table& t, const std::vector<std::string_view>& lines) {
    const Layout& l = t.layout;
    const bool named = std::any_of(t.headings.begin(), t.headings.end(),
                                   [](const Heading& h) { return h.quantity != Quantity::None; });
    std::vector<std::size_t> numeric;
    for (std::size_t c = 0; c < l.columns; ++c)
        if (l.numeric[c])
            numeric.push_back(c);
    if (named || l.namesLine != 0 || numeric.size() < 2 || numeric.size() > 3)
        return;
    bool grows = true;
    double last = -std::numeric_limits<double>::infinity();
    for (std::size_t i = l.firstDataLine - 1; i < lines.size(); ++i) {
        const std::vector<std::string> cells = cellsOf(lines[i], l);
        double v = 0.0;
        if (cells.size() != l.columns || readCell(cells[numeric[0]], l.numbers, v) != Cell::Number)
            continue;
        grows = grows && v > last;
        last = v;
    }
    std::vector<Quantity> guess = {Quantity::Displacement, Quantity::Force};
    if (numeric.size() == 3) {
        if (!grows)
            return;
        guess.insert(guess.begin(), Quantity::Time);
    }
    for (std::size_t k = 0; k < guess.size(); ++k) {
        Heading& h = t.headings[numeric[k]];
        h.quantity = guess[k];
        h.unit = usualUnit(guess[k]);
        h.rank = 1;
        remark(t, Remark::Kind::Assumed, l.firstDataLine,
               "there are no headings: column " + std::to_string(numeric[k] + 1) + " is taken as " + name(guess[k]) +
                   " in " + h.unit.name + " (name them with --columns if this is wrong)");
    }
}

const char* unitsFor(Quantity q) {
    return q == Quantity::Time    ? "s, ms, min, h"
           : q == Quantity::Force ? "N, kN, mN, lbf, kgf"
           : q == Quantity::Angle ? "deg, rad"
                                  : "mm, m, in, um";
}

/// Reports the columns; many markers in one line.
void tellColumns(Table& t) {
    const Layout& l = t.layout;
    const auto isMarker = [&](std::size_t c) {
        return t.headings[c].quantity == Quantity::MarkerX || t.headings[c].quantity == Quantity::MarkerY;
    };
    std::size_t count = 0, firstMarker = 0, lastMarker = 0;
    for (std::size_t c = 0; c < l.columns; ++c)
        if (t.channelOf[c] >= 0 && isMarker(c) && t.headings[c].unitStated) {
            firstMarker = count++ == 0 ? c : firstMarker;
            lastMarker = c;
        }
    std::string idle;
    for (std::size_t c = 0; c < l.columns; ++c) {
        const Heading& h = t.headings[c];
        if (h.quantity == Quantity::None && !h.text.empty() && h.text != "-")
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
        const std::string what = columnText(t, c) + " is " + name(h.quantity) +
                                 (h.marker.empty() ? "" : " of " + h.marker) + " [" + h.unit.name + "]";
        if (h.unitStated)
            remark(t, Remark::Kind::Understood, l.unitsLine > 0 ? l.unitsLine : l.namesLine, what);
        else if (l.namesLine > 0)
            remark(t, Remark::Kind::Assumed, l.namesLine, what + ": no unit is stated");
    }
    if (!idle.empty())
        remark(t, Remark::Kind::Omitted, l.namesLine, idle + ": not needed here");
}

/// The best column of every quantity becomes a channel. An error is about column `wrong`.
Status chooseColumns(Table& t, std::size_t& wrong) {
    const Layout& l = t.layout;
    t.channelOf.assign(l.columns, -1);
    for (std::size_t c = 0; c < l.columns; ++c) {
        const Heading& h = t.headings[c];
        if (h.quantity == Quantity::None)
            continue;
        if (!l.numeric[c]) {
            remark(t, Remark::Kind::Omitted, l.namesLine, columnText(t, c) + " holds no numbers");
            continue;
        }
        if (!h.unknownUnit.empty()) {
            wrong = c;
            return Status::failure(columnText(t, c) + ": \"" + h.unknownUnit + "\" is no unit of " + name(h.quantity) +
                                   "; expected one of " + unitsFor(h.quantity));
        }
        const auto same = std::find_if(t.signals.channels.begin(), t.signals.channels.end(), [&](const Channel& ch) {
            return ch.quantity == h.quantity && ch.marker == h.marker;
        });
        if (same == t.signals.channels.end()) {
            t.channelOf[c] = static_cast<int>(t.signals.channels.size());
            t.signals.channels.push_back({h.quantity, h.marker, {}});
            continue;
        }
        const int channel = static_cast<int>(same - t.signals.channels.begin());
        const std::size_t other =
            static_cast<std::size_t>(std::find(t.channelOf.begin(), t.channelOf.end(), channel) - t.channelOf.begin());
        const bool wins = h.rank > t.headings[other].rank;
        if (wins)
            std::swap(t.channelOf[c], t.channelOf[other]);
        remark(t, Remark::Kind::Omitted, l.namesLine,
               columnText(t, wins ? other : c) + " is also a " + name(h.quantity) + "; " +
                   columnText(t, wins ? c : other) + " is taken (choose with --columns)");
    }
    tellColumns(t);
    return {};
}

/// Rows as they are read: cells are views of the line wherever it has no quotes.
class RowReader {
public:
    explicit RowReader(Table& t) : t_(t), row_(t.signals.channels.size(), kNone) {}
    void read(std::string_view line, std::size_t number) {
        const Layout& l = t_.layout;
        split(line);
        if (isHeader()) {
            if (!again_)
                remark(t_, Remark::Kind::Omitted, number, "the header is repeated");
            again_ = true;
            return;
        }
        bool good = cells_.size() == l.columns, group = false, any = false;
        std::size_t bad = 0;
        for (std::size_t c = 0; good && c < l.columns; ++c) {
            if (t_.channelOf[c] < 0)
                continue;
            double v = kNone;
            const Cell kind = readCell(cells_[c], l.numbers, v, &group);
            good = kind != Cell::Text;
            bad = c;
            any = any || kind == Cell::Number;
            row_[static_cast<std::size_t>(t_.channelOf[c])] =
                kind == Cell::Number ? v * t_.headings[c].unit.factor : kNone;
        }
        if (!good || !any) {
            odd_.add(t_.remarks, number, describeOdd(line, good, bad));
            return;
        }
        grouped_ += group ? 1 : 0;
        if (again_ && t_.signals.rows() > 0)
            t_.signals.breaks.push_back(t_.signals.rows());
        again_ = false;
        for (std::size_t k = 0; k < row_.size(); ++k)
            t_.signals.channels[k].values.push_back(row_[k]);
        t_.signals.line.push_back(number);
    }
    void finish() {
        odd_.finish(t_.remarks);
        if (grouped_ > 0)
            remark(t_, Remark::Kind::Understood, 0,
                   "groups of three digits are marked in " + std::to_string(grouped_) + " rows");
    }

private:
    void split(std::string_view line) {
        if (line.find('"') == std::string_view::npos) {
            splitCells(line, t_.layout.separator, cells_);
            if (cells_.size() == t_.layout.columns + 1 && cells_.back().empty())
                cells_.pop_back();
            return;
        }
        quoted_ = cellsOf(line, t_.layout);
        cells_.assign(quoted_.begin(), quoted_.end());
    }
    [[nodiscard]] bool isHeader() const {
        const Layout& l = t_.layout;
        const auto same = [&](const std::vector<std::string>& names) {
            return std::equal(cells_.begin(), cells_.end(), names.begin(), names.end());
        };
        return (l.namesLine > 0 && same(l.names)) || (l.unitsLine > 0 && same(l.units));
    }
    [[nodiscard]] std::string describeOdd(std::string_view line, bool good, std::size_t bad) const {
        const std::size_t columns = t_.layout.columns;
        std::string shownLine(line.substr(0, 40));
        while (line.size() > 40 && !shownLine.empty() &&
               (static_cast<unsigned char>(line[shownLine.size()]) & 0xC0) == 0x80)
            shownLine.pop_back(); // not within a character
        shownLine = "\"" + shownLine + (line.size() > 40 ? "..." : "") + "\"";
        if (cells_.size() != columns)
            return shownLine + " has " + std::to_string(cells_.size()) + (cells_.size() == 1 ? " cell" : " cells") +
                   " instead of " + std::to_string(columns);
        return good ? shownLine + " holds no number" : shownLine + ": " + columnText(t_, bad) + " holds no number";
    }

    Table& t_;
    std::vector<std::string_view> cells_;
    std::vector<std::string> quoted_;
    std::vector<double> row_;
    Tally odd_{Remark::Kind::Omitted, "lines that are no rows of numbers"};
    std::size_t grouped_ = 0;
    bool again_ = false;
};

void readRows(const std::vector<std::string_view>& lines, Table& t) {
    RowReader reader(t);
    const std::size_t most = lines.size() - (t.layout.firstDataLine - 1);
    for (Channel& c : t.signals.channels)
        c.values.reserve(most);
    t.signals.line.reserve(most);
    for (std::size_t i = t.layout.firstDataLine - 1; i < lines.size(); ++i)
        if (!trimmed(lines[i]).empty())
            reader.read(lines[i], i + 1);
    reader.finish();
}

void describe(const Text& text, Table& t) {
    const Layout& l = t.layout;
    std::string heads = l.namesLine > 0 ? "names on line " + std::to_string(l.namesLine) : "no names of columns";
    if (l.unitsLine > 0)
        heads += ", units on line " + std::to_string(l.unitsLine);
    remark(t, Remark::Kind::Understood, 0,
           text.encoding + ", line ends " + text.lineEnds + ", separated by " + separatorName(l.separator) +
               ", decimal mark " + (l.numbers.decimal == '.' ? "point" : "comma"));
    remark(t, Remark::Kind::Understood, 0,
           std::to_string(l.columns) + (l.columns == 1 ? " column, " : " columns, ") + heads + ", data from line " +
               std::to_string(l.firstDataLine));
    if (l.decimalAssumed)
        remark(t, Remark::Kind::Assumed, l.firstDataLine,
               std::string("every number has three digits behind its ") +
                   (l.numbers.decimal == '.' ? "point" : "comma") + "; it is taken as the decimal mark");
}

} // namespace

const char* word(Remark::Kind kind) {
    switch (kind) {
    case Remark::Kind::Understood:
        return "understood";
    case Remark::Kind::Assumed:
        return "assumed";
    case Remark::Kind::Doubtful:
        return "doubtful";
    case Remark::Kind::Corrected:
        return "corrected";
    case Remark::Kind::Omitted:
        break;
    }
    return "left out";
}

std::vector<double>* Signals::find(Quantity quantity) {
    for (Channel& c : channels)
        if (c.quantity == quantity)
            return &c.values;
    return nullptr;
}

const std::vector<double>* Signals::find(Quantity quantity) const {
    return const_cast<Signals*>(this)->find(quantity);
}

Signals Signals::part(std::size_t first, std::size_t last) const {
    Signals t;
    const auto cut = [&](const auto& from) {
        return std::decay_t<decltype(from)>(from.begin() + static_cast<std::ptrdiff_t>(first),
                                            from.begin() + static_cast<std::ptrdiff_t>(last));
    };
    for (const Channel& c : channels)
        t.channels.push_back({c.quantity, c.marker, cut(c.values)});
    t.line = cut(line);
    for (const std::size_t b : breaks)
        if (b > first && b < last)
            t.breaks.push_back(b - first);
    return t;
}

void Signals::erase(const std::vector<char>& gone) {
    std::size_t to = 0;
    std::vector<std::size_t> place(rows() + 1, 0);
    for (std::size_t i = 0; i < rows(); ++i) {
        place[i] = to;
        if (gone[i])
            continue;
        for (Channel& c : channels)
            c.values[to] = c.values[i];
        line[to++] = line[i];
    }
    for (Channel& c : channels)
        c.values.resize(to);
    line.resize(to);
    for (std::size_t& b : breaks)
        b = place[b];
}

std::string exampleOfColumns(std::size_t columns) {
    std::string list = columns == 1   ? "angle[deg]"
                       : columns == 2 ? "displacement[mm],force[N]"
                                      : "time[s],displacement[mm],force[N]";
    for (std::size_t c = 3; c < columns; ++c)
        list += ",-";
    return list;
}

Result<Table> readTable(const Text& text, const Hints& hints) {
    using Tables = Result<Table>;
    const std::vector<std::string_view> lines = linesOf(text.utf8);
    auto layout = layoutOf(lines);
    if (!layout)
        return Tables::failure(layout.error());
    Table t;
    t.layout = *std::move(layout);
    const std::size_t heading =
        t.layout.namesLine > 0 ? std::max(t.layout.namesLine, t.layout.unitsLine) : t.layout.firstDataLine;
    std::size_t wrong = 0;
    const auto failed = [&](const std::string& why) {
        return Tables::failure(std::to_string(heading) + ":" +
                               std::to_string(columnOf(lines[heading - 1], t.layout.separator, wrong)) + ": " + why);
    };
    describe(text, t);
    if (const Status read = readHeadings(t, hints); !read)
        return failed(read.error());
    guessColumns(t, lines);
    if (const Status chosen = chooseColumns(t, wrong); !chosen)
        return failed(chosen.error());
    if (t.signals.channels.empty()) {
        std::string names;
        for (const std::string& n : t.layout.names)
            names += (names.empty() ? "\"" : ", \"") + n + "\"";
        return failed((t.layout.namesLine == 0 ? "there are no headings" : "no column is recognised among " + names) +
                      "; expected time, displacement and force, or name them with --columns " +
                      exampleOfColumns(t.layout.columns));
    }
    readRows(lines, t);
    if (t.signals.rows() < 2)
        return failed("fewer than two rows of numbers");
    return t;
}

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

} // namespace supercircle::importing
