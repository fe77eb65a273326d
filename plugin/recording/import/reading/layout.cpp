#include "plugin/recording/import/reading/layout.h"

#include "plugin/recording/import/reading/quantity.h"
#include "plugin/recording/import/reading/text.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace supercircle::importing {

namespace {

constexpr std::size_t kSample = 3000; ///< lines that decide about separator and decimal mark
constexpr std::size_t kTable = 100;   ///< rows that are a table of readings; halved: fewer results may stand above it
/// A quantity that a heading names speaks for a separator. Halved: five to one each; doubled: the odds that are shown
/// are as sure of a line of remarks as of headings.
constexpr double kNamed = 10.0;
constexpr std::size_t kMostColumns = 4096; ///< halved: still ten times what machines write; doubled: twice the memory

std::size_t filledCells(const std::vector<std::string>& cells) {
    return static_cast<std::size_t>(
        std::count_if(cells.begin(), cells.end(), [](const std::string& c) { return !c.empty(); }));
}

/// What a choice of separator makes of the lines.
struct Trial {
    char separator = 0;
    std::size_t columns = 0, rows = 0, numbers = 0, filled = 0;
};

/// A number with either decimal mark.
bool isNumber(const std::string& cell) {
    double ignored = 0.0;
    return readCell(cell, {'.'}, ignored) == Cell::Number || readCell(cell, {','}, ignored) == Cell::Number;
}

std::size_t numbersIn(const std::vector<std::string>& cells) {
    return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), isNumber));
}

Trial attempt(const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen, char separator) {
    Trial t;
    std::map<std::size_t, Trial> byCount; // by the number of cells
    for (const std::size_t i : chosen) {
        const std::vector<std::string> cells = cellsOf(lines[i], separator);
        const std::size_t n = numbersIn(cells), filled = filledCells(cells);
        if (n == 0 || 2 * n < filled)
            continue;
        Trial& same = byCount[cells.size()];
        same.columns = cells.size();
        ++same.rows;
        same.numbers += n;
        same.filled += filled;
    }
    for (const auto& [columns, same] : byCount)
        if (same.rows > t.rows || (same.rows == t.rows && same.numbers > t.numbers))
            t = same;
    t.separator = separator;
    return t;
}

/// A table of several columns beats a list; more rows beat more columns.
bool better(const Trial& a, const Trial& b) {
    if ((a.columns >= 2) != (b.columns >= 2) && std::max(a.rows, b.rows) < 2 * std::min(a.rows, b.rows) + 1)
        return a.columns >= 2;
    if (a.rows != b.rows)
        return a.rows > b.rows;
    const double pureA = static_cast<double>(a.numbers) / static_cast<double>(a.filled);
    const double pureB = static_cast<double>(b.numbers) / static_cast<double>(b.filled);
    if (std::abs(pureA - pureB) > 0.02)
        return pureA > pureB;
    return a.numbers > b.numbers;
}

double scoreOf(const Trial& t) {
    return t.filled == 0 ? 0.0
                         : static_cast<double>(t.rows * t.numbers) / static_cast<double>(t.filled) *
                               (t.columns >= 2 ? 10.0 : 1.0);
}

/// What the cells of a column say about its decimal mark.
struct MarkVotes {
    std::size_t point = 0, comma = 0;         ///< cells that are numbers with it
    std::size_t onlyPoint = 0, onlyComma = 0; ///< with it alone
    std::size_t texts = 0, numbers = 0;       ///< with either
    std::size_t markPoint = 0, markComma = 0; ///< ambiguous cells with this mark: "1.234"
};

void vote(const std::string& cell, MarkVotes& v) {
    double ignored = 0.0;
    const Cell p = readCell(cell, {'.'}, ignored), c = readCell(cell, {','}, ignored);
    const bool point = p == Cell::Number, comma = c == Cell::Number;
    v.point += point ? 1 : 0;
    v.comma += comma ? 1 : 0;
    v.onlyPoint += point && !comma ? 1 : 0;
    v.onlyComma += comma && !point ? 1 : 0;
    v.numbers += point || comma ? 1 : 0;
    v.texts += p == Cell::Text && c == Cell::Text ? 1 : 0;
    if (point && comma) {
        v.markPoint += cell.find('.') != std::string::npos ? 1 : 0;
        v.markComma += cell.find(',') != std::string::npos ? 1 : 0;
    }
}

