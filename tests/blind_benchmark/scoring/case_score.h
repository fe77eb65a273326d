#pragma once
// Comparison of a diagnosis with the hidden effects of its case.

#include "tests/blind_benchmark/synthetic_cases/make_case.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::blind_benchmark {

struct CaseScore {
    std::string name, kind, strength, protocol;
    std::vector<std::string> truth;             ///< true labels
    std::string verdict, statement, firstLabel; ///< label of the first effect, may be empty
    std::vector<std::string> confounded;        ///< with the first effect, including it
    bool detected = false;                      ///< an effect is claimed
    bool right = false;                         ///< see scoreCase()
    bool firstLabelRight = false;               ///< the first label is a true one
    bool signUnresolved = false;                ///< the sign of the first effect is not resolved
    double brier = 0.0;
    /// Intersection over union of misfit intervals and true visible intervals, all readings; -1: undefined.
    double overlap = -1.0;
    double overlapForce = -1.0;       ///< the same for the force alone
    double overlapVisible = -1.0;     ///< the same for the visible intervals of the first effect
    double amplitudeError = -1.0;     ///< relative; -1: undefined
    int covered = 0, intervals = 0;   ///< parameters with a true value inside the 90 % interval, and all compared
    std::optional<bool> otherVariant; ///< another variant of the true law was fitted; its parameters are not compared
    double positionError = -1.0;      ///< error of the arc fraction; -1: undefined
    double overNoise = -1.0;          ///< held-out error over the added noise; -1: undefined
    double overTrueModel = -1.0;      ///< held-out error over that of the model with the true effect; -1: undefined
    double detectable = 0.0;          ///< Unexplained::detectable of all effects
    double seconds = 0.0;             ///< elapsed time of the diagnosis, s
    double pAdequate = 0.0, pOutside = 0.0, pFirst = 0.0, pTruth = 0.0;
    std::string nextExperiment;      ///< proposed runs
    bool expectedConclusive = false; ///< the diagnosis expects them to be conclusive
    /// Error of the reference simulator in a proposed run, in noise standard deviations of the mean of its repeats;
    /// infinite:
    /// unknown.
    double proposedRunsOwnError = 0.0;
};

/// A case is right if a true label is among the first effect and its confounded ones. Without an effect no claim is
/// right, and outside the catalogue the verdict that says so.
/// Throws std::runtime_error if a file cannot be read or has no valid content.
CaseScore scoreCase(const std::string& answerFile, const std::string& diagnosisFile);

/// The diagnosis is ambiguous or inconclusive, or identifies a group of confounded effects or an effect of unknown
/// sign.
bool undecided(const CaseScore& j);
/// The diagnosis is right without ambiguity.
bool resolved(const CaseScore& j);

/// Runs that a diagnosis proposes; empty if none. Throws like scoreCase().
std::vector<ProposedRun> proposedRuns(const std::string& diagnosisFile);

} // namespace supercircle::blind_benchmark
