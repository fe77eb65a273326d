#include "plugin/recording/import/layout.h"

#include "plugin/recording/import/quantity.h"
#include "plugin/recording/import/text.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supercircle::importing {

namespace {

constexpr std::size_t kSample = 3000; ///< lines that decide about separator and decimal mark

/// What a choice of separator and decimal mark makes of the lines.
struct Trial {
    char separator = ',';
    NumberStyle style;
    std::size_t columns = 0, rows = 0, numbers = 0;
    bool onlyGroups = true; ///< every marked number could also be one with groups of three digits
};

void dropLastIfEmpty(std::vector<std::string>& cells, std::size_t columns) {
    if (cells.size() == columns + 1 && cells.back().empty())
        cells.pop_back();
}

std::size_t numbersIn(const std::vector<std::string>& cells, const NumberStyle& style) {
    double ignored = 0.0;
    std::size_t n = 0;
    for (const std::string& c : cells)
        n += readCell(c, style, ignored) == Cell::Number ? 1 : 0;
    return n;
}

/// Lines spread over the file: the head and the rest evenly.
std::vector<std::size_t> sampled(std::size_t lines) {
    std::vector<std::size_t> chosen;
    const std::size_t head = std::min(lines, kSample / 2);
    for (std::size_t i = 0; i < head; ++i)
        chosen.push_back(i);
    const std::size_t step = std::max<std::size_t>(1, (lines - head) / (kSample / 2) + 1);
    for (std::size_t i = head; i < lines; i += step)
        chosen.push_back(i);
    return chosen;
}

Trial attempt(const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen, char separator,
              char decimal) {
    Trial t;
    t.separator = separator;
    t.style.decimal = decimal;
    std::map<std::size_t, std::pair<std::size_t, std::size_t>> byCount; // cells: rows, numbers
    for (const std::size_t i : chosen) {
        std::vector<std::string> cells = cellsOf(lines[i], separator);
        if (!cells.empty() && cells.back().empty())
            cells.pop_back();
        const std::size_t n = numbersIn(cells, t.style);
        if (n == 0 || 2 * n < cells.size())
            continue;
        auto& [rows, numbers] = byCount[cells.size()];
        ++rows;
        numbers += n;
        for (const std::string& c : cells)
            if (const std::size_t mark = c.find(decimal); mark != std::string::npos)
                t.onlyGroups = t.onlyGroups && c.size() - mark == 4 && c[0] != '0' && mark <= 4;
    }
    for (const auto& [columns, counts] : byCount)
        if (counts.first > t.rows || (counts.first == t.rows && counts.second > t.numbers)) {
            t.columns = columns;
            t.rows = counts.first;
            t.numbers = counts.second;
        }
    return t;
}

/// A table of several columns beats a list; more rows beat more columns.
bool better(const Trial& a, const Trial& b) {
    if ((a.columns >= 2) != (b.columns >= 2) && std::max(a.rows, b.rows) < 2 * std::min(a.rows, b.rows) + 1)
        return a.columns >= 2;
    if (a.rows != b.rows)
        return a.rows > b.rows;
    const double pureA = static_cast<double>(a.numbers) / static_cast<double>(a.rows * a.columns);
    const double pureB = static_cast<double>(b.numbers) / static_cast<double>(b.rows * b.columns);
    if (std::abs(pureA - pureB) > 0.02)
        return pureA > pureB;
    return a.numbers > b.numbers;
}

void findNumericColumns(const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen, Layout& l) {
    std::vector<std::size_t> numbers(l.columns, 0), texts(l.columns, 0);
    double ignored = 0.0;
    for (const std::size_t i : chosen) {
        const std::vector<std::string> cells = cellsOf(lines[i], l);
        if (cells.size() != l.columns || 2 * numbersIn(cells, l.numbers) < cells.size())
            continue;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const Cell kind = readCell(cells[c], l.numbers, ignored);
            numbers[c] += kind == Cell::Number ? 1 : 0;
            texts[c] += kind == Cell::Text ? 1 : 0;
        }
    }
    for (std::size_t c = 0; c < l.columns; ++c)
        l.numeric.push_back(numbers[c] > 2 * texts[c]);
}

bool isRow(const std::vector<std::string>& cells, const Layout& l) {
    if (cells.size() != l.columns)
        return false;
    double ignored = 0.0;
    std::size_t n = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const Cell kind = readCell(cells[c], l.numbers, ignored);
        if (l.numeric[c] && kind == Cell::Text)
            return false;
        n += kind == Cell::Number ? 1 : 0;
    }
    return n > 0;
}

/// The first row that is followed by another one (blank lines between them do not count).
std::size_t firstRow(const std::vector<std::string_view>& lines, const Layout& l) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!isRow(cellsOf(lines[i], l), l))
            continue;
        std::size_t next = i + 1;
        while (next < lines.size() && trimmed(lines[next]).empty())
            ++next;
        if (next == lines.size() || isRow(cellsOf(lines[next], l), l))
            return i;
    }
    return lines.size();
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

