#pragma once
// A synthetic case: recordings for a diagnosis, and the answer that stays hidden from it.

#include "tests/blind_benchmark/synthetic_cases/cases.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::blind_benchmark {

struct SyntheticCase {
    std::string failure;
    std::vector<std::pair<std::string, std::string>> files; ///< names and contents in the folder of the recordings
    std::string answer; ///< JSON; checksums of answers are published, so keys and formats stay as they are
};

/// A run that a diagnosis proposes.
struct ProposedRun {
    Drive drive;                   ///< s, m
    double rate = 0.0;             ///< Hz
    std::size_t repeats = 1;       ///< number of repeats
    bool specimenReversed = false; ///< specimens are mounted end for end
    /// Arc fractions of each specimen that are tracked from this run on.
    std::vector<double> markers{};
    double markerRate = 4.0; ///< Hz
};

struct CleanReadings;

/// Largest change of the recorded readings by another resolution, rms in noise standard deviations. Errors of the
/// simulator are as large as what halving the resolution changes (decision 0089).
constexpr double kMaxOwnError = 0.25;

/// Makes the files of a case, bitwise the same every time. Proposed runs are recorded behind the others with the same
/// specimen, effects and sensors. They change nothing in the others but the list of runs in the description.
/// @param replacement readings that replace those of the reference simulator, with the same noise
SyntheticCase makeCase(const CasePlan& plan, const std::vector<ProposedRun>& further = {},
                       const CleanReadings* replacement = nullptr);

/// Writes the whole file or none of it. Throws std::runtime_error where it cannot be written.
void writeAtomically(const std::filesystem::path& file, const std::string& text);

/// Error of the reference simulator in a case, in noise standard deviations: recorded forces against those with twice
/// the nodes, half the steps and twice the contact stiffness.
struct Accuracy {
    std::string failure;
    double rms = 0.0, percentile99 = 0.0; ///< over rows
    double markers = 0.0;                 ///< rms, in standard deviations of the markers' noise
    double detectable = 0.0;              ///< signal of this error, Unexplained::detectable
    /// The same for the readings of the other simulator against the recorded ones.
    double otherRms = 0.0, otherMarkers = 0.0, otherDetectable = 0.0;
};

/// @param other readings of another simulator with the true parameters and effects
Accuracy accuracyOf(const CasePlan& plan, const CleanReadings* other = nullptr);

} // namespace supercircle::blind_benchmark
