#pragma once
// The laboratory against every solved reference: runs the experiments and writes one page about them.

#include "plugin/lab/validation/experiment.h"
#include "plugin/recording/table/files.h"

namespace supercircle::validation {

/// Runs the experiments of `settings.filter`, up to `settings.jobs` at a time; results in the order of the page. An
/// experiment that cannot be done says why in `failure`.
std::vector<Experiment> runAll(const Settings& settings);

/// Runs one experiment by its id ("T2"); its failure is in the result. Unknown ids give a failure too.
Experiment runOne(const Settings& settings, const std::string& id);

/// Checks that were missed and were not expected to be.
int surprises(const std::vector<Experiment>& all);

/// validation.html (self-contained), validation.json and one validation-ID.png per experiment, drawn but not written.
record::Result<std::vector<record::NamedText>> files(const std::vector<Experiment>& all, const Settings& settings);

} // namespace supercircle::validation