/// Decimal marks column by column. A column that could have either has that of the file; without any evidence, marks
/// are decimal ones.
void findNumbers(const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen, Layout& l) {
    std::vector<MarkVotes> votes(l.columns);
    std::size_t rows = 0;
    for (const std::size_t i : chosen) {
        const std::vector<std::string> cells = cellsOf(lines[i], l);
        if (cells.size() != l.columns || 2 * numbersIn(cells) < filledCells(cells) || filledCells(cells) == 0)
            continue;
        ++rows;
        for (std::size_t c = 0; c < cells.size(); ++c)
            vote(cells[c], votes[c]);
    }
    std::size_t point = 0, comma = 0, markPoint = 0, markComma = 0;
    for (const MarkVotes& v : votes) {
        point += v.onlyPoint;
        comma += v.onlyComma;
        markPoint += v.markPoint;
        markComma += v.markComma;
    }
    const bool known = point + comma > 0;
    l.numbers.decimal = known ? (comma > point ? ',' : '.') : markComma > markPoint ? ',' : '.';
    l.decimalAssumed = !known && markPoint + markComma > 0;
    l.decisions.push_back(
        {"decimal mark", l.numbers.decimal == '.' ? "point" : "comma", l.numbers.decimal == '.' ? "comma" : "point",
         (1.0 + static_cast<double>(std::max(point, comma))) / (1.0 + static_cast<double>(std::min(point, comma))),
         ""});
    for (const MarkVotes& v : votes) {
        l.styles.push_back({v.point == v.comma ? l.numbers.decimal : v.comma > v.point ? ',' : '.'});
        // a stray number in a column of remarks makes no column of numbers; a short specimen beside a long one does
        l.numeric.push_back(v.numbers > 2 * v.texts && 50 * v.numbers >= rows);
    }
}

bool isUnits(const std::vector<std::string>& cells) {
    std::size_t known = 0, filled = 0;
    for (const std::string& c : cells) {
        filled += c.empty() ? 0 : 1;
        known += unitOf(c).measures != Quantity::None ? 1 : 0;
    }
    return known > 0 && 2 * known >= filled;
}

bool hasLetter(const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
    });
}

bool isNames(const std::vector<std::string>& cells) {
    const std::size_t filled = filledCells(cells);
    return filled > 0 && 2 * numbersIn(cells) < filled && std::any_of(cells.begin(), cells.end(), hasLetter);
}

/// First row of the first table of some length, else of the longest one: a few results may stand above the readings.
std::size_t firstRow(const std::vector<std::string_view>& lines, const Layout& l) {
    std::set<std::string_view> headings;
    std::size_t start = lines.size(), rows = 0, best = lines.size(), most = 1; // one row is no table
    for (std::size_t i = 0; i < lines.size() && most < kTable; ++i) {
        const std::vector<std::string> cells = cellsOf(lines[i], l);
        if (isRow(cells, l)) {
            start = rows++ == 0 ? i : start;
            if (rows > most) {
                most = rows;
                best = start;
            }
        } else if (rows == 1 ? !trimmed(lines[i]).empty() : filledCells(cells) >= 2 && isNames(cells)) {
            // words below a single line of numbers, or headings; the same ones again continue the table
            rows = headings.insert(lines[i]).second ? 0 : rows;
        }
    }
    return best;
}

/// A rule, "-----", or a line of placeholders, "n/a;n/a;n/a".
bool isPlaceholder(const std::vector<std::string>& cells) {
    double ignored = 0.0;
    return filledCells(cells) > 0 && std::all_of(cells.begin(), cells.end(), [&](const std::string& c) {
               return c.find_first_not_of("-=_*+.|: ") == std::string::npos ||
                      readCell(c, {'.'}, ignored) == Cell::Missing;
           });
}

