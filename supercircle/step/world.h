#pragma once
// The state of a world of flexible shells and everything a step needs to know about it: plain data. The step itself is
// in stepper.h; the host's rigid bodies come through port.h.

#include "supercircle/contact/crossing.h"
#include "supercircle/contact/detection.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/effects/rod_effects.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/step/energy_balance.h"
#include "supercircle/step/joint.h"
#include "supercircle/step/overlap.h"
#include "supercircle/step/port.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::step {

/// Why a rod is quarantined.
enum class QuarantineReason : std::uint8_t {
    None,
    NotFinite, ///< numbers that are not finite
    Runaway,   ///< the smallest step would curl an element up to more than a circle
    Crushed    ///< given motions left it no room (CrushPolicy::Freeze)
};

/// A piece of a host body, by contact::Outline::key.
struct PieceId {
    BodyId body = 0;
    std::uint32_t outline = 0;
    bool operator==(const PieceId&) const = default;
};

/// One shell: constant model, state, and what others need to know about it.
struct Rod {
    rod::RodModel model;
    Eigen::VectorXd q;            ///< layout of rod::RodModel
    Eigen::VectorXd v;            ///< dq/dt
    Eigen::VectorXd lastAccepted; ///< last accepted q: where a rod with bad numbers is left
    std::vector<Vec2> u; ///< material velocity at the Gauss points, m/s: the momentum the next step starts from
    std::vector<Hold> holds;
    double mu = 0.35;           ///< friction coefficient, 1; pairs use sqrt(mu_a mu_b)
    std::uint32_t key = 0;      ///< stable identity
    std::uint16_t category = 1; ///< collision filter, as in Box2D
    std::uint16_t mask = 0xffff;
    bool quarantined = false; ///< neither moves nor collides until it is moved or Settings::recoverAfter is over
    double speed = 0.0;       ///< largest speed of its points in the last step, m/s

    rod::Kinematics kin;   ///< at q
    rod::GaussField gauss; ///< at q

    std::vector<AppliedForce> forces;
    std::vector<MouseJoint> mouseJoints;
    double width = 0.010;       ///< m, only for changes of the material
    std::uint32_t material = 0; ///< for friction of pairs, 0: none
    std::int16_t group = 0;     ///< collision group, as in Box2D; not between a shell and itself
    std::uint32_t island = 0;   ///< number of the sleeping island it is in, 0: awake
    double stillTime =
        0.0; ///< how long its tips and middle have stayed within Settings::sleepDrift of `stillReference`, s
    std::array<Vec2, 3> stillReference{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()}; ///< first tip, middle, last tip, m
    [[nodiscard]] bool asleep() const { return island != 0; }
    effects::RodEffects effects{}; ///< extra physics of this rod
    double dtNext = 0.0;           ///< size of the step that its island wants next, s; 0: not known
    int cuts = 0;                  ///< of its island's step in a row, where a frame ended with them
    QuarantineReason quarantineReason = QuarantineReason::None;
    double quarantinedAt = 0.0;     ///< World::time, s
    double dampingRatio = -1.0;     ///< of its first mode, 1; negative: Settings::dampingRatio
    double dampingTime = 0.0;       ///< of that: damping moment over B and the rate of curvature, s (rods/damping.h)
    std::uint64_t dampingOf = 0;    ///< what that time was found for
    double freeStep = 0.0;          ///< size of its own steps in free motion (free_motion.h), s; 0: not known
    double leastBending = 0.0;      ///< bending energy in the last step, J
    double vibration = 0.0;         ///< largest kinetic energy of vibration in free motion lately, J
    std::vector<PieceId> passing{}; ///< one-sided edges that its centre line crosses, having come from behind
    /// Does not move in a step, whatever acts on it.
    [[nodiscard]] bool frozen() const { return quarantined || asleep(); }
};

