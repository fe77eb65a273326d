#pragma once
// A concealed case: recordings a diagnosis may see, and an answer it may not.

#include "tests/oracle/conceal/cases.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::oracle {

struct Concealed {
    std::string failure;
    std::vector<std::pair<std::string, std::string>> files; ///< name and text, for the recordings' folder
    std::string answer;                                     ///< JSON
};

Concealed conceal(const Plan& plan);

/// The whole file or none of it, whatever happens meanwhile. Throws std::runtime_error where it cannot be written.
void writeWhole(const std::filesystem::path& file, const std::string& text);

/// The second simulator's own error in a case, in units of the noise that it adds: forces with twice the nodes, half
/// the steps and contacts of twice the stiffness against those that were recorded.
struct Accuracy {
    std::string failure;
    double rms = 0.0, most = 0.0; ///< over rows; `most`: exceeded by a hundredth of them
    double markers = 0.0;         ///< rms in units of the markers' noise
};
Accuracy accuracyOf(const Plan& plan);

} // namespace supercircle::oracle
