#pragma once
// The figures of the verb `diagnose`, as SVG for its page and the main ones as PNG.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/result.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// What the improved simulation has: "the most probable effect", or that it is two.
std::string improvedBy(const diagnosis::Diagnosis& diagnosis);
/// Force over displacement, recorded and simulated; below over time in noise units what is left, windows marked.
std::string runFigure(const diagnosis::Diagnosis& diagnosis, std::size_t run);
/// What is left of each marker coordinate over time, in noise units, windows marked; empty without markers.
std::string markerFigure(const diagnosis::Diagnosis& diagnosis, std::size_t run);
/// A bar per probability: effects, "nothing", "none of these".
std::string probabilityFigure(const diagnosis::Diagnosis& diagnosis);
/// The three above as PNG: run_1_diagnosis.png, run_1_markers.png, ..., probabilities.png.
record::Result<std::vector<record::NamedText>> diagnosisPictures(const diagnosis::Diagnosis& diagnosis);
/// What the screen explains of the misfit, and the smallest size these runs show.
std::string screenFigure(const diagnosis::Diagnosis& diagnosis);
/// A learned law with its band (one and two deviations) where the runs have been.
std::string learnedFigure(const diagnosis::Diagnosis& diagnosis, std::size_t law);
/// Cosines between the fitted effects' signatures; empty with fewer than two.
std::string similarityFigure(const diagnosis::Diagnosis& diagnosis);
/// The specimens as described, with what was found marked; empty where no place is known.
std::string specimenFigure(const diagnosis::Diagnosis& diagnosis, const experiment::Experiment& experiment);

} // namespace supercircle::cli