/// A mean acceleration the host gave a body, and what is expected of the coming frame: the smaller of the last two
/// where they agree in sign, so that a blow is not taken for a force.
struct HostAcceleration {
    Vec2 linear = Vec2::Zero(); ///< of the last frame, m/s^2
    double angular = 0.0;       ///< rad/s^2
    Vec2 expectedLinear = Vec2::Zero();
    double expectedAngular = 0.0;
    double lastFrame = 0.0; ///< length of the last frame, s
    double frame = 0.0;     ///< of the shorter of the last two
    void learn(const Vec2& newLinear, double newAngular, double newFrame);
    /// For a frame of `coming` s: what was seen in a far shorter one is a blow. It changes the velocity by no more than
    /// it did then.
    [[nodiscard]] HostAcceleration during(double coming) const;
};

/// What passes between a dynamic body's copy here and the host's original (the scheme is in host_coupling.h).
struct HostCoupling {
    bool coupled = false;            ///< the copy took part in a contact problem of this frame
    double coupledTime = 0.0;        ///< for how long, s
    Vec2 travel = Vec2::Zero();      ///< of the copy in this frame, without drift, m
    double turn = 0.0;               ///< rad
    Vec2 hostImpulse = Vec2::Zero(); ///< what the host's own constraints are expected to give it in this frame, N s
    double hostTurnImpulse = 0.0;    ///< N m s
    Vec2 handed = Vec2::Zero();      ///< velocity the original should have after the host's step, m/s
    double handedSpin = 0.0;         ///< rad/s
    Vec2 drift = Vec2::Zero();       ///< velocity at which the copy closes up to the original's place, m/s
    double driftSpin = 0.0;          ///< rad/s
    HostAcceleration unexplained;    ///< by the host beyond its known constraints
    HostAcceleration all;            ///< by all of the host's doing but gravity: for copies in no contact problem
    bool known = false;              ///< `seen` is filled
    BodyState seen;                  ///< the original after the last frame, to notice its user's hand
};

/// A rigid body as the shells see it during a step; double precision between two looks at the host.
struct Body {
    BodyId id = 0;
    BodyState state;
    bool driven = false;         ///< moved by the machine: our pose rules, the host follows
    bool dynamic = false;        ///< takes part in the contact problem; not while it sleeps
    Vec2 impulse = Vec2::Zero(); ///< of the shells, gathered in this frame, N s: for who measures, no step reads it
    double angularImpulse = 0.0; ///< the same about the centre of mass, N m s
    Vec2 force = Vec2::Zero();   ///< from the shells in the last step, N
    double thicknessNear = 0.0;  ///< of the thinnest shell that may come near in this frame, m
    HostCoupling hostCoupling;
    /// Number of the sleeping island it is in, 0: awake. It stays dynamic until the host's step is over.
    std::uint32_t island = 0;
    bool woken = false;              ///< its island woke; the host is told before its next step
    double stillTime = 0.0;          ///< how long it has stayed within Settings::sleepDrift of the pose below, s
    Vec2 stillCentre = Vec2::Zero(); ///< m
    double stillAngle = 0.0;         ///< rad
    [[nodiscard]] bool asleep() const { return island != 0 && !dynamic; }
    /// Shells can push it, though it may have to be woken first.
    [[nodiscard]] bool yields() const { return dynamic || island != 0; }
};

/// Impulse remembered for warm starting and for pictures.
struct ContactImpulse {
    std::uint64_t id = 0;
    double normal = 0.0;               ///< mean force, N
    double tangent = 0.0;              ///< N
    double tangentialDeflection = 0.0; ///< tangential deflection of a compliant contact, m
};

/// What becomes of a shell between given motions that leave it no room.
enum class CrushPolicy : std::uint8_t {
    Wait,  ///< the steps get shorter and shorter
    Stop,  ///< the body and a hold stop
    Freeze ///< the shell is quarantined; a hold stops
};

