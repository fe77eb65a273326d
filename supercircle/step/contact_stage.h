#pragma once
// From contact candidates to one Coulomb problem and back (private to step/): stages collide, couple and solve.

#include "supercircle/step/work.h"

namespace supercircle::step {

/// Mean velocity of a host body over the attempt, drift included.
struct BodyMotion {
    Vec2 velocity = Vec2::Zero(); ///< m/s
    double spin = 0.0;            ///< rad/s
};

/// Where a host body stands in the contact problem.
struct BodyPlace {
    int block = -1;   ///< index into the problem's bodies, -1: not in it
    int column = 0;   ///< of its first freedom in the block
    int freedoms = 0; ///< 3, or 2 where rotation is fixed; 0: not in the problem
};

/// Indices into World::bodies of what a host constraint connects, -1: nobody.
struct BodyEnds {
    int a = -1, b = -1;
};

/// Everything the contacts of one attempt need.
struct ContactStage {
    std::vector<contact::Curve> curves, curvesMiddle;
    std::vector<contact::Outline> outlines, outlinesMiddle;
    std::vector<contact::Candidate> candidates; ///< frames at the linearisation point
    std::vector<double> gapAtStart;             ///< of each candidate at the start of the step, m
    std::vector<contact::Candidate> after;      ///< at the end of the attempt
    std::vector<ContactWork> work;
    std::vector<BodyPlace> place;      ///< per World::bodies
    std::vector<BodyMotion> motion;    ///< per World::bodies: as predicted, then as solved
    std::vector<BodyEnds> contactEnds; ///< of World::constraints.contacts
    std::vector<BodyEnds> rowEnds;     ///< of World::constraints.rows
    std::vector<int> hostEntries; ///< the problem's contacts after the candidates: k = host contact, -1 - k = limit
    coulomb::Problem problem;
    coulomb::Solver solver;
    coulomb::SolveReport report;
    contact::Detector detector;
    Eigen::VectorXd r;                     ///< impulses, 2 per candidate, N s
    std::vector<Eigen::VectorXd> velocity; ///< per problem body
};

/// Index into World::bodies, -1 if there is no such body.
int bodyIndex(const World& world, BodyId id);

/// Fills stage.motion with the bodies' present velocities: the prediction of a step.
void predictMotion(const World& world, ContactStage& stage);

/// Outlines in the world frame; `ahead` seconds along `motion`.
void placeOutlines(const World& world, const std::vector<BodyMotion>& motion, double ahead, double motionTime,
                   std::vector<contact::Outline>& outlines);

/// Candidates at the given kinematics (one per rod). `range` is how far each rod may move.
void collide(const World& world, const std::vector<const rod::Kinematics*>& kin, const std::vector<double>& range,
             double ahead, double motionTime, double margin, ContactStage& stage, std::vector<contact::Candidate>& out);

/// Takes `start` (candidates at the start of the step), adds those of stage.after that are new, and refreshes their
/// frames in the middle of the step. Fills stage.candidates and stage.gapAtStart. The middle is what makes contact
/// second order: gap(end) - gap(start) = H(middle) (q1 - q) up to third order, so sliding along a curved surface
/// neither sinks in nor has to be pushed out again.
void frameInMiddle(const World& world, const std::vector<RodWork>& rods, const std::vector<contact::Candidate>& start,
                   bool addNew, double dt, ContactStage& stage);

/// Builds the Coulomb problem of the framed candidates. Warm starts from `warm`, matched by id.
void couple(const World& world, std::vector<RodWork>& rods, double dt, const std::vector<ContactImpulse>& warm,
            ContactStage& stage);

/// Solves, and puts the new velocities into rods (contact-free ones get their free velocity) and into stage.motion.
void solveContacts(const World& world, std::vector<RodWork>& rods, const coulomb::SolverOptions& options,
                   ContactStage& stage);

/// Impulses of the stage by contact id, as mean forces.
void gather(const ContactStage& stage, double dt, std::vector<ContactImpulse>& out);

} // namespace supercircle::step
