#pragma once
// Benchmarks: their definition and measurement. Times are wall times of one thread; no test depends on them.

#include "plugin/recording/table/files.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::cli {

/// One line of the table.
struct Measurement {
    std::string name;
    double median = 0.0; ///< ms
    double p95 = 0.0;    ///< ms
    double best = 0.0;   ///< ms
    std::size_t samples = 0;
    std::vector<std::pair<std::string, double>> more; ///< further results, units in the names
    double peakMemory = 0.0;                          ///< MB, largest resident size of the process so far
};

/// A group of measurements that share their preparation.
struct Benchmark {
    std::vector<std::string> names; ///< of its measurements
    bool onRequest = false;         ///< runs only when the filter names it in full
    /// Measures those of `names` for which `wanted` holds and passes each to `done`.
    /// @return empty, or an error
    std::function<std::string(const std::function<bool(const std::string&)>& wanted,
                              const std::function<void(Measurement)>& done)>
        measure;
    std::string prefix = {}; ///< not empty: runs only when the filter begins with this
    /// Called once with all rows of the run and the JSON file ("" if none): further tables and pictures.
    /// @return empty, or why something could not be written
    std::function<std::string(const std::vector<Measurement>& rows, const std::string& json)> finish = {};
};

/// Median, 95 % quantile and best of the samples, ms.
Measurement summarise(std::string name, std::vector<double> milliseconds);

/// Largest resident size of the process so far, MB.
double peakMemory();
/// CPU time of this thread, s: for computers with other load.
double threadCpuSeconds();

/// For Benchmark::finish: writes `files` beside the JSON file, else into `out`, and prints `names`.
std::function<std::string(const std::vector<Measurement>&, const std::string&)>
writesPictures(std::shared_ptr<const std::vector<record::NamedText>> files, std::string names);

/// Wall time of one call, ms.
double timed(const std::function<void()>& work);

/// Calls `work` for half a second and at least ten samples (each of as many calls as fill 50 microseconds), at most
/// 2000 samples.
Measurement repeat(std::string name, const std::function<void()>& work);

/// Parts of a step: one rod, detection, the crossing check.
void addPartBenchmarks(std::vector<Benchmark>& all);
/// Contact problems recorded from a small stack, every method, two tolerances.
void addContactBenchmarks(std::vector<Benchmark>& all);
/// Every method on stacks of 3 to 1350 shells: only when asked for.
void addSolverBenchmarks(std::vector<Benchmark>& all);
/// Stacks of 10 to 1000 shells, and their computed speed-up by threads: only when asked for.
void addScalingBenchmarks(std::vector<Benchmark>& all);
/// Game quality: cost of frames, deviation from laboratory quality; only when asked for.
void addGameBenchmarks(std::vector<Benchmark>& all);
/// Frames that ask for more than their budget: only when asked for.
void addFrameBenchmarks(std::vector<Benchmark>& all);
/// Shells made of welded boxes in the same scenes: only when asked for.
void addWeldedBoxBenchmarks(std::vector<Benchmark>& all);
/// The pictures of the tutorials: only when asked for.
void addGuidePictures(std::vector<Benchmark>& all);
/// The picture of the effects page: only when asked for.
void addEffectsPicture(std::vector<Benchmark>& all);
/// Whole runs of the project's scenes.
void addSceneBenchmarks(std::vector<Benchmark>& all);

} // namespace supercircle::cli