/// Resolution of the numerics. Lengths are relative to the thinnest shell's thickness h, so that a scene scales.
struct Settings {
    double length = 0.0;             ///< m, what h stands for; 0: that thickness
    double dtMax = 4e-3;             ///< s
    double dtMin = 1e-6;             ///< s
    double fixedDt = 0.0;            ///< s; > 0 switches the adaptive step off
    double localError = 0.1;         ///< h, local error of a position per step the controller aims at
    double motionLimit = 0.6;        ///< h, farthest a touching shell may move in one step
    double margin = 0.2;             ///< h, speculative contact margin beyond the motion bound
    double relinearise = 0.001;      ///< h, gap error of a loaded contact that asks for another linearisation
    double rejectPenetration = 0.02; ///< h, a step that deepens penetration beyond this is redone smaller
    double recovery = 20.0;          ///< h/s, at which gaps of joints close and shells put into each other part
    int maxIterations = 4;           ///< linearisations per step
    coulomb::SolverOptions contact;  ///< absoluteImpulse: of the paper's shell, see impulseScale
    int threads = 1;
    bool acceptUnconverged = false;      ///< a step whose contact problem missed its tolerance is counted, not cut
    std::uint64_t sweepAbove = 1U << 30; ///< contacts; larger problems get capped sweeps: bounded time ...
    int cappedSweeps = 40;               ///< ... this many
    bool cull = false;           ///< leave out candidates that cannot meet within the step (cull.h): for long steps
    std::uint64_t frameWork = 0; ///< budget of a frame (frame_budget.h), units of about 1 us; 0: as much as it takes
    bool giveUpEarly = false;    ///< hard contact problems cut the step; the solver's full effort only after four cuts
    bool autoSleep = false;      ///< islands at rest fall asleep at the end of a frame (sleep.h)
    double sleepDrift = 0.1;     ///< h, no farther may an island have come from where it was
    double sleepAfter = 0.5;     ///< s ago
    CrushPolicy crush = CrushPolicy::Wait;
    double recoverAfter =
        std::numeric_limits<double>::infinity(); ///< s, after which quarantined rods move again; infinite: never
    double dampingRatio = 0.0;                   ///< of the first mode of rods that have none of their own, 1
    bool secondOrder = true;                     ///< rods that touch nothing move as free_motion.h says
    double freeError = 0.005;                    ///< error of their own steps, of the amplitude: 40 a period
    double freeLeast = 1e-5;                     ///< h, smaller errors are no reason to cut them
    int freeSteps = 1024;                        ///< most of them in a step
    int secondOrderRods = 1 << 30; ///< most of an island that touch something and move so (second_order.h)
    int secondOrderParts = 16;     ///< of dtMax: a step of so little is not cut for second order
    bool crossingCheck = false;    ///< run the independent crossing check on each step; a step that crosses is cut

    /// Leave out nodes that pass a tip within the step (passed_tips.h): in long steps without vibration.
    [[nodiscard]] bool leavesTips() const { return cull && !secondOrder; }
};

/// Settings for games: coarse steps within a budget of work; the defaults are those of the laboratory. Neither checks
/// crossings: that is up to who steps.
[[nodiscard]] Settings gameSettings();

/// Why a trial step must not become the next state.
enum class Reason : std::uint8_t {
    None,             ///< it may
    NotFinite,        ///< numbers that are not finite
    SolverFailed,     ///< the contact solver refused the problem
    Unconverged,      ///< contact residual above tolerance
    MotionTooLarge,   ///< a touching rod moved too far for one step
    LocalError,       ///< error of the time scheme
    Runaway,          ///< an element curled up to more than a circle
    CandidatesTooFew, ///< rods moved beyond the candidates' reach again and again
    Penetration,      ///< a contact got deeper
    LinkGap,          ///< a joint opened
    Crossing,         ///< the crossing check found one
    OutsideRegion,    ///< a rod left the region whose outlines were read
    SleeperPressed,   ///< somebody pressed on a sleeping island, which is woken
    StatusChange,     ///< a contact of something in motion changed its status
    GapEnergy,        ///< closing gaps would bring in more energy than they may in a frame; repeated leaving them open
    Count
};
/// As in the summary of a run: "not_finite" ...
const char* name(Reason reason);

