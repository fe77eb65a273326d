// From lines to channels.

#include "plugin/recording/import/reading/cell_units.h"
#include "plugin/recording/import/reading/decimal_marks.h"
#include "plugin/recording/import/whole.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kManyPartly =
    0.02; ///< of the rows; halved: four bad cells of a short file are a doubt; doubled: 3 in 100 are not
constexpr std::size_t kLongestLine = std::size_t{1} << 20; ///< bytes; 4096 columns take a tenth of it

bool looksLikeNumber(std::string_view cell) {
    const std::size_t sign = !cell.empty() && (cell[0] == '-' || cell[0] == '+') ? 1 : 0;
    return cell.size() > sign && cell[sign] >= '0' && cell[sign] <= '9';
}

/// Rows as they are read: cells are views of the line wherever it has no quotes.
class RowReader {
public:
    explicit RowReader(Table& t) : t_(t), row_(t.signals.channels.size(), kNone) {
        const std::vector<bool>& numeric = t.layout.numeric;
        fewest_ = static_cast<std::size_t>(numeric.rend() - std::find(numeric.rbegin(), numeric.rend(), true));
    }
    void read(std::string_view line, std::size_t number) {
        const Layout& l = t_.layout;
        split(line);
        if (isHeader()) {
            if (!again_)
                remark(t_, Remark::Kind::Omitted, number, "the header is repeated");
            again_ = true;
            return;
        }
        bool good = cells_.size() == l.columns, group = false, any = false, whole = true;
        std::size_t bad = 0;
        for (std::size_t c = 0; good && c < l.columns; ++c) {
            if (t_.channelOf[c] < 0)
                continue;
            double v = kNone;
            const Cell kind = readCell(cells_[c], l.styles[c], v, &group);
            good = kind != Cell::Text;
            bad = c;
            any = any || kind == Cell::Number;
            whole = whole && kind == Cell::Number;
            row_[static_cast<std::size_t>(t_.channelOf[c])] =
                kind == Cell::Number ? v * t_.headings[c].unit.factor : kNone;
        }
        good = good && (whole || !isRemark(bad));
        if (!good || !any) {
            if (t_.otherTable == 0 && saysOther())
                t_.otherTable = number;
            if (good && !t_.specimen.empty())
                return; // a longer specimen goes on beside it
            countLost(number, good);
            odd_.add(t_.remarks, number, describeOdd(line, good, bad));
            return;
        }
        ++t_.candidates;
        grouped_ += group ? 1 : 0;
        if (again_ && t_.signals.rows() > 0)
            t_.signals.breaks.push_back(t_.signals.rows());
        again_ = false;
        if (t_.specimenColumn < cells_.size() && !cells_[t_.specimenColumn].empty()) {
            if (!specimen_.empty() && cells_[t_.specimenColumn] != specimen_)
                t_.signals.renamed.push_back(t_.signals.rows());
            specimen_ = cells_[t_.specimenColumn];
        }
        for (std::size_t k = 0; k < row_.size(); ++k)
            t_.signals.channels[k].values.push_back(row_[k]);
        t_.signals.line.push_back(number);
    }
    /// A line above the table that has the numbers of a row belongs to another table.
    void readAbove(std::string_view line, std::size_t number) {
        split(line);
        const std::size_t filled = static_cast<std::size_t>(
            std::count_if(cells_.begin(), cells_.end(), [](std::string_view c) { return !c.empty(); }));
        above_ += filled >= 2 && countNumbers() == filled && filled >= row_.size() ? 1 : 0;
        firstAbove_ = above_ == 1 && firstAbove_ == 0 ? number : firstAbove_;
    }
    void finish() {
        if (above_ >= 10) { // fewer are values of the header or a table of results
            t_.firstLost = firstAbove_;
            t_.lost += above_;
            t_.candidates += above_;
        }
        odd_.finish(t_.remarks);
        if (static_cast<double>(partly_) > kManyPartly * static_cast<double>(t_.signals.rows()))
            remark(t_, Remark::Kind::Doubtful, firstPartly_,
                   std::to_string(partly_) + " lines, here first, hold a part of the numbers of a row and words in the "
                                             "place of the others: they are left out");
        if (grouped_ > 0)
            remark(t_, Remark::Kind::Understood, 0,
                   "groups of three digits are marked in " + std::to_string(grouped_) + " rows");
    }

private:
    void split(std::string_view line) {
        if (line.find('"') == std::string_view::npos) {
            splitCells(line, t_.layout.separator, cells_);
        } else {
            quoted_ = cellsOf(line, t_.layout);
            cells_.assign(quoted_.begin(), quoted_.end());
        }
        while (cells_.size() > t_.layout.columns && cells_.back().empty())
            cells_.pop_back();
        if (cells_.size() < t_.layout.columns && cells_.size() >= fewest_)
            cells_.resize(t_.layout.columns);
    }
    [[nodiscard]] bool isHeader() const {
        const Layout& l = t_.layout;
        const auto same = [&](const std::vector<std::string>& names) {
            return std::equal(cells_.begin(), cells_.end(), names.begin(), names.end());
        };
        return (l.namesLine > 0 && same(l.names)) || (l.unitsLine > 0 && same(l.units));
    }
    /// Headings of another table: two quantities or units, and not those of this table.
    [[nodiscard]] bool saysOther() const {
        std::size_t known = 0;
        bool other = cells_.size() < t_.headings.size();
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            if (cells_[c].empty() || looksLikeNumber(cells_[c]))
                continue;
            const Unit unit = unitOf(cells_[c]);
            const Heading said = unit.measures == Quantity::None ? headingOf(cells_[c], "") : Heading{};
            known += unit.measures != Quantity::None || said.quantity != Quantity::None ? 1 : 0;
            if (c >= t_.headings.size() || t_.channelOf[c] < 0)
                continue;
            const Heading& here = t_.headings[c];
            other = other || (unit.measures != Quantity::None && unit.factor != here.unit.factor) ||
                    (said.quantity != Quantity::None && said.quantity != here.quantity) ||
                    (said.unitStated && said.unit.factor != here.unit.factor);
        }
        return known >= 2 && other;
    }
    /// Words in a column of numbers that is not needed make a line a remark if it lacks a needed number.
    [[nodiscard]] bool isRemark(std::size_t& column) const {
        const Layout& l = t_.layout;
        double ignored = 0.0;
        for (std::size_t c = 0; c < l.columns; ++c)
            if (l.numeric[c] && t_.channelOf[c] < 0 && readCell(cells_[c], l.styles[c], ignored) == Cell::Text) {
                column = c;
                return true;
            }
        return false;
    }
    /// A line with as many numbers as columns are needed should have been a row.
    void countLost(std::size_t number, bool good) {
        if (good || !hasNeeded()) {
            ++t_.odd;
            const bool partly = cells_.size() == t_.layout.columns && needed() > 0;
            firstPartly_ = partly && partly_ == 0 ? number : firstPartly_;
            partly_ += partly ? 1 : 0;
            return;
        }
        ++t_.candidates;
        t_.firstLost = t_.lost++ == 0 ? number : t_.firstLost;
        if (t_.lostLines.size() < 1000)
            t_.lostLines.push_back(number);
    }
    [[nodiscard]] bool hasNeeded() const {
        return cells_.size() != t_.layout.columns ? countNumbers() >= row_.size() : needed() == row_.size();
    }
    /// Needed cells that look like numbers.
    [[nodiscard]] std::size_t needed() const {
        std::size_t count = 0;
        for (std::size_t c = 0; c < cells_.size(); ++c)
            count += t_.channelOf[c] >= 0 && looksLikeNumber(cells_[c]) ? 1 : 0;
        return count;
    }
    [[nodiscard]] std::size_t countNumbers() const {
        return static_cast<std::size_t>(std::count_if(cells_.begin(), cells_.end(), looksLikeNumber));
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
    std::size_t fewest_ = 0; ///< cells of a row that ends behind its last number
    std::vector<std::string_view> cells_;
    std::vector<std::string> quoted_;
    std::vector<double> row_;
    Tally odd_{Remark::Kind::Omitted, "lines that are no rows of numbers"};
    std::size_t grouped_ = 0, above_ = 0, firstAbove_ = 0, partly_ = 0, firstPartly_ = 0;
    bool again_ = false;
    std::string specimen_; ///< of the row before
};

