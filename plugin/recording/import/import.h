#pragma once
// Import of testing-machine exports as an experiment.

#include "plugin/recording/import/drive.h"
#include "plugin/recording/import/signals.h"
#include "plugin/recording/table/files.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// One file as interpreted.
struct Source {
    std::string file;
    Text text;   ///< encoding and line ends, without the text
    Table table; ///< layout, headings and remarks, without the signals
    std::size_t rows = 0;
    Signals raw;                          ///< the file's numbers before any correction, thinned, for pictures
    std::size_t candidates = 0, lost = 0; ///< lines with the numbers of a row, and how many of them are in no run
};

/// One run.
struct ImportedRun {
    std::size_t source = 0;       ///< index into Imported::sources
    std::string file;             ///< "run_1.csv"
    bool atRest = false;          ///< a table of points read at rest: its times are the numbers of its rows
    Signals signals;              ///< time, displacement, force, angle of the run
    Drive drive;                  ///< empty if there is no displacement
    double rate = 0.0;            ///< Hz
    double forceNoise = 0.0;      ///< N, white noise, from second differences; 0: unknown
    double forceZeroWindow = 0.0; ///< s, first interval whose mean force was subtracted; 0: none
    double forceZero = 0.0;       ///< N, what was subtracted
    double firstContact = 0.0;    ///< m, displacement at first contact; NaN: none
    std::string markersFile;      ///< "run_1_markers.csv"; empty: none
    Signals markers;
    std::vector<Remark> remarks; ///< lines are those of the source
};

struct Imported {
    std::vector<Source> sources;
    std::vector<ImportedRun> runs;
    std::vector<std::string> markerNames;
    bool forceUnitConfirmed = false; ///< the user insists on it
};

/// Reads exports; a file with markers and no force belongs to the run before it. An error names file, line and what was
/// expected.
Result<Imported> readExports(const std::vector<std::string>& files, const Hints& hints);

/// The same for exports in memory, each with a name and its bytes.
Result<Imported> readTexts(std::vector<record::NamedText> texts, const Hints& hints);

/// Report of everything understood, assumed, corrected and left out.
std::string account(const Imported& imported);

/// The gravest thing about an import in one line: rows left out first, then doubts.
std::string worst(const Imported& imported);

/// The CSV files of the runs, by name and content.
Result<std::vector<record::NamedText>> runFiles(const Imported& imported);

} // namespace supercircle::importing