/// Up to three lines above the first row: names, units, or both, in this order or with units in the names.
void findHeadings(const std::vector<std::string_view>& lines, std::size_t first, Layout& l) {
    std::size_t tried = 0;
    for (std::size_t i = first; i-- > 0 && tried < 3;) {
        std::vector<std::string> cells = cellsOf(lines[i], l);
        if (trimmed(lines[i]).empty() || isPlaceholder(cells))
            continue;
        ++tried;
        if (cells.size() == l.columns + 1 && (cells[0] == "#" || cells[0] == "%")) // "# t(s) d(mm) F(N)"
            cells.erase(cells.begin());
        while (cells.size() > l.columns && isNames(cells) && headingOf(cells.back(), "").quantity == Quantity::None)
            cells.pop_back();                                   // a column of remarks without a remark
        if (cells.size() + 1 == l.columns && !l.numeric.back()) // rows end with a separator, names do not
            cells.emplace_back();
        if (cells.size() == l.columns && 2 * numbersIn(cells) >= filledCells(cells))
            continue; // a row with a fault
        if (cells.size() != l.columns || !isNames(cells))
            break;
        if (isUnits(cells) && l.unitsLine == 0 && l.namesLine == 0) {
            l.unitsLine = i + 1;
            l.units = cells;
        } else {
            l.namesLine = i + 1;
            l.names = cells;
            if (i > 0 && (cells = cellsOf(lines[i - 1], l)).size() == l.columns && isNames(cells))
                l.titles = cells;
            break;
        }
    }
    // a single line "s;mm;N" names the columns as well as it can
    if (l.namesLine == 0 && l.unitsLine != 0) {
        l.namesLine = l.unitsLine;
        l.names = l.units;
        l.unitsLine = 0;
        l.units.clear();
    }
}

/// Key and value of a header line: "key: value", "key;value unit", "# key = value".
bool readMetadata(std::string_view line, const Layout& l, HeaderEntry& m) {
    std::string_view text = trimmed(line);
    while (!text.empty() && (text.front() == '#' || text.front() == '%' || text.front() == '"'))
        text = trimmed(text.substr(1));
    if (text.empty())
        return false;
    const std::size_t colon = text.find_first_of(":="),
                      cell = l.separator == ' ' ? text.find('\t') : text.find(l.separator);
    if (colon != std::string_view::npos && colon > 0 && colon < cell) {
        m.key = std::string(trimmed(text.substr(0, colon)));
        std::string_view rest = trimmed(text.substr(colon + 1));
        while (!rest.empty() && (rest.back() == l.separator || rest.front() == l.separator || rest.back() == '"'))
            rest = trimmed(rest.front() == l.separator ? rest.substr(1) : rest.substr(0, rest.size() - 1));
        m.value = std::string(rest);
        return true;
    }
    std::vector<std::string> cells;
    for (const char separator : {l.separator == ' ' ? '\t' : l.separator, ';', '\t'}) // not every header is the table's
        if (cells.size() < 2)
            cells = cellsOf(line, separator);
    m.key = cells.front();
    for (std::size_t i = 1; i < cells.size(); ++i)
        m.value += (m.value.empty() || cells[i].empty() ? "" : " ") + cells[i];
    return !m.key.empty();
}

/// A line of names above a line of as many numbers: "sample_rate, duration" over "1000, 5".
bool readPairs(std::string_view names, std::string_view values, std::size_t valuesLine, Layout& l) {
    for (const char separator : {'\t', ';', ','}) {
        const std::vector<std::string> keys = cellsOf(names, separator), cells = cellsOf(values, separator);
        if (keys.size() < 2 || keys.size() != cells.size() || !std::all_of(keys.begin(), keys.end(), hasLetter) ||
            numbersIn(keys) > 0 || numbersIn(cells) < cells.size())
            continue;
        for (std::size_t c = 0; c < keys.size(); ++c)
            l.metadata.push_back({valuesLine, keys[c], cells[c]});
        return true;
    }
    return false;
}

void readHeader(const std::vector<std::string_view>& lines, std::size_t end, Layout& l) {
    for (std::size_t i = 0; i < end; ++i) {
        if (i + 1 < end && readPairs(lines[i], lines[i + 1], i + 2, l))
            ++i;
        else if (HeaderEntry m{i + 1, {}, {}}; readMetadata(lines[i], l, m))
            l.metadata.push_back(m);
    }
}

/// A separator at the end of every line makes no column.
void dropEmptyEnd(Layout& l) {
    l.names.resize(l.columns);
    l.units.resize(l.columns);
    l.titles.resize(l.columns);
    while (l.columns > 1 && !l.numeric.back() && l.names.back().empty() && l.units.back().empty()) {
        --l.columns;
        for (std::vector<std::string>* cells : {&l.names, &l.units, &l.titles})
            cells->pop_back();
        l.numeric.pop_back();
        l.styles.pop_back();
    }
}

} // namespace

