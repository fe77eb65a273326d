#include "plugin/recording/table/csv.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"

namespace supercircle::record {

namespace {

struct Cell {
    std::string text;
    std::size_t column = 1; ///< of its first character, from 1
};

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view{}
                                           : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Cells of one line. Returns an empty text, or what is wrong at `errorColumn` (from 1). Quoted cells do not run over
/// lines: a number never needs to.
std::string split(std::string_view line, char delimiter, std::vector<Cell>& cells, std::size_t& errorColumn) {
    cells.clear();
    std::size_t i = 0;
    while (true) {
        Cell cell;
        while (i < line.size() && (line[i] == ' ' || line[i] == '\t') && line[i] != delimiter)
            ++i;
        cell.column = i + 1;
        if (i < line.size() && line[i] == '"') {
            ++i;
            while (i < line.size() && (line[i] != '"' || (i + 1 < line.size() && line[i + 1] == '"'))) {
                cell.text += line[i];
                i += line[i] == '"' ? 2 : 1;
            }
            if (i >= line.size()) {
                errorColumn = cell.column;
                return "quote is not closed";
            }
            ++i;
            while (i < line.size() && (line[i] == ' ' || line[i] == '\t') && line[i] != delimiter)
                ++i;
            if (i < line.size() && line[i] != delimiter) {
                errorColumn = i + 1;
                return "text after the closing quote";
            }
        } else {
            const std::size_t end = std::min(line.find(delimiter, i), line.size());
            cell.text = trimmed(line.substr(i, end - i));
            i = end;
        }
        cells.push_back(std::move(cell));
        if (i >= line.size())
            return {};
        ++i;
    }
}

/// Lines of a text without their ends; blank lines and comments are counted and left out.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {
        if (rest_.substr(0, 3) == "\xEF\xBB\xBF")
            rest_.remove_prefix(3);
    }
    bool next(std::string_view& line) {
        while (!rest_.empty()) {
            const std::size_t end = std::min(rest_.find('\n'), rest_.size());
            line = rest_.substr(0, end);
            rest_.remove_prefix(std::min(end + 1, rest_.size()));
            ++number;
            if (!line.empty() && line.back() == '\r')
                line.remove_suffix(1);
            if (const auto content = trimmed(line); !content.empty() && content.front() != '#')
                return true;
        }
        return false;
    }
    std::size_t number = 0; ///< of the line that next() gave last, from 1

private:
    std::string_view rest_;
};

bool contains(const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "'" : ", '") + name + "'";
    return text.empty() ? "none" : text;
}

class Parser {
public:
    Parser(std::string_view text, const std::string& file, const CsvOptions& choice)
        : source_(file), options_(choice), lines_(text) {}

    Result<Series> run() {
        std::string_view line;
        if (!lines_.next(line))
            return Result<Series>::failure(source_ + ":1:1: no header line: expected the column names");
        if (std::string message = header(line); !message.empty())
            return Result<Series>::failure(std::move(message));
        while (lines_.next(line))
            if (std::string message = row(line); !message.empty())
                return Result<Series>::failure(std::move(message));
        return std::move(series_);
    }

private:
    std::string at(std::size_t column, const std::string& what) const {
        return source_ + ":" + std::to_string(lines_.number) + ":" + std::to_string(column) + ": " + what;
    }

    std::string header(std::string_view line) {
        std::size_t column = 1;
        if (const std::string message = split(line, options_.delimiter, cells_, column); !message.empty())
            return at(column, message);
        for (const Cell& cell : cells_) {
            if (cell.text.empty())
                return at(cell.column, "column without a name");
            if (contains(names_, cell.text))
                return at(cell.column, "column '" + cell.text + "' appears twice");
            names_.push_back(cell.text);
            target_.push_back(contains(options_.ignored, cell.text) ? -1 : static_cast<int>(series_.names.size()));
            if (target_.back() >= 0)
                series_.names.push_back(cell.text);
        }
        for (const auto& name : options_.required)
            if (!contains(series_.names, name))
                return at(1, "no column '" + name + "'; there are " + joined(names_));
        series_.columns.resize(series_.names.size());
        return {};
    }

    std::string row(std::string_view line) {
        std::size_t column = 1;
        if (const std::string message = split(line, options_.delimiter, cells_, column); !message.empty())
            return at(column, message);
        if (cells_.size() != names_.size())
            return at(cells_.size() < names_.size() ? line.size() + 1 : cells_[names_.size()].column,
                      std::to_string(cells_.size()) + " cells, but " + std::to_string(names_.size()) + " columns");
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            if (target_[i] < 0)
                continue;
            double value = std::numeric_limits<double>::quiet_NaN();
            if (!cells_[i].text.empty() && !parseNumber(cells_[i].text, value))
                return at(cells_[i].column, "'" + cells_[i].text + "' in column '" + names_[i] + "' is not a number");
            series_.columns[static_cast<std::size_t>(target_[i])].push_back(value);
        }
        return {};
    }

    const std::string& source_;
    const CsvOptions& options_;
    Lines lines_;
    std::vector<Cell> cells_;
    std::vector<std::string> names_;
    std::vector<int> target_; ///< column of the series, -1: ignored
    Series series_;
};

} // namespace

