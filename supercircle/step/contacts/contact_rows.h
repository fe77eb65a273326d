#pragma once
// From contact candidates to one Coulomb problem and back (private to step/): stages collide, couple and solve.

#include "supercircle/step/contacts/gap_work.h"
#include "supercircle/step/stages/workspace.h"
#include "supercircle/support/parallel.h"

#include <map>

namespace supercircle::step {

/// Mean velocity of a host body over the attempt, drift included.
struct BodyMotion {
    Vec2 velocity = Vec2::Zero(); ///< m/s
    double spin = 0.0;            ///< rad/s
    bool isFree = false;          ///< it has moved with the freely moving rods that it is joined to
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

/// What a link joins, as indices.
struct LinkEnds {
    int rodA = -1, rodB = -1, body = -1;
    bool counts = false; ///< nothing is missing, and something of it can move
};

enum class LinkRowKind : std::uint8_t { Point, Angle, Pull };

/// One contact of the problem that is (part of) a link, see link_rows.h. ContactWork::surface is the given velocity.
struct LinkRow : ContactWork {
    int link = -1; ///< index into World::links
    LinkRowKind kind = LinkRowKind::Point;
    Vec2 normal = Vec2::UnitX();                 ///< towards which a positive impulse pushes rod A
    double lever = 0.0;                          ///< m, makes an angle a length
    Vec2 bias = Vec2::Zero();                    ///< of the gap: what it adds to the relative velocity, m/s
    Vec2 closing = Vec2::Zero();                 ///< relative velocity at which the gap found at the start closes, m/s
    Vec2 wanted = Vec2::Zero();                  ///< the same if it does not wait
    int bodyProblem = -1;                        ///< block of the other end's body in the problem
    Eigen::Matrix<double, 2, Eigen::Dynamic> Hb; ///< rows of that block, the sign of the body included
};

/// One push of an overlap (overlaps.h). ContactWork::surface is the given velocity.
struct PushRow : ContactWork {
    Vec2 direction = Vec2::UnitX();              ///< of A away from B
    double speed = 0.0;                          ///< m/s
    int bodyProblem = -1;                        ///< block of the body in the problem
    Eigen::Matrix<double, 2, Eigen::Dynamic> Hb; ///< rows of that block, the sign of the body included
};

/// Where the rods and outlines are, for detection.
struct DetectionWork {
    std::vector<contact::RodCurve> curves, curvesMiddle; ///< where detection was asked, and in the middle of the step
    std::vector<contact::Outline> outlines, outlinesMiddle;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> excluded; ///< pairs that do not collide, sorted
    std::vector<std::pair<int, int>> passing; ///< rods, and outlines that they pass from behind, sorted
    bool behind = false;                      ///< detection last found contacts of what comes from behind
    contact::Detector detector;
};

/// Links of the attempt.
struct LinkWork {
    std::vector<LinkEnds> ends; ///< per World::links
    std::vector<LinkRow> rows;  ///< storage; the first `count` belong to this attempt
    std::size_t count = 0;
};

/// Pushes of overlaps in the attempt.
struct PushWork {
    std::vector<PushRow> rows; ///< storage; the first `count` belong to this attempt
    std::size_t count = 0;
};

/// Bodies and constraints of the host in the attempt.
struct HostWork {
    std::vector<BodyPlace> place;      ///< per World::bodies
    std::vector<BodyMotion> motion;    ///< per World::bodies: as predicted, then as solved
    std::vector<BodyEnds> contactEnds; ///< of World::constraints.contacts
    std::vector<BodyEnds> rowEnds;     ///< of World::constraints.rows
    std::vector<int> entries;          ///< the problem's contacts after the links: k = host contact, -1 - k = limit
    std::vector<int> saturated;        ///< of World::constraints.rows in this attempt, as HostRow::saturated
    std::size_t firstBlock = 0;        ///< the problem's bodies from here on are blocks of host bodies
    // Scratch, of host_rows.cpp:
    std::vector<int> groups, groupBlocks, blockSizes; ///< of host bodies
    std::vector<coulomb::Body> spareBlocks;
    std::vector<Eigen::LLT<Eigen::MatrixXd>> blockFactors;
    std::vector<double> row;
};

/// Storage that a warm step need not take from the heap.
struct ContactScratch {
    std::vector<std::uint64_t> ids; ///< sorted
    std::vector<std::uint32_t> outlineKeys;
    std::vector<std::pair<std::uint32_t, int>> rodOfKey; ///< sorted
    std::vector<LoadedPoint> loadedPoints;
    std::vector<RollingPair> rollingPairs;
    std::vector<int> problemBodies; ///< indices into World::bodies
    std::vector<char> marked;       ///< per World::bodies or rods
};

/// Everything the contacts of one attempt need.
struct ContactStage {
    double h = 0.0;      ///< thinnest shell, which `overlaps` is given for, m
    double length = 0.0; ///< Settings::length
    OverlapClosing overlaps;
    parallel::For loop; ///< over the threads of the settings; empty: one
    DetectionWork detection;
    // Linearise:
    std::vector<contact::Candidate> candidates; ///< frames at the linearisation point
    GapWork gaps;                               ///< until the frame ends
    std::vector<double> gapAtStart;             ///< of each candidate at the start of the step, m
    std::vector<contact::Candidate> after;      ///< at the end of the attempt
    double addBelow = 1e300; ///< m, those found at the end only are added when their gap there is smaller
    bool leavesTips = false; ///< Settings::leavesTips
    // Assemble:
    std::vector<ContactWork> work;
    std::vector<AdhesionWork> pulls;       ///< of adhesion
    std::map<std::uint64_t, double> slips; ///< by contact id: speed the friction was taken at, m/s (friction_state.h)
    LinkWork links;
    PushWork pushes;
    HostWork host;
    coulomb::Problem problem; ///< contacts: of the candidates, of links.rows, of the host, of pushes.rows
    // Solve:
    coulomb::Solver solver;
    coulomb::SolveReport report;
    Eigen::VectorXd r;                     ///< impulses, 2 per contact, N s
    std::vector<Eigen::VectorXd> velocity; ///< per problem body
    ContactScratch scratch;
};

/// How overlaps of pairs of the thickness `h` m close.
[[nodiscard]] OverlapClosing overlapClosing(const Settings& settings, double h);

/// Fills stage.host.motion with the bodies' present velocities: the prediction of a step.
void predictMotion(const World& world, ContactStage& stage);
[[nodiscard]] BodyMotion predictedMotion(const Body& b);

/// Whether a rod of the pair has moved already: it does not touch in this attempt.
[[nodiscard]] inline bool isOfFreeRod(const std::vector<RodWork>& rods, const contact::Candidate& c) {
    return rods[static_cast<std::size_t>(c.a.rod)].isFree ||
           (c.b.rod >= 0 && rods[static_cast<std::size_t>(c.b.rod)].isFree);
}

/// The same of a host body that has moved with such rods.
[[nodiscard]] bool isOfFreeBody(const World& world, const ContactStage& stage, const contact::Candidate& c);

/// Outlines in the world frame; `ahead` seconds along `motion`. `keys` is scratch.
void placeOutlines(const World& world, const std::vector<BodyMotion>& motion, double ahead, double motionTime,
                   std::vector<std::uint32_t>& keys, std::vector<contact::Outline>& outlines);

/// Candidates at the given kinematics (one per rod). `range` is how far each rod may move.
void collide(const World& world, const std::vector<const rod::Kinematics*>& kin, const std::vector<double>& range,
             double ahead, double motionTime, double margin, ContactStage& stage, std::vector<contact::Candidate>& out);

/// Takes `start` (candidates at the start of the step), adds those of stage.after that are new, and refreshes their
/// frames in the middle of the step. Fills stage.candidates and stage.gapAtStart. The middle is what makes contact
/// second order: gap(end) - gap(start) = H(middle) (q1 - q) up to third order, so sliding along a curved surface
/// neither sinks in nor has to be pushed out again.
void frameInMiddle(const World& world, const std::vector<RodWork>& rods, const std::vector<contact::Candidate>& start,
                   bool addNew, double dt, ContactStage& stage);

/// Builds the Coulomb problem of the framed candidates, of the links and of the host's bodies. Warm starts from `warm`,
/// matched by id. `again`: `rods` hold the solution of an earlier linearisation.
void couple(const World& world, std::vector<RodWork>& rods, double dt, const std::vector<ContactImpulse>& warm,
            bool again, ContactStage& stage);

/// Rows for the unknowns of a rod: held motions taken out, their velocity added to `offset`.
void reduce(const RodWork& w, const Eigen::Matrix<double, 2, Eigen::Dynamic>& full, double sign, Vec2& offset,
            Eigen::Matrix<double, 2, Eigen::Dynamic>& reduced);

/// Solves, and puts the new velocities into rods (contact-free ones get their free velocity) and into
/// stage.host.motion.
void solveContacts(const World& world, std::vector<RodWork>& rods, const coulomb::SolverOptions& options,
                   ContactStage& stage);

/// Give of a contact, m/N along (n, t): that of the rods in it, mean of both.
Vec2 complianceOf(const World& world, const contact::Candidate& candidate);

/// Impulses of the stage by contact id, as mean forces.
void gather(const ContactStage& stage, double dt, std::vector<ContactImpulse>& out);

} // namespace supercircle::step
