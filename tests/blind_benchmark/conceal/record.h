#pragma once
// A concealed case: recordings a diagnosis may see, and an answer it may not.

#include "tests/blind_benchmark/conceal/cases.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::oracle {

struct Concealed {
    std::string failure;
    std::vector<std::pair<std::string, std::string>> files; ///< name and text, for the recordings' folder
    std::string answer;                                     ///< JSON
};

/// A run that a diagnosis asked for.
struct Further {
    Drive drive;             ///< s, m
    double rate = 0.0;       ///< Hz
    std::size_t repeats = 1; ///< how often it is made
    bool turned = false;     ///< with the specimens mounted end for end
    /// Arc fractions of each specimen that are tracked from this run on.
    std::vector<double> markers{};
    double markerRate = 4.0; ///< Hz
};

struct Clean;

/// Noise units (root mean square of the readings) by which half the resolution may change what the second simulator
/// records. Errors that resolution halves are this large themselves, and half a noise unit that keeps its sign hides an
/// effect of ten deviations.
constexpr double kSureOfItself = 0.25;

/// The files of the same plan are the same bytes every time; further runs are recorded behind the others with the same
/// specimen, effects and sensors, and change nothing in them but the description's list of runs.
/// @param instead readings that take the place of the second simulator's, with the same noise
Concealed conceal(const Plan& plan, const std::vector<Further>& further = {}, const Clean* instead = nullptr);

/// The whole file or none of it, whatever happens meanwhile. Throws std::runtime_error where it cannot be written.
void writeWhole(const std::filesystem::path& file, const std::string& text);

/// The second simulator's own error in a case, in units of the noise that it adds: forces with twice the nodes, half
/// the steps and contacts of twice the stiffness against those that were recorded.
struct Accuracy {
    std::string failure;
    double rms = 0.0, most = 0.0; ///< over rows; `most`: exceeded by a hundredth of them
    double markers = 0.0;         ///< rms in units of the markers' noise
    double detectable = 0.0;      ///< of it, Left::detectable
    /// The same of the other simulator's readings against those that were recorded: of both over all rows, and how well
    /// the best possible test would tell them apart with parameters anywhere inside their intervals.
    double otherRms = 0.0, otherMarkers = 0.0, otherDetectable = 0.0;
};

/// @param other what another simulator reads with the true numbers and effects
Accuracy accuracyOf(const Plan& plan, const Clean* other = nullptr);

} // namespace supercircle::oracle
