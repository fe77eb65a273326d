#pragma once
// The figures of the subcommand `diagnose`, as SVG for its page and the main ones as PNG.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/result.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Name of the improved simulation: "the most probable effect" or "the most probable pair".
std::string improvedBy(const diagnosis::Diagnosis& diagnosis);
/// Force over displacement, recorded and simulated; standardised residual over time with significant windows marked.
std::string runFigure(const diagnosis::Diagnosis& diagnosis, std::size_t run);
/// Standardised residual of each marker coordinate over time with significant windows marked; empty without markers.
std::string markerFigure(const diagnosis::Diagnosis& diagnosis, std::size_t run);
/// A bar for each explanation: effects, "no missing effect", too small to be detected, outside the catalogue.
std::string probabilityFigure(const diagnosis::Diagnosis& diagnosis);
/// The three above as PNG: run_1_diagnosis.png, run_1_markers.png, ..., probabilities.png.
Result<std::vector<record::NamedText>> diagnosisPictures(const diagnosis::Diagnosis& diagnosis);
/// Screening gain of each effect, and its detectable amplitude.
std::string screenFigure(const diagnosis::Diagnosis& diagnosis);
/// A learned law with bands of one and two sigma in the range that the runs cover.
std::string learnedFigure(const diagnosis::Diagnosis& diagnosis, std::size_t law);
/// Cosines between the fitted effects' signatures; empty with fewer than two.
std::string similarityFigure(const diagnosis::Diagnosis& diagnosis);
/// The described specimens with markers and the position of the effect; empty without either.
std::string specimenFigure(const diagnosis::Diagnosis& diagnosis, const experiment::Experiment& experiment);

} // namespace supercircle::cli