void readRows(const std::vector<std::string_view>& lines, Table& t) {
    RowReader reader(t);
    const std::size_t most = lines.size() - (t.layout.firstDataLine - 1);
    for (Channel& c : t.signals.channels)
        c.values.reserve(most);
    t.signals.line.reserve(most);
    const Layout& l = t.layout;
    const std::size_t begin = l.namesLine > 0 ? std::max(l.namesLine, l.unitsLine) : l.firstDataLine - 1;
    for (std::size_t i = 0; i < begin; ++i)
        reader.readAbove(lines[i], i + 1);
    for (std::size_t i = begin; i < lines.size(); ++i)
        if (!trimmed(lines[i]).empty())
            reader.read(lines[i], i + 1);
    reader.finish();
}

/// Reads the rows again where a spreadsheet has moved decimal marks, if that gives more of them.
void readMarkedRows(const std::vector<std::string_view>& lines, const Table& blank, Table& t) {
    MarkedLines placed = placeDecimalMarks(lines, t);
    if (placed.lines.empty())
        return;
    Table again = blank;
    readRows(placed.lines, again);
    for (std::size_t c = 0; c < again.signals.channels.size(); ++c)
        if (jumpsTooOften(again.signals.channels[c].values, again.signals.channels[c].quantity))
            return; // the neighbours do not decide
    if (again.lost > t.lost)
        return;
    again.remarks.insert(again.remarks.end(), placed.remarks.begin(), placed.remarks.end());
    again.layout.decisions.insert(again.layout.decisions.end(), placed.decisions.begin(), placed.decisions.end());
    again.unplaced = t.signals.thinned();
    t = std::move(again);
}

