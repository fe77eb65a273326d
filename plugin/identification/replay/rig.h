#pragma once
// The simulated set-up: specimens, clamps, obstacles and the machine head (private to replay/).
//
// No host world stands behind it. Obstacles are rigid and either rest or ride on the head, so the core's own list of
// bodies says all there is to say; a rigid-body engine would add nothing but single precision.

#include "plugin/identification/replay/simulate.h"
#include "supercircle/step/stepper.h"

#include <optional>

namespace supercircle::replay {

class Rig {
public:
    /// Specimens in equilibrium under gravity, everything at displacement 0.
    /// @param turned they stand end for end the other way round
    Rig(const experiment::Experiment& experiment, const Parameters& parameters, const Resolution& resolution,
        bool turned = false);

    /// Empty, or why the set-up cannot be simulated.
    [[nodiscard]] const std::string& failure() const { return failure_; }

    /// Moves the head by `displacement` (m, downwards) in `duration` (s), evenly; `observe` sees each accepted step and
    /// may stop by returning true. False when stopped or failed.
    bool move(double displacement, double duration, const std::function<bool()>& observe);

    /// Time since the set-up stood ready, s.
    [[nodiscard]] double time() const { return world_.time - start_; }
    /// Way of the head since then, positive downwards, m.
    [[nodiscard]] double displacement() const { return -world_.machineTravel.y(); }
    /// Force of the specimen on the head at the end of the last step, positive upwards, N; first order in the step.
    [[nodiscard]] double force() const { return world_.machineForce().y(); }
    /// Mean force over the last step without what the step itself lost (see the essay in rig.cpp), and whether it could
    /// be told; where not, force() is all there is.
    struct MeanForce {
        bool known = false;
        bool steady = false; ///< the step is as long as the one before: what is in gaps is the same at both its ends
        double force = 0.0;  ///< N
        double way = 0.0;    ///< of the head in the step, positive downwards, m
    };
    [[nodiscard]] const MeanForce& meanForce() const { return mean_; }
    /// Point of the centre line, m. @param arcFraction of the specimen, from its own first end
    [[nodiscard]] rod::Vec2 point(std::size_t specimen, double arcFraction) const;
    /// Largest change of curvature from the natural one now, 1/m.
    [[nodiscard]] double bend() const;
    [[nodiscard]] const step::Counters& counters() const { return world_.counters; }

private:
    /// Keeps steps from growing where they only shrink again. A step of another length than the one before finds the
    /// rod elsewhere than it would have left it (rig.cpp), takes that for an error, and the next ones are halved; as
    /// soon as all is quiet they grow, and so on, eight steps of four lengths in turn for as long as the head goes.
    class Patience {
    public:
        void begin(double time) { time_ = time; } ///< of a motion
        /// Longest next step, s. @param time at the end of a step @param most without patience, s
        double longest(double time, double most);

    private:
        double time_ = 0.0, last_ = 0.0, before_ = 0.0, cap_ = 0.0; // s
        int steps_ = 0, grew_ = 0, until_ = 0, pause_ = 0;
    };

    void addSpecimen(const experiment::Specimen& specimen, const SpecimenParameters& own, const Parameters& p,
                     double arm);
    void place(const experiment::Carrier& carrier, rod::Vec2& point, double& angle, const Parameters& p) const;
    void addObstacle(const experiment::Obstacle& obstacle, const Parameters& p, double skin, double extent);
    /// The bow's strings; `half` is the length of each.
    void addStrings(const experiment::Experiment& e, double half);
    void chooseSettings(const Parameters& p);
    void settle();
    [[nodiscard]] double frictionToo(double lost, double stored, double work) const;
    void readMeanForce();

    Resolution resolution_;
    step::World world_;
    step::Stepper stepper_;
    std::string failure_;
    MeanForce mean_;
    effects::Model common_; ///< what effects do to all specimens and the set-up
    Patience patience_;
    step::Ledger books_;            ///< at the end of the last step
    double lastDisplacement_ = 0.0; ///< m
    double forceScale_ = 0.0;       ///< largest mean force so far, N
    double start_ = 0.0;
    double halfString_ = 0.0;       ///< of a braced bow, m
    bool ring_ = false;             ///< the specimen is closed
    bool turned_ = false;           ///< the rods run from the specimens' last ends to their first
    bool pressesOnly_ = false;      ///< the normal forces of what slides are the head's force
    std::optional<rod::Vec2> nock_; ///< where a bow's strings meet at the start
};

} // namespace supercircle::replay
