#pragma once
// The subcommands of the programs: their arguments and exit codes. Exit codes are part of the interface.

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::cli {

enum Exit : int { kDone = 0, kBadInput = 2, kCannotGoOn = 3, kCannotWrite = 4, kInterrupted = 130 };

/// Set by Ctrl-C; long work polls it between steps.
extern std::atomic<bool> interrupted;

/// Experiments may name files outside of their folder (--allow-outside).
extern bool allowOutside;

struct RunArguments {
    std::string scene;
    std::vector<std::string> parameters; ///< NAME=VALUE
    std::int64_t seed = 1;               ///< not negative
    std::string out;                     ///< folder; empty: out/<name of the scene file>
    int threads = 1;
    double fixedDt = 0.0; ///< s, 0: adaptive
    std::string accuracy; ///< empty: the scene's
    bool noReport = false;
    bool quiet = false;
    std::string dump;        ///< folder for FCP2D problems, empty: none
    double checkpoint = 0.0; ///< s of wall clock between states in the output folder, 0: none
    bool resume = false;     ///< continue from the state in the output folder
};

struct ReplayArguments {
    std::string file;
    std::vector<std::string> parameters; ///< NAME=VALUE
    std::vector<std::string> effects;    ///< KEY:NAME=VALUE
    std::string with, carry;             ///< diagnosis.json, or diagnosis.json:LABEL; at most one
    std::string out;                     ///< folder; empty: out/<name of the experiment's folder>_replay
    int elements = 0;                    ///< arcs per specimen, 0: as the resolution has it
    bool coarse = false;                 ///< the quick resolution
    bool quiet = false;
};

struct ImportArguments {
    std::vector<std::string> files;
    std::string out;
    std::string protocol, specimen; ///< empty: not known
    std::string encoding;           ///< of texts that are not UTF; empty: from the bytes
    std::string columns;            ///< a name per column, separated by commas; empty: from the headings
    double rate = 0.0;              ///< Hz, 0: from the file
    double speed = 0.0;             ///< mm/s, 0: from the file
    double tolerance = 0.0;         ///< mm, 0: from the data
    int displacementSign = 0;       ///< of the column towards the specimen, 0: from the data
    int forceSign = 0;              ///< of the column while the specimen resists, 0: from the data
    std::string scene;              ///< of a mechanism that moves by itself; empty: none
    int fromTurningPoint = 0;       ///< angles: from this turning point on; 0: from the start
    int average = 1;                ///< angles: means of so many rows
    std::string units;              ///< of columns without one, separated by commas
    std::string forceZero;          ///< none, T0..T1 in s, or a value in N; empty: from the specimen file or the data
    std::vector<std::string> accept, cut, keep;
    bool quiet = false;
};

struct SensitivityArguments {
    std::string file;
    std::vector<std::string> parameters; ///< NAME=VALUE
    std::vector<std::string> columns;    ///< names to vary, empty: all
    std::string channel;                 ///< whose readings are differentiated; empty: the first one
    bool effects = false;                ///< the amplitudes of all effects too
    std::string out;                     ///< folder; empty: out/<name of the experiment's folder>_sensitivity
    int elements = 0;                    ///< arcs per specimen, 0: as the resolution has it
    bool full = false;                   ///< the resolution for residuals
    int jobs = 1;
    bool quiet = false;
};

struct DiagnoseArguments {
    std::string file;
    std::string out;                  ///< folder; empty: out/<name of the experiment's folder>_diagnosis
    int jobs = 0;                     ///< simulations at a time, 0: as many as there are cores
    std::int64_t seed = 1;            ///< not negative
    std::vector<std::string> effects; ///< laws of the user: NAME:FORMULA, NAME:PARAMETER=START
    std::vector<std::string> without; ///< effects left out of the catalogue
    std::vector<std::string> ablate;  ///< parts left out: whitening, cross_validation, screening, open_set
    double timeLimit = 10.0;          ///< minutes, 0: none
    double cpuLimit = 0.0;            ///< minutes of processor time, 0: none
    bool skipNextExperiment = false;  ///< no next experiment is looked for
    bool quiet = false;
};

struct ValidateArguments {
    std::string data; ///< folder of the reference curves
    std::string out = "out/validation";
    std::string filter; ///< id of an experiment, or part of ids or titles
    bool quick = false;
    int jobs = 1;
};

struct SweepArguments {
    std::string file;
    std::string out;
    std::string seeds;                     ///< in place of the file's, such as "1:20"; empty: the file's
    std::string shard;                     ///< "I/N"; empty: all
    std::string engine = "local";          ///< or "slurm"
    std::string accuracy;                  ///< empty: the scene's
    std::vector<std::string> merge;        ///< folders of shards to merge
    std::vector<std::string> slurmOptions; ///< passed to sbatch
    int jobs = 1;
    bool resume = false;
    bool quiet = false;
};

struct CalibrateArguments {
    std::string file;                    ///< scene, or experiment
    std::string channel;                 ///< of an experiment; empty: the first one
    std::string smooth, abrupt;          ///< opening angles tried, by outcome: "0.75,0.8"
    std::vector<std::string> parameters; ///< NAME=VALUE
    double angleUncertainty = 0.0;       ///< half-width of an opening angle / 2 pi
    double tolerance = 0.002;            ///< of the coefficient at a switch
    std::string out;                     ///< folder; empty: nothing is written
    int jobs = 1;
    bool quiet = false;
};

struct DesignArguments {
    std::string file;                 ///< sweep
    std::string results;              ///< folder of the sweep's results
    std::vector<std::string> targets; ///< NAME=VALUE
    double shells = 0.0;              ///< size of the stack whose spread is computed; 0: that of the sweep
    std::string out;                  ///< folder; empty: RESULTS/design
    bool quiet = false;
};

struct ViewArguments {
    std::string scene;
    std::vector<std::string> parameters; ///< NAME=VALUE
    bool game = false;                   ///< game quality instead of laboratory quality
    bool headless = false;
    int frames = 300; ///< steps of 1/60 s, headless
    std::string png, wav, script, show, record;
};

/// Simulates a scene and writes the results. Returns the exit code, as all subcommands do.
int run(const RunArguments& arguments);
/// Says whether a scene can be started, without running it. A sweep or an experiment goes to the program that reads it.
int check(const std::string& file, const std::vector<std::string>& parameters);
/// Says whether all runs of a sweep can be started, and lists its sets of parameters.
int checkSweep(const std::string& file, const std::vector<std::string>& parameters);
/// Says whether an experiment is valid, and lists its parameters.
int checkExperiment(const std::string& file, const std::vector<std::string>& parameters);
/// Lists the catalogue of effects, or describes the one called `key`.
int effects(const std::string& key);
/// Simulates a recorded experiment and writes what differs.
int replay(const ReplayArguments& arguments);
/// Testing-machine exports as an experiment.
int import(const ImportArguments& arguments);
/// Derivatives of a recorded experiment's simulated readings with respect to its parameters.
int sensitivity(const SensitivityArguments& arguments);
/// Finds out what physics a simulation of a recorded experiment leaves out.
int diagnose(const DiagnoseArguments& arguments);
/// Simulates a scene for sets of parameter values and seeds.
int sweep(const SweepArguments& arguments);
/// The friction coefficient from an observed switch between smooth and abrupt snaps, or from measured force curves.
int calibrate(const CalibrateArguments& arguments);
/// Pairs of parameters that give a target value, from the results of a sweep.
int design(const DesignArguments& arguments);
/// Compares simulations with every solved reference and writes one page.
int validate(const ValidateArguments& arguments);
/// Shows a scene in a window, or headless as a picture.
int view(const ViewArguments& arguments);
/// Measures the benchmarks whose name contains `filter`; `json` is a file for the figures, empty: none.
int bench(const std::string& filter, const std::string& json);

} // namespace supercircle::cli