/// Units beside the numbers are those of the columns.
Status addUnits(const BareLines& bare, Layout& l, const Hints& hints) {
    if (bare.separator != l.separator)
        return {};
    for (std::size_t c = 0; c < std::min(l.columns, bare.units.size()); ++c) {
        if (bare.units[c].empty())
            continue;
        if (!l.units[c].empty() && unitOf(l.units[c]).factor != unitOf(bare.units[c]).factor && hints.columns.empty())
            return Status::failure(std::to_string(bare.first) + ":1: column " + std::to_string(c + 1) +
                                   " has two units, " + l.units[c] + " on the line of units and " + bare.units[c] +
                                   " beside its numbers; state the one that holds with --columns " +
                                   exampleOfColumns(l.columns));
        l.units[c] = bare.units[c];
    }
    return {};
}

void describe(const Text& text, const Layout& l, std::vector<Remark>& remarks) {
    std::string heads = l.namesLine > 0 ? "names on line " + std::to_string(l.namesLine) : "no names of columns";
    if (l.unitsLine > 0)
        heads += ", units on line " + std::to_string(l.unitsLine);
    remarks.push_back({Remark::Kind::Understood, 0,
                       text.encoding + ", line ends " + text.lineEnds + ", separated by " + separatorName(l.separator) +
                           ", decimal mark " + (l.numbers.decimal == '.' ? "point" : "comma")});
    remarks.push_back({Remark::Kind::Understood, 0,
                       std::to_string(l.columns) + (l.columns == 1 ? " column, " : " columns, ") + heads +
                           ", data from line " + std::to_string(l.firstDataLine)});
    for (std::size_t c = 0; c < l.columns; ++c)
        if (l.numeric[c] && l.styles[c].decimal != l.numbers.decimal)
            remarks.push_back({Remark::Kind::Understood, l.firstDataLine,
                               "column " + std::to_string(c + 1) + " has decimal " +
                                   (l.styles[c].decimal == '.' ? "points" : "commas")});
    if (l.decimalAssumed)
        remarks.push_back({Remark::Kind::Assumed, l.firstDataLine,
                           std::string("every number has three digits behind its ") +
                               (l.numbers.decimal == '.' ? "point" : "comma") + "; it is taken as the decimal mark"});
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

Signals Signals::thinned() const {
    constexpr std::size_t kRows = 4000; // four for each pixel of a picture
    const std::size_t every = rows() / kRows + 1;
    Signals few;
    for (const Channel& c : channels) {
        few.channels.push_back({c.quantity, c.marker, {}});
        for (std::size_t i = 0; i < c.values.size(); i += every)
            few.channels.back().values.push_back(c.values[i]);
    }
    for (std::size_t i = 0; i < rows(); i += every)
        few.line.push_back(line[i]);
    return few;
}

std::string exampleOfColumns(std::size_t columns) {
    std::string list = columns == 1   ? "angle[deg]"
                       : columns == 2 ? "displacement[mm],force[N]"
                                      : "time[s],displacement[mm],force[N]";
    for (std::size_t c = 3; c < columns; ++c)
        list += ",-";
    return list;
}

Result<std::vector<Table>> readTables(const Text& text, const Hints& hints) {
    using Tables = Result<std::vector<Table>>;
    std::vector<std::string_view> lines = linesOf(text.utf8);
    const auto longest =
        std::max_element(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (longest != lines.end() && longest->size() > kLongestLine)
        return Tables::failure(std::to_string(longest - lines.begin() + 1) + ":1: a line of " +
                               std::to_string(longest->size() >> 20) +
                               " MiB; expected a row of numbers, at most 1 MiB: is this a text of lines and columns?");
    const auto bare = takeUnitsOff(lines);
    if (!bare)
        return Tables::failure(bare.error());
    if (!bare->lines.empty())
        lines.assign(bare->lines.begin(), bare->lines.end());
    auto layout = layoutOf(lines);
    if (!layout)
        return Tables::failure(layout.error());
    if (Status agree = addUnits(*bare, *layout, hints); !agree)
        return Tables::failure(agree.error());
    if (!text.otherEncoding.empty())
        layout->decisions.insert(layout->decisions.begin(),
                                 {"encoding", text.encoding, text.otherEncoding, text.encodingOdds, "--encoding"});
    std::vector<Remark> form;
    describe(text, *layout, form);
    if (bare->first > 0)
        form.push_back({Remark::Kind::Understood, bare->first, "units stand beside the numbers"});
    auto tables = chooseColumns(lines, *std::move(layout), hints);
    if (!tables)
        return tables;
    for (Table& t : *tables) {
        t.remarks.insert(t.remarks.begin(), form.begin(), form.end());
        const Table blank = t;
        readRows(lines, t);
        if (hints.accept.count("marks") == 0)
            readMarkedRows(lines, blank, t);
        if (t.otherTable > 0)
            return Tables::failure(std::to_string(t.otherTable) +
                                   ":1: another table begins here, with other columns or units; put each table into a "
                                   "file of its own");
        if (t.signals.rows() < 2)
            return Tables::failure(std::to_string(t.layout.firstDataLine) + ":1: fewer than two rows of numbers" +
                                   (t.specimen.empty() ? "" : " for " + t.specimen));
    }
    return tables;
}

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

std::string shownLength(double metres) {
    const double size = std::abs(metres);
    if (size >= 1.0)
        return shown(metres) + " m";
    if (size >= 1e-4)
        return shown(1e3 * metres) + " mm";
    return size >= 1e-7 ? shown(1e6 * metres) + " µm" : shown(1e9 * metres) + " nm";
}

} // namespace supercircle::importing
