#pragma once
// What diagnosis knows of a simulator: named scalars in, readings at the recording's own times out. Nothing here knows
// rods or contacts, so the statistics are tested on toy models whose truth is known.

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

/// How an inner number of a fit and the physical value belong together. A stiffness that is infinite where the effect
/// is absent is fitted as its reciprocal, a time constant as its logarithm.
enum class Scale : std::uint8_t { Linear, Reciprocal, ReciprocalSquare, Logarithm };
double outer(Scale scale, double inner);
double inner(Scale scale, double outer);

/// A scalar that may be varied. All numbers are inner ones.
struct Scalar {
    std::string name;
    std::string unit; ///< of the outer value
    std::string about;
    double value = 0.0; ///< stated; of an effect's amplitude: absent
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    double step = 0.0; ///< a change that shows: half-width of the stated interval, or a share of a typical value
    Scale scale = Scale::Linear;
    bool amplitude = false; ///< the effect is absent where all its amplitudes are 0
    bool place = false;     ///< where on the arc it is: 0 first end, 1 last end
};

/// What the coefficients of a learned law mean, for words and pictures.
struct Curve {
    std::string over, unit; ///< the state, and its unit
    std::string of;         ///< what changes with it: "friction", "bending stiffness", ...
    bool relative = true;   ///< the law is a share of what is declared; otherwise it has `ofUnit`
    std::string ofUnit;
    double from = 0.0, to = 1.0; ///< of the state, where the spline ends
    bool logarithmic = false;    ///< in the state
    double scale = 1.0;          ///< of the law's value
    /// The law at states, from its coefficients.
    std::vector<double> (*evaluate)(const std::vector<double>& values, const std::vector<double>& at01) = nullptr;
};

/// What a law is worth in all: its amplitude times how far it reaches, which runs often know far better than either.
struct Product {
    std::string name, unit;
    double factor = 1.0;
    std::size_t amplitude = 0,
                extent = 0; ///< parameters of the candidate: a linear one that is absent at 0, and another
};

/// An effect that may be missing, in one of its forms (a law, a specimen). Several candidates may share a label.
struct Candidate {
    std::string label;
    std::string slot; ///< material, load, contact, apparatus, sensor
    std::string form; ///< what distinguishes candidates of one label, may be empty
    std::string law;
    std::vector<Scalar> parameters;
    /// Inner values at which it shows in experiments of this kind; starts of searches. The first is a size that
    /// matters.
    std::vector<std::vector<double>> probes;
    std::vector<Product> products{};
    /// A law to be learned: its values are coefficients of a spline of a state. It is no part of the catalogue.
    bool learned = false;
    Curve curve{}; ///< of a learned law
};

/// An effect with values.
struct Term {
    std::size_t candidate = 0;
    std::vector<double> values; ///< inner
    double smoothing = 1.0;     ///< of a learned law: weight of its roughness
};

/// Everything that is set in a simulation.
struct Point {
    std::vector<double> nominal;
    std::vector<Term> terms;
};

/// Coarse for derivatives and searches, fine for residuals, finer to know the error of the fine one.
enum class Fineness : std::uint8_t { Coarse, Fine, Finer };

/// Readings of a simulated run.
struct Response {
    std::string failure;
    Eigen::VectorXd force;   ///< N, at the recording's times
    Eigen::VectorXd markers; ///< m: x of marker 0 over time, its y, x of marker 1, ...
    /// When the force jumped, s, finer than the readings tell; may be empty.
    Eigen::VectorXd jumps{};
};

/// A run that was not made but could be.
struct Design {
    std::string what;    ///< in words
    std::size_t run = 0; ///< which recorded run it varies
    /// What the machine does, linear in between, s and m; readings at `rate` Hz. Empty for a model without a machine.
    std::vector<double> time{}, displacement{};
    double rate = 0.0;
    bool turned = false; ///< the specimens are mounted turned end for end
    /// Arc fractions of each specimen at which markers are put for this run.
    std::vector<double> markers{};
    double markerRate = 0.0; ///< of frames, Hz; 0: it is not filmed
};

/// Readings of such a run, with their times.
struct DesignResponse {
    std::string failure;
    Eigen::VectorXd time, force;
    Eigen::VectorXd markerTime{}, markers{}; ///< as Response::markers; empty: none is tracked
    Eigen::VectorXd jumps{};                 ///< as Response::jumps
};

class Model {
public:
    Model() = default;
    Model(const Model&) = delete;
    Model& operator=(const Model&) = delete;
    virtual ~Model() = default;
    [[nodiscard]] virtual const std::vector<Scalar>& nominal() const = 0;
    [[nodiscard]] virtual const std::vector<Candidate>& candidates() const = 0;
    /// The first run that does the same as this one and is read at the same times: their simulations are the same.
    [[nodiscard]] virtual std::size_t twin(std::size_t run) const { return run; }
    /// Deterministic; called from several threads at a time.
    [[nodiscard]] virtual Response simulate(std::size_t run, const Point& point, Fineness fineness,
                                            const std::atomic<bool>* interrupt) const = 0;
    /// The point without what acts on readings only, and what that makes of them: such effects need no simulation.
    [[nodiscard]] virtual Point simulated(const Point& point) const { return point; }
    virtual void read(std::size_t, const Point&, Response&) const {}
    /// Runs that might tell rivals apart; none by default.
    [[nodiscard]] virtual std::vector<Design> designs() const { return {}; }
    [[nodiscard]] virtual DesignResponse simulateDesign(std::size_t, const Point&, const std::atomic<bool>*) const {
        return {"this model has no designs", {}, {}};
    }
    /// What, beside the values, the readings depend on: part of the key under which they are kept.
    [[nodiscard]] virtual std::string identity() const = 0;
};

} // namespace supercircle::diagnosis
