#pragma once
// Runs the validation experiments: simulations against solved references.

#include "plugin/lab/validation/experiment.h"

namespace supercircle::validation {

/// Runs the experiments of `settings.filter`, up to `settings.jobs` at a time; results in the order of the page. An
/// experiment that cannot be finished says why in `failure`.
std::vector<ValidationExperiment> runAll(const ValidationSettings& settings);

/// Runs one experiment by its id ("two_shells"); its failure is in the result. Unknown ids give a failure too.
ValidationExperiment runOne(const ValidationSettings& settings, const std::string& id);

/// Number of missed checks without a known reason, plus unfinished experiments.
int unexpectedMisses(const std::vector<ValidationExperiment>& all);

} // namespace supercircle::validation
