#pragma once
// Candidate effects of one experiment: which parameters of each catalogue effect are fitted, on which scale, and from
// which start values. Amplitudes follow the forces, lengths and speeds of the experiment.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/natural_units.h"
#include "supercircle/effects/effect.h"
#include "supercircle/support/result.h"

#include <functional>
#include <vector>

namespace supercircle::diagnosis {

/// Effects on readings only, applied after the simulation.
enum class ReadingEffect : std::uint8_t { None, Drift, Gain, ByTime, ByDisplacement, ByDirection };

/// Maps a candidate's values to a setting of the effect catalogue.
struct EffectMapping {
    effects::Setting base;                ///< with its fixed parameters
    std::vector<std::size_t> parameterAt; ///< catalogue index of each scalar of the candidate
    ReadingEffect readingEffect = ReadingEffect::None;
    /// Makes the setting of all physical values instead, or says why there is none; called from several threads.
    std::function<Result<effects::Setting>(const std::vector<double>&)> make{};
};

/// The setting at internal values of a candidate. Fails where a law of the user has no value.
Result<effects::Setting> settingAt(const EffectMapping& mapping, const CandidateEffect& candidate,
                                   const std::vector<double>& values);

struct CandidateEffects {
    std::vector<CandidateEffect> candidates;
    std::vector<EffectMapping> mappings; ///< one per candidate
};

/// Characteristic scales of an experiment, the units of effect amplitudes.
struct ExperimentScales {
    double force = 1.0;     ///< N, largest
    double travel = 1e-2;   ///< m, of the crosshead
    double speed = 1e-3;    ///< m/s, fastest
    double duration = 10.0; ///< s, longest run
    double radius = 0.02;   ///< m, of the specimens (length / pi for a straight one)
    double length = 0.1;    ///< m
    double modulus = 2e-4;  ///< N m^2
    double bend = 0.0;      ///< 1/m, largest curvature change of a simulated run; 0: unknown
    double gravity = 9.81;  ///< m/s^2, as stated; that of the Earth where none is
    double second = 1.0; ///< s, natural unit of time, a third to three times the fastest travel: for memories of laws
    experiment::NaturalUnits units{};
};
ExperimentScales scalesOf(const experiment::Experiment& experiment);

/// All catalogue effects that can act in this experiment; `without` removes labels (to test "outside the catalogue").
CandidateEffects candidateEffectsFor(const experiment::Experiment& experiment,
                                     const std::vector<std::string>& without = {}, double largestBend = 0.0);

} // namespace supercircle::diagnosis
