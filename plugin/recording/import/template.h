#pragma once
// Description of the imported runs: known values are filled in, the others are null and listed.

#include "plugin/recording/import/import.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::importing {

struct TemplateOptions {
    std::string protocol;     ///< empty: not known
    std::string specimenFile; ///< JSON with a specimen, or with any part of an experiment; empty: none
    std::string sceneFile{};  ///< scene of a free mechanism, or the name of a shipped one; empty: none
};

struct Description {
    std::string json;                     ///< experiment.json
    std::vector<std::string> todo;        ///< JSON pointers of null values, with what is expected
    std::vector<std::string> remarks;     ///< derived values: moduli, heights
    std::vector<std::string> assumed;     ///< JSON pointers and values that are assumed: gravity, uncertainties
    std::vector<record::NamedText> files; ///< further files: the scene
};

/// Protocols that have a template.
const std::vector<std::string>& protocols();

/// Returns an error if the protocol or the specimen file is invalid.
Result<Description> describe(const Imported& imported, const TemplateOptions& options);

/// import.json: the report in JSON.
std::string accountJson(const Imported& imported, const Description& description);

} // namespace supercircle::importing
