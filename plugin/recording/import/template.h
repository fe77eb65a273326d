#pragma once
// The description beside the imported runs: what the files say is filled in, what only the experimenter knows is null
// and named.

#include "plugin/recording/import/import.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::importing {

struct TemplateOptions {
    std::string protocol;     ///< empty: not known
    std::string specimenFile; ///< JSON with a specimen, or with any part of an experiment; empty: none
    std::string sceneFile{};  ///< scene of a free mechanism; empty: none
};

struct Description {
    std::string json;                     ///< experiment.json
    std::vector<std::string> todo;        ///< JSON pointers of what is null, with what is expected there
    std::vector<std::string> remarks;     ///< what was worked out: moduli, heights
    std::vector<std::string> supposed;    ///< JSON pointers and values nobody stated: gravity, uncertainties
    std::vector<record::NamedText> files; ///< to lie beside it: the scene
};

/// Protocols that have a template.
const std::vector<std::string>& protocols();

/// An error if the protocol or the specimen file is not understood.
record::Result<Description> describe(const Imported& imported, const TemplateOptions& options);

/// import.json: the account for programs.
std::string accountJson(const Imported& imported, const Description& description);

} // namespace supercircle::importing