/// What the steps so far took; counts only grow.
struct Counters {
    std::uint64_t steps = 0;
    std::uint64_t rejected = 0; ///< trial steps that were made again, sum of rejectedFor
    std::array<std::uint64_t, static_cast<std::size_t>(Reason::Count)> rejectedFor{}; ///< by reason
    std::uint64_t solves = 0;
    std::uint64_t gaussSeidelIterations = 0;
    std::uint64_t pivots = 0;
    std::uint64_t unconverged = 0;     ///< accepted steps whose contact residual stayed above tolerance
    std::uint64_t byAbsoluteFloor = 0; ///< accepted steps that are converged by SolverOptions::absoluteImpulse alone
    std::uint64_t crossings =
        0; ///< found by the crossing check in a step that could not be cut further (such pairs become overlaps)
    std::uint64_t quarantined = 0;       ///< rods taken out because of bad numbers or runaways
    double contactResidualMax = 0.0;     ///< largest contact residual of an accepted step
    std::uint64_t contactsMax = 0;       ///< most candidates in one problem
    std::uint64_t activeContactsMax = 0; ///< most contacts that carried force at once
    double penetrationMax = 0.0;         ///< deepest overlap seen after an accepted step, m

    Counters& operator+=(const Counters& other);
};

/// The thirteen stages of a step, in order (step.cpp).
enum class Stage : std::uint8_t {
    Check,
    ReadHost,
    Drive,
    Detect,
    Linearise,
    Evaluate,
    Predict,
    Assemble,
    Solve,
    Integrate,
    CheckCrossings,
    Accept,
    WriteHost,
    Count
};
/// As in the summary of a run: "read_host" ...
const char* name(Stage stage);

/// All that changes with time: copying it is saving, copying it back is restoring.
struct World {
    double time = 0.0; ///< s
    Vec2 gravity = Vec2::Zero();
    std::vector<Rod> rods;
    std::vector<Body> bodies;              ///< sorted by id
    std::vector<BodyOutline> outlines;     ///< of those bodies, as pulled last
    HostConstraints constraints;           ///< the host's own, on those bodies and their neighbours
    std::vector<ContactImpulse> impulses;  ///< sorted by id
    Vec2 crossheadVelocity = Vec2::Zero(); ///< of everything the machine carries, m/s
    Vec2 crossheadTravel = Vec2::Zero();   ///< integral of it, m
    std::vector<BodyId> crossheadBodies;   ///< kinematic host bodies the machine carries
    EnergyBalance energyBalance;
    Counters counters;
    /// Contact candidates of the present configuration and how far each rod may move before they must be found anew;
    /// part of the state so that a restored world replays bit for bit. Empty `range`: not known.
    std::vector<contact::Candidate> candidates;
    std::vector<double> range; ///< per rod, m
    double dt = 0.0;           ///< last accepted step, s
    double dtNext = 0.0;       ///< what the controller wants next, s
    std::uint32_t nextKey = 1;
    std::vector<Link> links;
    std::uint32_t nextPart = 1;                   ///< key of the next hold, force, mouse joint or link
    std::vector<PairFriction> pairFriction;       ///< sorted by (a, b)
    std::vector<BodyMaterial> bodyMaterials;      ///< sorted by body
    std::vector<ContactImpulse> sleepingImpulses; ///< of sleeping islands, sorted by id
    std::uint32_t nextIsland = 1;
    effects::EffectEnergies effectsGone{};   ///< dissipated on rods that are gone; stored in compliant contacts
    std::vector<SurfaceSpeed> surfaceSpeeds; ///< sorted by body and fixture
    std::vector<VetoedPair> vetoes;          ///< pairs that must not collide in this frame, sorted
    std::vector<StoppedBody> stopped;        ///< by rods without room, in a frame to come
    std::vector<Overlap> overlaps;           ///< pairs that cross without having moved there, sorted

    /// Force of the specimen on the machine in the last step, N (sum over machine bodies and holds).
    [[nodiscard]] Vec2 crossheadForce() const;
};

