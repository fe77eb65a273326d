#pragma once
// What a diagnosis said of a case against what was hidden in it.

#include "tests/blind_benchmark/conceal/record.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::oracle {

struct Judged {
    std::string name, kind, strength, protocol;
    std::vector<std::string> truth;        ///< labels
    std::string verdict, statement, first; ///< first label, may be empty
    std::vector<std::string> group;        ///< of the first effect
    bool detected = false;                 ///< said that something is missing
    bool right = false;      ///< first-named group holds a true label (nothing: said so; unknown: said so)
    bool firstRight = false; ///< the first label itself is a true one
    bool eitherSide = false; ///< to which side the first effect acts is left open
    double brier = 0.0;
    /// Of marked and true windows in all readings, intersection over union; -1: not defined.
    double overlap = -1.0;
    double overlapForce = -1.0;     ///< the same of the force alone
    double overlapNamed = -1.0;     ///< the same of the windows in which the named effect shows
    double amplitudeError = -1.0;   ///< relative; -1: not defined
    int covered = 0, intervals = 0; ///< parameters whose 90 % interval holds the truth
    std::optional<bool> otherForm;  ///< whether another form of the true law was found; its numbers are not compared
    double placeError = -1.0;       ///< of an arc fraction
    double overNoise = -1.0;        ///< held-out error over the noise that was added
    double overKnowing = -1.0;      ///< over that of the model which has the true effect
    double detectable = 0.0;        ///< what the best possible test would have for a signal (Left::detectable)
    double seconds = 0.0;
    double pNothing = 0.0, pUnknown = 0.0, pFirst = 0.0, pTruth = 0.0;
    std::string next;         ///< runs it proposes
    bool wouldSettle = false; ///< and says that it will settle it
    /// By which the second simulator is off itself in a run that was asked for, in units of the noise of the mean of
    /// its repeats; infinite: not known.
    double furtherOwnError = 0.0;
};

/// Throws std::runtime_error if a file cannot be read or is not what it should be.
Judged judge(const std::string& answerFile, const std::string& diagnosisFile);

/// The diagnosis does not decide: it leaves several effects, one of which may be named for its probability, or says
/// that these runs hold too little.
bool open(const Judged& j);
/// It decides, and rightly: the one effect and no other that could be it, nothing, or none that is known.
bool settled(const Judged& j);

/// The runs that a diagnosis proposes; empty if none. Throws like judge().
std::vector<Further> proposedRuns(const std::string& diagnosisFile);

} // namespace supercircle::oracle
