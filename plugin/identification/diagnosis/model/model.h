#pragma once
// Interface of a simulator for the diagnosis: named scalars in, readings at the recorded times out. It knows neither
// rods nor contacts, so the statistics are tested on toy models with known parameters.

#include "plugin/recording/experiment/natural_units.h"

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Transformation between the internal value of a fit and the physical value. A stiffness that is infinite for an
/// absent effect is fitted as its reciprocal, a time constant as its logarithm.
enum class Scale : std::uint8_t { Linear, Reciprocal, ReciprocalSquare, Logarithm };
double toPhysical(Scale scale, double toInternal);
double toInternal(Scale scale, double toPhysical);

/// A scalar that may be fitted. All values are internal ones.
struct Scalar {
    std::string name;
    std::string unit; ///< of the physical value
    std::string about;
    double value = 0.0; ///< stated value; for an effect's amplitude: the effect is absent
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    double step = 0.0; ///< a noticeable change: half-width of the stated interval, or a share of a typical value
    Scale scale = Scale::Linear;
    bool amplitude = false; ///< the effect is absent where all its amplitudes are 0
    bool position = false;  ///< a position on the arc: 0 first end, 1 last end
    int specimen = -1;      ///< it acts only in runs of this specimen; -1: in all
    int run = -1;           ///< it acts only in this run, and is given anew in a further one; -1: in all
    /// Index into Model::batch(): it is the deviation of its specimen, and `step` the scale of the scatter. -1: it is
    /// none.
    int batch = -1;
    bool doubtful = false;  ///< the description states it for the set-up or a specimen, so that it may be wrong
    double precision = 0.0; ///< of a normal prior, 1/step^2; 0: anywhere between the bounds alike
};

/// A parameter that differs between specimens. Their deviations from a common value are normal with a standard
/// deviation tau, whose prior is half-normal.
struct BatchFactor {
    std::string name, unit;
    /// Parameters whose deviations change all readings alike; theirs are contained in its own.
    std::vector<std::string> merged{};
    double stated = 0.0; ///< common value
    double scale = 0.0;  ///< of tau's prior, in the unit of the parameter
};

/// Meaning of the coefficients of a learned law.
struct LearnedCurve {
    std::string state, stateUnit; ///< name of the state, and its unit
    std::string response;         ///< the response: "friction", "bending stiffness", ...
    bool relative = true;         ///< the response is relative to its declared value; otherwise it has `responseUnit`
    std::string responseUnit;
    double from = 0.0, to = 1.0; ///< range of the state that the spline covers
    bool logarithmic = false;    ///< logarithmic scale of the state
    double scale = 1.0;          ///< factor of the response
    /// The response at states in [0, 1], from its coefficients.
    std::vector<double> (*evaluate)(const std::vector<double>& values, const std::vector<double>& at01) = nullptr;
};

/// A derived quantity, amplitude times extent, which runs often determine better than either factor.
struct DerivedQuantity {
    std::string name, unit;
    double factor = 1.0;
    std::size_t amplitude = 0,
                extent = 0; ///< indices of parameters: a linear amplitude that is 0 when absent, and another
};

/// An effect that may be missing, in one variant (a law, a specimen). Several candidates may share a label.
struct CandidateEffect {
    std::string label;
    std::string slot;    ///< material, load, contact, apparatus, sensor
    std::string variant; ///< what distinguishes candidates of one label; may be empty
    std::string law;
    std::vector<Scalar> parameters;
    /// Internal values at which it is noticeable in experiments of this kind; starts of searches. The first is a
    /// relevant amplitude.
    std::vector<std::vector<double>> probes;
    std::vector<DerivedQuantity> derived{};
    /// A learned law: its values are spline coefficients. It is not part of the catalogue.
    bool learned = false;
    LearnedCurve curve{}; ///< of a learned law
    /// Of a stated number that may be wrong: its index in Model::nominal(), which then keeps the stated value while the
    /// candidate's only parameter is the number itself. -1: an effect.
    std::ptrdiff_t number = -1;
    [[nodiscard]] bool isNumber() const { return number >= 0; }
    bool corrects = false; ///< it, too, corrects what the description states, and adds no physics
    std::string acting{};  ///< what acts in the simulation, which acts once; empty: what the label says
};

/// An effect with values.
struct Term {
    std::size_t candidate = 0;
    std::vector<double> values; ///< inner
    double smoothing = 1.0;     ///< weight of the smoothing penalty of a learned law

    [[nodiscard]] bool operator==(const Term&) const = default;
};

