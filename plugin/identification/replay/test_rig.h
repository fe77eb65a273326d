#pragma once
// Simulated set-up: specimens, clamps, obstacles and the crosshead (private to replay/). Obstacles are rigid and fixed
// or carried by the crosshead, so no host engine is needed.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/natural_units.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/step/stepper.h"

#include <optional>

namespace supercircle::replay {

class TestRig {
public:
    /// Builds the specimens in equilibrium under gravity at displacement 0.
    /// @param specimenReversed they are mounted end for end
    TestRig(const experiment::Experiment& experiment, const Parameters& parameters, const Resolution& resolution,
            bool specimenReversed = false);

    /// The same of a scene with shells, `scene` with the values of the parameters of a run. Its shells start as the
    /// scene places them and settle.
    TestRig(const experiment::Experiment& experiment, const scene::Scene& scene, const Parameters& parameters,
            const Resolution& resolution);

    /// Why the set-up cannot be simulated; empty: it can.
    [[nodiscard]] const std::string& failure() const { return failure_; }

    /// Moves the crosshead by `displacement` (m, in the direction of the machine: downwards without a scene) in
    /// `duration` (s) at constant speed. `observe` sees each accepted step and may stop by returning true. False when
    /// stopped or failed.
    bool move(double displacement, double duration, const std::function<bool()>& observe);

    /// Whether the specimens vibrate as they would; otherwise only rest counts, and vibration is damped.
    [[nodiscard]] bool inMotion() const { return inMotion_; }

    /// Size of the coming step, if nothing cuts it, s.
    [[nodiscard]] double nextStep() const;
    /// Time since the start of the run, s.
    [[nodiscard]] double time() const { return world_.time - start_; }
    /// Travel of the crosshead since then, positive in the direction of the machine, m.
    [[nodiscard]] double displacement() const { return world_.crossheadTravel.dot(direction_); }
    /// Force of the specimen on the crosshead against that direction at the end of the last step, N; first order in the
    /// step.
    [[nodiscard]] double force() const { return -world_.crossheadForce().dot(direction_); }
    /// Mean force over the last step without numerical dissipation (decision 0151), if it is known; otherwise only
    /// force() is available.
    struct MeanForce {
        bool known = false;
        bool steady = false; ///< as long as the step before, so that stored gap energy cancels
        double force = 0.0;  ///< N
        double travel = 0.0; ///< m, of the crosshead in the step, positive in the direction of the machine
    };
    [[nodiscard]] const MeanForce& meanForce() const { return mean_; }
    /// Point of the centre line, m.
    /// @param arcFraction of the specimen, from its own first end
    [[nodiscard]] rod::Vec2 point(std::size_t specimen, double arcFraction) const;
    /// Direction of the tangent there, rad, continuous along the rod.
    [[nodiscard]] double angle(std::size_t specimen, double arcFraction) const;
    /// Velocity of that point, m/s, and rate of that angle, rad/s.
    [[nodiscard]] rod::Vec2 velocity(std::size_t specimen, double arcFraction) const;
    [[nodiscard]] double spin(std::size_t specimen, double arcFraction) const;
    /// Largest present change of curvature from the natural one, 1/m.
    [[nodiscard]] double bend() const;
    [[nodiscard]] const experiment::NaturalUnits& units() const { return units_; }
    /// Replaces the loads. @param before the start, when released loads still act
    void setLoads(const std::vector<scene::PointLoad>& loads, bool before);
    [[nodiscard]] const step::Counters& counters() const { return world_.counters; }

private:
    /// Holds the step size where growth would be rejected again. A change of the step size looks like an integration
    /// error, so steps would shrink and grow in turn.
    class StepSizeHold {
    public:
        void begin(double time) { time_ = time; } ///< of a motion
        /// Longest next step, s.
        /// @param time at the end of a step
        /// @param most without the hold, s
        double longestStep(double time, double most);

    private:
        double time_ = 0.0, last_ = 0.0, before_ = 0.0, cap_ = 0.0; // s
        int steps_ = 0, grewAt_ = 0, until_ = 0, pause_ = 0;
    };

    void addSpecimen(const experiment::Specimen& specimen, const SpecimenParameters& own, const Parameters& p,
                     double arm);
    void applyCarrier(const experiment::Carrier& carrier, rod::Vec2& point, double& angle, const Parameters& p) const;
    void addObstacle(const experiment::Obstacle& obstacle, const Parameters& p, double skin, double extent);
    /// The strings of a bow; `half` is the length of each.
    void addStrings(const experiment::Experiment& e, double half);
    void addBodies(const scene::Scene& scene);
    void addShells(const scene::Scene& scene, const Parameters& p);
    void addHolds(const scene::Scene& scene);
    /// Moves a rod whose hold is on a crosshead that is not aligned.
    void misalign(std::size_t rod, const step::Hold& hold);
    void chooseSettings(const Parameters& p);
    [[nodiscard]] double impulseOf(const Parameters& p) const;
    void settle(effects::ViscousMoments viscous);
    /// From here on specimens vibrate.
    void setInMotion();
    [[nodiscard]] double frictionCorrection(double lost, double stored, double work) const;
    void readMeanForce();

    rod::Vec2 direction_{0.0, -1.0}; ///< of positive travel
    experiment::NaturalUnits units_;
    Resolution resolution_; ///< in SI units
    step::World world_;
    step::Stepper stepper_;
    std::string failure_;
    MeanForce mean_;
    effects::Model common_; ///< effects common to all specimens and the set-up
    StepSizeHold stepSizeHold_;
    step::EnergyBalance balance_;   ///< at the end of the last step
    double lastDisplacement_ = 0.0; ///< m
    double forceScale_ = 0.0;       ///< largest mean force so far, N
    double start_ = 0.0;
    double halfString_ = 0.0;        ///< m, of a strung bow
    std::vector<std::string> names_; ///< of the shells of a scene
    bool inMotion_ = false;
    double motionStep_ = 0.0;       ///< s, longest step in motion
    bool ring_ = false;             ///< the specimen is closed
    bool turned_ = false;           ///< the rods run from the last ends of the specimens to their first
    bool pressesOnly_ = false;      ///< the normal forces of sliding contacts equal the crosshead's force
    std::optional<rod::Vec2> nock_; ///< m, where the strings of a bow meet at the start
};

} // namespace supercircle::replay
