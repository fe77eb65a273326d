#pragma once
// Comma-separated values with named columns, in and out, and resampling.
//
// Reading is strict on purpose: a cell that is not a number, a short row or a missing column is an error with its place
// (file:line:column), never a silent zero. Empty cells and "nan" are missing values (NaN).

#include <string>
#include <string_view>
#include <vector>

#include "plugin/recording/table/recording.h"
#include "supercircle/support/result.h"

namespace supercircle::record {

struct CsvOptions {
    char delimiter = ',';
    std::vector<std::string> required; ///< columns that must be there
    std::vector<std::string> ignored;  ///< columns that hold text: left out
};

/// Series from CSV text. `source` is the name used in messages. Lines that are blank or start with '#' are skipped,
/// cells may be quoted, a byte order mark and CRLF line ends are accepted.
[[nodiscard]] Result<Series> parseCsv(std::string_view text, const std::string& source, const CsvOptions& options = {});

/// The same from a file.
[[nodiscard]] Result<Series> readCsv(const std::string& path, const CsvOptions& options = {});

/// Line, from 1, on which data row `row` (from 0) of a CSV text stands; 0: there is no such row. For messages about
/// values that are numbers but make no sense.
[[nodiscard]] std::size_t lineOfRow(std::string_view text, std::size_t row);

/// `text` as one cell, in quotes where parseCsv() would read another text without them. Ends of lines become blanks: a
/// cell does not run over lines.
[[nodiscard]] std::string csvCell(const std::string& text);

/// CSV text of a series: header, then one row per sample, shortest round-trip numbers, '\n' line ends. An error if the
/// columns have different lengths or there are not as many names as columns.
[[nodiscard]] Result<std::string> csvText(const Series& series);

/// Linear interpolation of `column` at the abscissae `at` of column `abscissa`, which must not decrease and hold no
/// NaN. Where the abscissa repeats (a jump) the last value of the repetition counts; outside its range the end values
/// hold.
/// @return one value per entry of `at`, or why not (names the first row that is out of order, from 0)
[[nodiscard]] Result<std::vector<double>> resample(const std::vector<double>& abscissa,
                                                   const std::vector<double>& column, const std::vector<double>& at);

/// Every column of `series` resampled at the abscissae `at` of the column called `abscissa`.
[[nodiscard]] Result<Series> resampleSeries(const Series& series, const std::string& abscissa,
                                            const std::vector<double>& at);

} // namespace supercircle::record