bool isNames(const std::vector<std::string>& cells, const Layout& l) {
    const std::size_t filled = static_cast<std::size_t>(
        std::count_if(cells.begin(), cells.end(), [](const std::string& c) { return !c.empty(); }));
    return filled > 0 && 2 * numbersIn(cells, l.numbers) < filled && std::any_of(cells.begin(), cells.end(), hasLetter);
}

/// Up to three lines above the first row: names, units, or both, in this order or with units in the names.
void findHeadings(const std::vector<std::string_view>& lines, std::size_t first, Layout& l) {
    std::size_t tried = 0;
    for (std::size_t i = first; i-- > 0 && tried < 3;) {
        if (trimmed(lines[i]).empty())
            continue;
        ++tried;
        std::vector<std::string> cells = cellsOf(lines[i], l);
        if (l.separator == ' ' && cells.size() != l.columns) // names of several words, columns aligned with blanks
            cells.clear();
        if (cells.size() != l.columns || !isNames(cells, l))
            break;
        if (isUnits(cells) && l.unitsLine == 0 && l.namesLine == 0) {
            l.unitsLine = i + 1;
            l.units = cells;
        } else {
            l.namesLine = i + 1;
            l.names = cells;
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

/// A last column that is nearly always empty ("remarks") is one all the same if it has a name.
void widen(const std::vector<std::string_view>& lines, const std::vector<std::size_t>& chosen, Layout& l) {
    if (l.separator == ' ')
        return;
    const std::size_t wide = l.columns + 1;
    std::size_t rows = 0, open = 0, first = lines.size();
    for (const std::size_t i : chosen) {
        const std::vector<std::string> cells = cellsOf(lines[i], l.separator);
        const bool row = 2 * numbersIn(cells, l.numbers) >= l.columns && cells.size() >= l.columns;
        rows += row ? 1 : 0;
        open += row && cells.size() == wide ? 1 : 0;
        first = row ? std::min(first, i) : first;
    }
    if (2 * open <= rows)
        return;
    for (std::size_t i = first, tried = 0; i-- > 0 && tried < 3; ++tried)
        if (const auto names = cellsOf(lines[i], l.separator); names.size() == wide && !names.back().empty()) {
            l.columns = wide;
            return;
        }
}

/// A line of names above a line of as many numbers: "sample_rate, duration" over "1000, 5".
bool readPairs(std::string_view names, std::string_view values, std::size_t valuesLine, Layout& l) {
    for (const char separator : {'\t', ';', ','}) {
        const std::vector<std::string> keys = cellsOf(names, separator), cells = cellsOf(values, separator);
        if (keys.size() < 2 || keys.size() != cells.size() || !std::all_of(keys.begin(), keys.end(), hasLetter) ||
            numbersIn(keys, l.numbers) > 0 || numbersIn(cells, l.numbers) < cells.size())
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

} // namespace

Result<Layout> layoutOf(const std::vector<std::string_view>& lines) {
    const std::vector<std::size_t> chosen = sampled(lines.size());
    Trial best;
    best.separator = 0;
    for (const char separator : {'\t', ';', ',', ' '})
        for (const char decimal : {'.', ','}) {
            const Trial t = attempt(lines, chosen, separator, decimal);
            if (t.rows > 0 && (best.separator == 0 || better(t, best)))
                best = t;
        }
    if (best.separator == 0 || best.rows < 2)
        return Result<Layout>::failure("there is no table of numbers in it; expected lines of numbers separated by "
                                       "commas, semicolons, tabs or blanks");
    Layout l;
    l.separator = best.separator;
    l.numbers = best.style;
    l.columns = best.columns;
    widen(lines, chosen, l);
    findNumericColumns(lines, chosen, l);
    const std::size_t first = firstRow(lines, l);
    if (first == lines.size())
        return Result<Layout>::failure("no two lines of numbers follow each other");
    l.firstDataLine = first + 1;
    findHeadings(lines, first, l);
    if (l.names.empty())
        l.names.assign(l.columns, "");
    if (l.units.empty())
        l.units.assign(l.columns, "");
    readHeader(lines, l.namesLine > 0 ? l.namesLine - 1 : first, l);
    // "12.345" in every cell is a number of thousands in one country and of units in another
    const char other = best.style.decimal == '.' ? ',' : '.';
    const Trial same = attempt(lines, chosen, best.separator, other);
    l.decimalAssumed = best.onlyGroups && same.rows == best.rows && same.numbers == best.numbers &&
                       std::any_of(chosen.begin(), chosen.end(), [&](std::size_t i) {
                           return i >= first && lines[i].find(best.style.decimal) != std::string_view::npos;
                       });
    return l;
}

std::vector<std::string> cellsOf(std::string_view line, const Layout& l) {
    std::vector<std::string> cells = cellsOf(line, l.separator);
    dropLastIfEmpty(cells, l.columns);
    return cells;
}

const char* separatorName(char separator) {
    return separator == ',' ? "comma" : separator == ';' ? "semicolon" : separator == '\t' ? "tab" : "blanks";
}

} // namespace supercircle::importing
