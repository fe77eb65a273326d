#include "plugin/recording/import/reading/cell_units.h"

#include "plugin/recording/import/reading/layout.h"
#include "plugin/recording/import/reading/quantity.h"
#include "plugin/recording/import/reading/text.h"

#include <algorithm>

namespace supercircle::importing {

namespace {

constexpr std::size_t kLongestUnit = 8; ///< bytes; halved: "kN/mm²" is none; doubled: words are

bool isPlainNumber(std::string_view cell) {
    double ignored = 0.0;
    return readCell(cell, {'.'}, ignored) == Cell::Number || readCell(cell, {','}, ignored) == Cell::Number;
}

/// Length of the number that a cell begins with.
std::size_t lengthOfNumber(std::string_view cell) {
    constexpr std::string_view kDigits = "0123456789";
    std::size_t end = std::min(cell.find_first_not_of("0123456789.,+-"), cell.size());
    if (end + 1 < cell.size() && (cell[end] == 'e' || cell[end] == 'E')) {
        const std::size_t sign = cell[end + 1] == '-' || cell[end + 1] == '+' ? 1 : 0;
        const std::size_t power = std::min(cell.find_first_not_of(kDigits, end + 1 + sign), cell.size());
        end = power > end + 1 + sign ? power : end;
    }
    return end;
}

/// A line whose cells are numbers, some of them with units behind.
struct Row {
    std::vector<std::string> numbers, units;
    std::size_t known = 0, other = 0; ///< units that are known, and short words that are none
    bool good = false;
};

Row rowOf(std::string_view line, char separator) {
    Row row;
    for (const std::string& cell : cellsOf(line, separator)) {
        row.numbers.push_back(cell);
        row.units.emplace_back();
        if (cell.empty() || isPlainNumber(cell))
            continue;
        const std::size_t end = lengthOfNumber(cell);
        const std::string unit(trimmed(std::string_view(cell).substr(end)));
        if (end == 0 || unit.size() > kLongestUnit || !isPlainNumber(cell.substr(0, end)) ||
            unit.find_first_of("0123456789") != std::string::npos)
            return row;
        row.numbers.back() = cell.substr(0, end);
        row.units.back() = unit;
        ++(unitOf(unit).measures == Quantity::None ? row.other : row.known);
    }
    row.good = row.numbers.size() > 1;
    return row;
}

bool hasUnits(const Row& row) {
    return row.good && row.known > row.other;
}

/// The separator that makes rows with units, and more of them than without; 0: none does.
char separatorOf(const std::vector<std::string_view>& lines) {
    char best = 0;
    std::size_t most = 1;
    for (const char separator : {'\t', ';', ','}) {
        std::size_t with = 0, without = 0;
        for (const std::size_t i : sampledLines(lines.size())) {
            const Row row = rowOf(lines[i], separator);
            with += hasUnits(row) ? 1 : 0;
            without += row.good && row.known + row.other == 0 && !trimmed(lines[i]).empty() ? 1 : 0;
        }
        if (with > std::max(most, without)) {
            most = with;
            best = separator;
        }
    }
    return best;
}

} // namespace

Result<BareLines> takeUnitsOff(const std::vector<std::string_view>& lines) {
    BareLines bare;
    bare.separator = separatorOf(lines);
    if (bare.separator == 0)
        return bare;
    bare.lines.assign(lines.begin(), lines.end());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Row row = rowOf(lines[i], bare.separator);
        if (!hasUnits(row))
            continue;
        bare.first = bare.first == 0 ? i + 1 : bare.first;
        bare.units.resize(std::max(bare.units.size(), row.units.size()));
        std::string& line = bare.lines[i];
        line.clear();
        for (std::size_t c = 0; c < row.numbers.size(); ++c) {
            const bool quoted = row.numbers[c].find(bare.separator) != std::string::npos;
            line += (c == 0 ? "" : std::string(1, bare.separator)) +
                    (quoted ? "\"" + row.numbers[c] + "\"" : row.numbers[c]);
            std::string& unit = bare.units[c];
            if (unit.empty())
                unit = row.units[c];
            else if (!row.units[c].empty() && row.units[c] != unit)
                return Result<BareLines>::failure(std::to_string(i + 1) + ":1: column " + std::to_string(c + 1) +
                                                  " changes its unit from " + unit + " to " + row.units[c] +
                                                  " here; export again with one unit a column");
        }
    }
    return bare;
}

} // namespace supercircle::importing