std::vector<std::size_t> sampledLines(std::size_t lines) {
    std::vector<std::size_t> chosen;
    const std::size_t head = std::min(lines, kSample / 2);
    for (std::size_t i = 0; i < head; ++i)
        chosen.push_back(i);
    const std::size_t step = std::max<std::size_t>(1, (lines - head) / (kSample / 2) + 1);
    for (std::size_t i = head; i < lines; i += step)
        chosen.push_back(i);
    return chosen;
}

bool isRow(const std::vector<std::string>& cells, const Layout& l) {
    if (cells.size() != l.columns)
        return false;
    double ignored = 0.0;
    std::size_t n = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const Cell kind = readCell(cells[c], l.styles[c], ignored);
        if (l.numeric[c] && kind == Cell::Text)
            return false;
        n += l.numeric[c] && kind == Cell::Number ? 1 : 0;
    }
    return n > 0;
}

namespace {

/// What a separator makes of the whole file; no firstDataLine: no two lines of numbers follow each other.
Layout layoutWith(const Trial& t, const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen) {
    Layout l;
    l.separator = t.separator;
    l.columns = t.columns;
    findNumbers(lines, chosen, l);
    const std::size_t first = firstRow(lines, l);
    if (first == lines.size())
        return l;
    l.firstDataLine = first + 1;
    findHeadings(lines, first, l);
    dropEmptyEnd(l);
    readHeader(lines, l.namesLine > 0 ? l.namesLine - 1 : first, l);
    return l;
}

/// Score of a separator by what it gives: rows of numbers, and quantities that its headings name.
double scoreOf(const Trial& t, const Layout& l) {
    std::set<Quantity> named;
    for (std::size_t c = 0; l.firstDataLine > 0 && c < l.columns; ++c)
        if (const Quantity q = headingOf(l.names[c], l.units[c]).quantity; l.numeric[c] && q != Quantity::None)
            named.insert(q);
    return scoreOf(t) * math::pow(kNamed, static_cast<double>(named.size()));
}

} // namespace

Result<Layout> layoutOf(const std::vector<std::string_view>& lines) {
    const std::vector<std::size_t> chosen = sampledLines(lines.size());
    Trial best, second;
    for (const char separator : {'\t', ';', ',', ' '}) {
        const Trial t = attempt(lines, chosen, separator);
        const bool wins = t.rows > 0 && (best.rows == 0 || better(t, best));
        const Trial& loser = wins ? best : t;
        second = scoreOf(loser) > scoreOf(second) ? loser : second;
        best = wins ? t : best;
    }
    if (best.rows < 2)
        return Result<Layout>::failure("there is no table of numbers in it; expected lines of numbers separated by "
                                       "commas, semicolons, tabs or blanks");
    if (best.columns > kMostColumns)
        return Result<Layout>::failure("a table of " + std::to_string(best.columns) + " columns; expected at most " +
                                       std::to_string(kMostColumns) + ": export the columns that are needed");
    Layout l = layoutWith(best, lines, chosen);
    if (l.firstDataLine == 0)
        return Result<Layout>::failure("no two lines of numbers follow each other");
    if (second.rows > 0 && second.columns <= kMostColumns)
        l.decisions.insert(l.decisions.begin(),
                           {"separator", separatorName(best.separator), separatorName(second.separator),
                            scoreOf(best, l) / scoreOf(second, layoutWith(second, lines, chosen)), ""});
    return l;
}

std::vector<std::string> cellsOf(std::string_view line, const Layout& l) {
    std::vector<std::string> cells = cellsOf(line, l.separator);
    while (cells.size() > l.columns && cells.back().empty())
        cells.pop_back();
    const auto lastNumber = std::find(l.numeric.rbegin(), l.numeric.rend(), true);
    if (cells.size() < l.columns && cells.size() >= static_cast<std::size_t>(l.numeric.rend() - lastNumber) &&
        lastNumber != l.numeric.rend())
        cells.resize(l.columns);
    return cells;
}

const char* separatorName(char separator) {
    return separator == ',' ? "comma" : separator == ';' ? "semicolon" : separator == '\t' ? "tab" : "blanks";
}

} // namespace supercircle::importing
