#pragma once
// Exports of testing machines as an experiment: what `supercircle import` does, file by file.

#include "plugin/recording/import/drive.h"
#include "plugin/recording/import/track.h"
#include "plugin/recording/table/files.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// One file as it was understood.
struct Source {
    std::string file;
    Text text;   ///< encoding and line ends; the text itself is dropped
    Table table; ///< layout, headings, remarks; the track is dropped
    std::size_t rows = 0;
};

/// One run of the machine.
struct ImportedRun {
    std::size_t source = 0;       ///< index into Imported::sources
    std::string file;             ///< "run_1.csv"
    Track track;                  ///< time, displacement, force, angle of the run
    Drive drive;                  ///< empty if there is no displacement
    double rate = 0.0;            ///< Hz
    double forceNoise = 0.0;      ///< N, white noise, from second differences; 0: unknown
    double forceZeroWindow = 0.0; ///< s, first stretch of time whose mean force was subtracted; 0: none
    double forceZero = 0.0;       ///< N, that mean
    double touch = 0.0;           ///< displacement where the force first leaves its noise, m; NaN: never
    std::string markersFile;      ///< "run_1_markers.csv"; empty: none
    Track markers;
    std::vector<Remark> remarks; ///< lines are those of the source
};

struct Imported {
    std::vector<Source> sources;
    std::vector<ImportedRun> runs;
    std::vector<std::string> markerNames;
};

/// Reads exports; a file with markers but without force belongs to the run before it. An error says file, line and what
/// was expected.
record::Result<Imported> readExports(const std::vector<std::string>& files, const Hints& hints);

/// What was understood, assumed, mended and left out, for people.
std::string account(const Imported& imported);

/// The CSV files of the runs, by name and content.
record::Result<std::vector<record::NamedText>> runFiles(const Imported& imported);

} // namespace supercircle::importing