/// Puts a rod into the world. `q` in the layout of rod::RodModel; material velocities are taken from `v`.
/// Returns its index; the rod's energy is booked as added.
std::size_t addRod(World& world, const rod::RodDefinition& definition, const Eigen::VectorXd& q,
                   const Eigen::VectorXd& v, double mu);
/// Removes a rod (its energy is booked as removed); contacts forget it.
void removeRod(World& world, std::size_t index);

/// Changes what a rod is made of, its shape and motion kept; lengths and number of elements must stay. The change of
/// its energy is booked as added.
void changeRod(World& world, std::size_t index, const rod::RodDefinition& definition);
/// Sets q and v; the change of energy is booked as added and its contacts are forgotten.
void placeRod(World& world, std::size_t index, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
/// Puts the middle of a rod at a place with its tangent at an angle, shape and motion relative to itself kept; energies
/// and contacts as placeRod.
void moveRod(World& world, std::size_t index, const Vec2& middle, double angle);
/// Changes the motion of a rod at once by an impulse (N s) and an angular impulse (N m s) at arc length `s`; the change
/// of its energy is booked as work.
void applyImpulse(World& world, std::size_t index, double s, const Vec2& impulse, double angularImpulse);
/// Gives a rod the effects of `model` instead of those of before. Slots whose model changes start at rest; what they
/// store at its configuration is booked as added.
void setEffects(World& world, std::size_t index, const effects::Model& model);
/// The same from settings that act on shells, which the rod remembers. Settings it has already change nothing.
void setEffectSettings(World& world, std::size_t index, std::vector<effects::Setting> settings);
/// A long rest: viscous stresses gone, ages zero, surfaces healed.
void restEffects(World& world);
/// Lets `settle` bring the shells to rest while their viscous moments are gone, or held as at once, and gives what it
/// returns. Gone: a long rest follows. Held: they begin to relax after it, from the shape before; surfaces are healed.
bool comeToRest(World& world, effects::ViscousMoments viscous, const std::function<bool()>& settle);
/// Everything the shells know about places is told from the new origin `by` (m, in the old frame) on; velocities and
/// shapes stay. The change of gravity's potential is booked as added.
void shiftOrigin(World& world, const Vec2& by);
/// Energy of the effects by cause, J.
[[nodiscard]] effects::EffectEnergies effectEnergies(const World& world);
/// Index of the rod with this key, -1 if there is none.
[[nodiscard]] int rodIndex(const World& world, std::uint32_t key);
/// The length that limits motion, error and overlap of a rod, m: its thickness, or `given` (Settings::length) if > 0.
[[nodiscard]] double lengthOf(const Rod& rod, double given);
/// The same of a pair: that of its thinner rod.
[[nodiscard]] double lengthOf(const World& world, double given, const contact::Candidate& c);
/// Thickness of the thinnest rod, m; infinite without rods.
[[nodiscard]] double thinnest(const World& world);
/// The forces of the softest and of the lightest rod over those of the paper's shell, 1; without rods 1. It is the
/// smaller of B / R and, under gravity, lambda g R^2: forces that bend the rods, and weights, times R, as periods grow
/// with R. SolverOptions::absoluteImpulse, which is given for that shell, is multiplied by it. R: RodModel::meanRadius.
[[nodiscard]] double impulseScale(const World& world);
/// Of a list sorted by id; nullptr if it is not there.
[[nodiscard]] const Body* findBody(const std::vector<Body>& bodies, BodyId id);
/// Index of the body in World::bodies, -1 if it is not there.
[[nodiscard]] int bodyIndex(const World& world, BodyId id);

/// Re-evaluates geometry and material velocities after q or v were set from outside.
void refreshRod(Rod& rod);

/// The curve that contact detection sees, at any configuration of the rod.
void toCurve(const Rod& rod, const rod::Kinematics& kin, contact::RodCurve& curve);

/// World-frame outline of a body piece at a pose.
contact::Outline placed(const BodyOutline& piece, const Vec2& centre, double angle);
/// The same into `out`, whose storage is used again.
void place(const BodyOutline& piece, const Vec2& centre, double angle, contact::Outline& out);

} // namespace supercircle::step