/// All parameters of a simulation.
struct ParameterPoint {
    std::vector<double> nominal;
    std::vector<Term> terms;
    /// Standard deviation between specimens of each factor of Model::batch(), in its scale; empty: 1. It weighs the
    /// penalty of deviations and changes no simulation.
    std::vector<double> scatter{};

    [[nodiscard]] bool operator==(const ParameterPoint&) const = default;
};

/// Coarse: derivatives and searches. Fine: residuals. Finer: discretisation error of the fine one.
enum class Fidelity : std::uint8_t { Coarse, Fine, Finer };

/// Readings of a simulated run.
struct Response {
    std::string failure;
    Eigen::VectorXd force;   ///< N, at the recorded times
    Eigen::VectorXd markers; ///< m: x of marker 0 over time, its y, x of marker 1, ...
    /// Times of force jumps, s, finer than the readings; may be empty.
    Eigen::VectorXd jumps{};
    Eigen::VectorXd further{}; ///< channels beside the first one, as RecordedRun::further
    /// The response with a further channel in place of the force, without markers.
    [[nodiscard]] Response withChannel(std::size_t channel) const {
        const auto at = static_cast<Eigen::Index>(channel) * force.size();
        return {failure,
                at + force.size() <= further.size() ? further.segment(at, force.size()) : Eigen::VectorXd(),
                {},
                jumps};
    }
};

/// A parameter of a recorded run that has another value in a further one.
struct ChangedParameter {
    std::string name, unit;
    double from = 0.0, to = 0.0; ///< stated values
};

/// A further run that could be made.
struct CandidateRun {
    std::string description; ///< in words
    std::size_t run = 0;     ///< index of the recorded run that it varies
    /// Motion of the drive, linear in between, s and m, with readings at `rate` Hz. Empty for a model without a drive.
    std::vector<double> time{}, displacement{};
    double rate = 0.0;
    bool specimenReversed = false; ///< the specimens are mounted end for end
    /// Arc fractions of markers added to each specimen for this run.
    std::vector<double> markers{};
    double markerRate = 0.0;                ///< Hz, of frames; 0: not filmed
    experiment::NaturalUnits units{};       ///< of the set-up
    double weight = 1.0;                    ///< of the log-likelihood of the first channel
    std::vector<double> further{};          ///< the same of channels beside it
    bool table = false, drivesLoad = false; ///< as RecordedData
    std::vector<ChangedParameter> changed{};
    double duration = 0.0; ///< s, of a run without a drive
};

/// Readings of a candidate run, with their times.
struct CandidateRunResponse {
    std::string failure;
    Eigen::VectorXd time, force;
    Eigen::VectorXd markerTime{}, markers{}; ///< as Response::markers; empty: no markers
    Eigen::VectorXd jumps{};                 ///< as Response::jumps
    Eigen::VectorXd further{};               ///< as Response::further
};

class Model {
public:
    Model() = default;
    Model(const Model&) = delete;
    Model& operator=(const Model&) = delete;
    virtual ~Model() = default;
    [[nodiscard]] virtual const std::vector<Scalar>& nominal() const = 0;
    [[nodiscard]] virtual const std::vector<CandidateEffect>& candidates() const = 0;
    /// Parameters that differ between specimens; their deviations are scalars of nominal().
    [[nodiscard]] virtual std::vector<BatchFactor> batch() const { return {}; }
    /// The first run with the same simulation: same drive, mounting and reading times.
    [[nodiscard]] virtual std::size_t replicateOf(std::size_t run) const { return run; }
    /// Deterministic; called from several threads at a time.
    [[nodiscard]] virtual Response simulate(std::size_t run, const ParameterPoint& point, Fidelity fidelity,
                                            const std::atomic<bool>* interrupt) const = 0;
    /// The point without what does not change this run: effects on readings, which need no simulation (read() applies
    /// them), and parameters of other specimens.
    [[nodiscard]] virtual ParameterPoint simulated(std::size_t run, const ParameterPoint& point) const {
        (void)run;
        return point;
    }
    virtual void read(std::size_t, const ParameterPoint&, Response&) const {}
    /// Further runs that might discriminate competing hypotheses; none by default.
    [[nodiscard]] virtual std::vector<CandidateRun> candidateRuns() const { return {}; }
    [[nodiscard]] virtual CandidateRunResponse simulateCandidateRun(std::size_t, const ParameterPoint&,
                                                                    const std::atomic<bool>*) const {
        return {"this model has no designs", {}, {}};
    }
    /// Identity of the model, part of the cache key.
    [[nodiscard]] virtual std::string identity() const = 0;
};

/// All nominal parameters as stated, without an effect.
[[nodiscard]] ParameterPoint statedPoint(const Model& model);

} // namespace supercircle::diagnosis
