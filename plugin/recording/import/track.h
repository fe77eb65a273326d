#pragma once
// The columns of an export as channels in SI units, and the repairs they may need. Every repair says what it did.

#include "plugin/recording/import/layout.h"
#include "plugin/recording/import/quantity.h"
#include "plugin/recording/import/text.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::importing {

/// Something that was understood, assumed, doubted, mended or left out.
struct Remark {
    enum class Kind { Understood, Assumed, Doubtful, Mended, LeftOut } kind = Kind::Understood;
    std::size_t line = 0; ///< of the export, from 1; 0: the file as a whole
    std::string what;
};

const char* word(Remark::Kind kind); ///< "understood", "assumed", ...

struct Channel {
    Quantity quantity = Quantity::None;
    std::string marker;         ///< name of the marker
    std::vector<double> values; ///< SI; NaN: missing
};

/// Channels of equal length.
struct Track {
    std::vector<Channel> channels;
    std::vector<std::size_t> line;   ///< of each row, from 1
    std::vector<std::size_t> breaks; ///< rows before which the header was repeated
    double clockStart = 0.0;         ///< s, the reading of the clock that became 0
    [[nodiscard]] std::size_t rows() const { return line.size(); }
    std::vector<double>* find(Quantity quantity);
    [[nodiscard]] const std::vector<double>* find(Quantity quantity) const;
    /// Rows first to last - 1.
    [[nodiscard]] Track part(std::size_t first, std::size_t last) const;
    void erase(const std::vector<char>& gone); ///< rows that are marked
};

/// What the user knows better than the file.
struct Hints {
    std::vector<std::string> columns; ///< "displacement[mm]", "force[N]", "-": per column; empty: from the headings
    double rate = 0.0;                ///< Hz, where there is no time; 0: unknown
    double speed = 0.0;               ///< of the head, m/s, where there is no time; 0: unknown
    int displacementSign = 0;         ///< of the column when the head moves towards the specimen; 0: from the data
    int forceSign = 0;                ///< of the column when the specimen resists; 0: from the data
    double driveTolerance = 0.0;      ///< m; 0: from the data
    int fromTurn = 0;                 ///< angles: what comes before this turning point is dropped; 0: nothing
    int average = 1;                  ///< angles: rows are means of so many
};

/// The table of an export with the columns that are used, in SI units.
struct Table {
    Layout layout;
    std::vector<Heading> headings; ///< per column of the file
    std::vector<int> channelOf;    ///< per column: index into track.channels, -1: not used
    Track track;
    std::vector<Remark> remarks;
};

/// Names for --columns that a table of so many columns could have.
std::string exampleOfColumns(std::size_t columns);

/// Reads the table of a text. Errors name line, column and what was expected: "LINE:COLUMN: ...".
record::Result<Table> readTable(const Text& text, const Hints& hints);

/// Gives a track its times: from its column, mended (clocks set back, coarse clocks, missing times), or from rate or
/// speed, as hints or header have them.
/// @return empty, or why there are no times: "LINE:1: what is wrong"
std::string mendTime(Track& track, const Hints& hints, const std::vector<Metadata>& metadata,
                     std::vector<Remark>& remarks);

/// Tests that follow each other in one file: where the clock starts again and the head stands where it started, or
/// where the clock starts again below a repeated header (without a clock: at every repeated header).
std::vector<Track> splitRuns(Track&& track, std::vector<Remark>& remarks);

/// Takes resets of the displacement counter out.
void mendCounter(Track& track, std::vector<Remark>& remarks);

/// Turns signs so that displacement grows towards the specimen and the force is positive while it resists; puts the
/// start of the displacement at zero.
void orient(Track& track, const Hints& hints, std::vector<Remark>& remarks);

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