std::string csvCell(const std::string& text) {
    const bool plain = text.find_first_of(",\"\n\r") == std::string::npos && trimmed(text) == text && text[0] != '#';
    if (plain)
        return text;
    std::string cell = "\"";
    for (const char c : text)
        cell += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' || c == '\r' ? ' ' : c);
    return cell + "\"";
}

Result<Series> parseCsv(std::string_view text, const std::string& source, const CsvOptions& options) {
    return Parser(text, source, options).run();
}

Result<Series> readCsv(const std::string& path, const CsvOptions& options) {
    const Result<std::string> text = readText(path);
    return text ? parseCsv(*text, path, options) : Result<Series>::failure(text.error());
}

std::size_t lineOfRow(std::string_view text, std::size_t row) {
    Lines lines(text);
    std::string_view line;
    for (std::size_t i = 0; i <= row + 1; ++i)
        if (!lines.next(line))
            return 0;
    return lines.number;
}

Result<std::string> csvText(const Series& series) {
    if (series.names.size() != series.columns.size())
        return Result<std::string>::failure("series: " + std::to_string(series.names.size()) + " names for " +
                                            std::to_string(series.columns.size()) + " columns");
    std::string out;
    for (std::size_t i = 0; i < series.names.size(); ++i) {
        if (series.columns[i].size() != series.rows())
            return Result<std::string>::failure("series: column '" + series.names[i] + "' has " +
                                                std::to_string(series.columns[i].size()) + " rows, the first one " +
                                                std::to_string(series.rows()));
        if (i > 0)
            out += ',';
        out += csvCell(series.names[i]);
    }
    out += '\n';
    out.reserve(series.rows() * series.names.size() * 16);
    for (std::size_t row = 0; row < series.rows(); ++row) {
        for (std::size_t i = 0; i < series.columns.size(); ++i) {
            if (i > 0)
                out += ',';
            appendNumber(out, series.columns[i][row]);
        }
        out += '\n';
    }
    return out;
}

Result<std::vector<double>> resample(const std::vector<double>& abscissa, const std::vector<double>& column,
                                     const std::vector<double>& at) {
    using Values = Result<std::vector<double>>;
    if (abscissa.size() != column.size())
        return Values::failure("resample: " + std::to_string(abscissa.size()) + " abscissae for " +
                               std::to_string(column.size()) + " values");
    if (abscissa.empty())
        return Values::failure("resample: no samples");
    for (std::size_t i = 0; i < abscissa.size(); ++i)
        if (std::isnan(abscissa[i]) || (i > 0 && abscissa[i] < abscissa[i - 1]))
            return Values::failure("resample: the abscissa " +
                                   std::string(std::isnan(abscissa[i]) ? "is not a number" : "decreases") + " at row " +
                                   std::to_string(i));
    std::vector<double> result;
    result.reserve(at.size());
    for (const double x : at) {
        if (std::isnan(x))
            return Values::failure("resample: a wanted abscissa is not a number");
        const auto upper = std::upper_bound(abscissa.begin(), abscissa.end(), x);
        const auto i = static_cast<std::size_t>(upper - abscissa.begin());
        if (i == 0 || i == abscissa.size() || abscissa[i - 1] == x) {
            result.push_back(column[i == 0 ? 0 : i - 1]);
            continue;
        }
        const double t = (x - abscissa[i - 1]) / (abscissa[i] - abscissa[i - 1]);
        result.push_back((1.0 - t) * column[i - 1] + t * column[i]);
    }
    return result;
}

Result<Series> resampleSeries(const Series& series, const std::string& abscissa, const std::vector<double>& at) {
    const std::vector<double>* x = series.find(abscissa);
    if (x == nullptr)
        return Result<Series>::failure("resample: no column '" + abscissa + "'; there are " + joined(series.names));
    Series result;
    result.names = series.names;
    for (const auto& column : series.columns) {
        auto values = resample(*x, column, at);
        if (!values)
            return Result<Series>::failure(values.error());
        result.columns.push_back(*std::move(values));
    }
    // The abscissa is what was asked for, also outside the range where it would be held.
    for (std::size_t i = 0; i < series.names.size(); ++i)
        if (series.names[i] == abscissa)
            result.columns[i] = at;
    return result;
}

} // namespace supercircle::record
