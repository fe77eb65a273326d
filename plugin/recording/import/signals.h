#pragma once
// Columns of an export as channels in SI units, with corrections. Every correction is reported.

#include "plugin/recording/import/layout.h"
#include "plugin/recording/import/quantity.h"
#include "plugin/recording/import/text.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::importing {

/// A remark: understood, assumed, doubtful, corrected or left out.
struct Remark {
    enum class Kind { Understood, Assumed, Doubtful, Corrected, Omitted } kind = Kind::Understood;
    std::size_t line = 0; ///< of the export, from 1; 0: the file as a whole
    std::string what;
};

const char* word(Remark::Kind kind); ///< "understood", "assumed", ...

struct Channel {
    Quantity quantity = Quantity::None;
    std::string marker;         ///< name of the marker
    std::vector<double> values; ///< SI; NaN: missing
};

/// Channels with equal numbers of rows.
struct Signals {
    std::vector<Channel> channels;
    std::vector<std::size_t> line;   ///< of each row, from 1
    std::vector<std::size_t> breaks; ///< rows before a repeated header
    double clockStart = 0.0;         ///< s, clock reading that became 0
    [[nodiscard]] std::size_t rows() const { return line.size(); }
    std::vector<double>* find(Quantity quantity);
    [[nodiscard]] const std::vector<double>* find(Quantity quantity) const;
    /// Rows first to last - 1.
    [[nodiscard]] Signals part(std::size_t first, std::size_t last) const;
    void erase(const std::vector<char>& gone); ///< removes marked rows
};

/// Information given by the user.
struct Hints {
    std::vector<std::string> columns; ///< "displacement[mm]", "force[N]", "-": per column; empty: from the headings
    double rate = 0.0;                ///< Hz, without times; 0: unknown
    double speed = 0.0;               ///< m/s, of the crosshead, without times; 0: unknown
    int displacementSign = 0;         ///< of the column while the crosshead approaches; 0: from the data
    int forceSign = 0;                ///< of the column while the specimen resists; 0: from the data
    double driveTolerance = 0.0;      ///< m; 0: from the data
    int fromTurningPoint = 0;         ///< angles: rows before this turning point are removed; 0: none
    int average = 1;                  ///< angles: number of rows averaged into one
};

/// The table of an export with the columns that are used, in SI units.
struct Table {
    Layout layout;
    std::vector<Heading> headings; ///< per column of the file
    std::vector<int> channelOf;    ///< per column: index into track.channels, -1: not used
    Signals signals;
    std::vector<Remark> remarks;
};

/// Names for --columns that a table of so many columns could have.
std::string exampleOfColumns(std::size_t columns);

/// Reads the table of a text. Errors name line, column and what was expected: "LINE:COLUMN: ...".
Result<Table> readTable(const Text& text, const Hints& hints);

/// Sets the times: from a corrected column (clocks set back, coarse clocks, missing times), or from rate or speed.
/// Errors: "LINE:1: what is wrong".
Status repairTime(Signals& signals, const Hints& hints, const std::vector<HeaderEntry>& metadata,
                  std::vector<Remark>& remarks);

/// Splits consecutive tests of one file: at a restarted clock with the crosshead at its start, or below a repeated
/// header.
std::vector<Signals> splitRuns(Signals&& signals, std::vector<Remark>& remarks);

/// Removes resets of the displacement counter.
void repairCounter(Signals& signals, std::vector<Remark>& remarks);

/// Sets signs: displacement grows towards the specimen, the force is positive while it resists. The displacement starts
/// at zero.
void orient(Signals& signals, const Hints& hints, std::vector<Remark>& remarks);

/// Remarks of one kind about many rows: the first few one by one, the rest as a number.
class Tally {
public:
    Tally(Remark::Kind kind, std::string rest) : kind_(kind), rest_(std::move(rest)) {}
    void add(std::vector<Remark>& remarks, std::size_t line, const std::string& what) {
        if (++count_ <= 3)
            remarks.push_back({kind_, line, what});
    }
    void finish(std::vector<Remark>& remarks) const {
        if (count_ > 3)
            remarks.push_back({kind_, 0, std::to_string(count_ - 3) + " more " + rest_});
    }
    [[nodiscard]] std::size_t count() const { return count_; }

private:
    Remark::Kind kind_;
    std::string rest_;
    std::size_t count_ = 0;
};

/// Short text of a number for messages.
std::string shown(double value);

} // namespace supercircle::importing
