#pragma once
// Columns of an export as channels in SI units, with corrections. Every correction is reported.

#include "plugin/recording/import/reading/layout.h"
#include "plugin/recording/import/reading/quantity.h"
#include "plugin/recording/import/reading/text.h"

#include <cstddef>
#include <optional>
#include <set>
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

/// A coordinate of a marker: it goes to the file of markers.
inline bool isMarker(const Channel& c) {
    return c.quantity == Quantity::MarkerX || c.quantity == Quantity::MarkerY;
}

/// Channels with equal numbers of rows.
struct Signals {
    std::vector<Channel> channels;
    std::vector<std::size_t> line;    ///< of each row, from 1
    std::vector<std::size_t> breaks;  ///< rows before a repeated header
    std::vector<std::size_t> renamed; ///< rows from which on another specimen is named; before the runs are split
    double clockStart = 0.0;          ///< s, clock reading that became 0
    bool displacementTurned = false;  ///< the sign of the displacement is not that of the file
    bool forceTurned = false;         ///< the sign of the force is not that of the file
    std::vector<Decision> decisions;
    std::size_t lost = 0; ///< rows removed because their time is out of order
    [[nodiscard]] std::size_t rows() const { return line.size(); }
    std::vector<double>* find(Quantity quantity);
    [[nodiscard]] const std::vector<double>* find(Quantity quantity) const;
    /// Rows first to last - 1.
    [[nodiscard]] Signals part(std::size_t first, std::size_t last) const;
    void erase(const std::vector<char>& gone); ///< removes marked rows
    [[nodiscard]] Signals thinned() const;     ///< every n-th row, a few thousand in all, for pictures
};

/// What becomes the zero of the force.
struct ForceZero {
    enum class Kind { FromData, None, Window, Value } kind = Kind::FromData;
    double from = 0.0, to = 0.0; ///< s, of a window
    double value = 0.0;          ///< N, as the file has it
};

/// Information given by the user.
struct Hints {
    std::optional<Encoding> encoding; ///< of texts without a byte order mark; empty: from the bytes
    std::vector<std::string> columns; ///< "displacement[mm]", "force[N]", "-": per column; empty: from the headings
    double rate = 0.0;                ///< Hz, without times; 0: unknown
    double speed = 0.0;               ///< m/s, of the crosshead, without times; 0: unknown
    int displacementSign = 0;         ///< of the column while the crosshead approaches; 0: from the data
    int forceSign = 0;                ///< of the column while the specimen resists; 0: from the data
    double driveTolerance = 0.0;      ///< m; 0: from the data
    std::vector<Unit> units;          ///< of columns whose heading states none
    std::set<std::string> accept;     ///< faults that are taken as they are: "dropped", "jumps", "marks", "units"
    std::set<std::string> cut;        ///< events from which on rows are removed: "break", "falls", "gaps"
    std::set<std::string> keep;       ///< events whose rows are kept as they are: "saturation"
    bool atRest = false;              ///< without times, rates and speeds rows are points that were read at rest
    ForceZero forceZero;
    int fromTurningPoint = 0; ///< angles: rows before this turning point are removed; 0: none
    int average = 1;          ///< angles: number of rows averaged into one
};

/// The table of a specimen in an export, with the columns that are used, in SI units.
struct Table {
    Layout layout;
    std::string specimen;          ///< as named above its columns; empty: the table has one specimen
    std::vector<Heading> headings; ///< per column of the file
    std::vector<int> channelOf;    ///< per column: index into track.channels, -1: not used
    std::size_t specimenColumn = static_cast<std::size_t>(-1); ///< names or numbers of specimens; -1: there is none
    Signals signals;
    Signals unplaced;                   ///< thinned rows as the file has them, if decimal marks were placed
    std::size_t candidates = 0;         ///< lines with as many numbers as columns are needed
    std::size_t lost = 0;               ///< of these, lines that could not be used
    std::size_t firstLost = 0;          ///< line, from 1
    std::size_t odd = 0;                ///< other lines between and below the rows, headings left out
    std::vector<std::size_t> lostLines; ///< the first thousand of them, from 1
    std::size_t otherTable = 0;         ///< line of headings that say something else, from 1; 0: none
    std::vector<Remark> remarks;
};

inline void remark(Table& t, Remark::Kind kind, std::size_t line, const std::string& what) {
    t.remarks.push_back({kind, line, what});
}

/// Names for --columns that a table of so many columns could have.
std::string exampleOfColumns(std::size_t columns);

/// "column 3 "Force""
std::string columnText(const Table& table, std::size_t column);

/// Decides which column is what, for each specimen of the file. Candidates are scored by their headings, then by their
/// values; what is decided by less than 10 : 1 is asked for. Errors: "LINE:COLUMN: ...".
Result<std::vector<Table>> chooseColumns(const std::vector<std::string_view>& lines, Layout&& layout,
                                         const Hints& hints);

/// Reads the tables of a text, one for each specimen. Errors name line, column and what was expected:
/// "LINE:COLUMN: ...".
Result<std::vector<Table>> readTables(const Text& text, const Hints& hints);

/// Sets the times: from a corrected column (clocks set back, coarse clocks, missing times), or from rate or speed.
/// Errors: "LINE:1: what is wrong".
Status repairTime(Signals& signals, const Hints& hints, const std::vector<HeaderEntry>& metadata,
                  std::vector<Remark>& remarks);

/// Splits consecutive tests of one file: at a restarted clock with the crosshead at its start, below a repeated header,
/// or where a column of specimens names another one and no clock runs on.
std::vector<Signals> splitRuns(Signals&& signals, std::vector<Remark>& remarks);

/// Removes resets of the displacement counter.
void repairCounter(Signals& signals, std::vector<Remark>& remarks);

/// Sets signs: displacement grows towards the specimen, the force is positive while it resists. The displacement starts
/// at zero. Fails where the evidence for a sign is below 10 : 1.
Status orient(Signals& signals, const Hints& hints, std::vector<Remark>& remarks);

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

/// Short text of a length in m with a unit that suits it: "11.96 µm".
std::string shownLength(double metres);

} // namespace supercircle::importing
