#pragma once
// A comparison of ensembles of stacks as a file (schema stack-ensembles/1) and its result as JSON.

#include "plugin/identification/diagnosis/ensembles.h"
#include "plugin/scene/loader/problem.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

struct EnsembleRequest {
    std::vector<std::string> quantities = {"H0_over_R", "delta_max_over_R", "dissipation_ratio", "snap_fits"};
    diagnosis::Ensemble recorded, nominal;
    std::vector<diagnosis::Ensemble> effects;
};

/// Reads the file and its tables; nothing if it has another schema. It is usable if no problem is an error.
std::optional<EnsembleRequest> readEnsembles(const std::string& file, std::vector<scene::Problem>& problems);

/// diagnosis.json of ensembles.
std::string ensembleJson(const diagnosis::EnsembleDiagnosis& found, std::uint64_t seed);

} // namespace supercircle::cli
