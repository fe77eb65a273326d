#pragma once
// A scene as plain data, with the values of its parameters. Its fields have the names of the JSON keys. The loader
// (loader.h) makes it; plugin/lab and plugin/scene/player play it.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/effects/effect.h"
#include "supercircle/step/rigid_definition.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

/// A parameter that the scene declares.
struct Parameter {
    std::string name;
    double value = 0.0;
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    std::string unit = "1";
    std::string about;
    bool integer = false; ///< only whole numbers make sense (counts)
};

/// Shells dropped at random positions and angles (paper, Methods; experiment E3).
struct Drop {
    ShellDef shell; ///< template of every dropped shell
    int count = 30;
    int batch_size = 1;               ///< shells that fall at the same time, side by side
    double x_min = 0.0;               ///< m, range of the middle of the shell's bounding circle
    double x_max = 0.0;               ///< m
    double clearance = 0.005;         ///< m, from the top of the pile to the lowest point of a new shell
    double settle_speed = 5e-3;       ///< m/s, the next batch falls when no point moves faster than this ...
    double settle_time = 0.6;         ///< s, ... or when this long has passed
    double final_settle_speed = 2e-4; ///< m/s, the pile is at rest when no point moves faster than this ...
    double final_settle_time = 2.0;   ///< s, ... or when this long has passed since the last shell
    bool adaptive = false;            ///< a fixed step of the numerics applies to the protocol only
};

/// End of a segment: the first condition that holds. Unset ones are infinite or NaN.
struct StopCondition {
    double force = std::numeric_limits<double>::infinity(); ///< N, reached from below
    double displacement =
        std::numeric_limits<double>::quiet_NaN();          ///< m, travel of the crosshead (see Protocol), NaN: unset
    double time = std::numeric_limits<double>::infinity(); ///< s since the start of the segment
};

/// One step of a protocol.
struct ProtocolSegment {
    enum class Kind : std::uint8_t { Travel, Hold, Settle } kind = Kind::Hold;
    double speed = 0.0; ///< m/s, Travel: positive along `direction` (pushing), negative back
    StopCondition stop_when;
    bool loading = false; ///< counts as the loading branch of a cycle
    int cycle = 0;        ///< number of its cycle, from 1; 0: none
};

/// Motion of the testing machine's crosshead, which carries one kinematic body or the holds with HoldBase::Moving.
struct Protocol {
    std::string body;           ///< name of the kinematic body on the crosshead; empty: the holds
    Point direction{0.0, -1.0}; ///< unit vector of positive travel
    /// Travel counts from the first contact (stacks: Delta = H0 - H) instead of from the start.
    bool zero_at_first_contact = false;
    double approach_speed = 0.0;           ///< m/s, from the approach gap to the first contact; 0: 1 mm/s
    double approach_gap = 1e-5;            ///< m, gap above the specimen to which the crosshead jumps
    std::vector<ProtocolSegment> segments; ///< cycles unrolled
};

/// A force and a moment on a point of a shell, of constant direction.
struct PointLoad {
    std::string shell;         ///< its name
    double arc_fraction = 0.5; ///< place along the shell, 0 = first end, 1 = last end
    Point force{};             ///< N
    double moment = 0.0;       ///< N m, counter-clockwise
    bool released = false;     ///< gone at time 0: it acts only on the state of rest from which the scene starts
};

/// A quantity that a scene lets be observed, as an instrument would record it.
struct Observation {
    enum class Of : std::uint8_t { Body, Shell, Machine } of = Of::Body;
    enum class Quantity : std::uint8_t {
        Angle, ///< rad, from +x counter-clockwise
        X,     ///< m
        Y,
        Spin, ///< rad/s
        Vx,   ///< m/s
        Vy,
        AngularAcceleration, ///< rad/s^2
        Ax,                  ///< m/s^2
        Ay,
        Force, ///< N, of the machine, positive while it is resisted
        Travel ///< m, of the machine
    };
    std::string name;
    std::string target;        ///< name of the body or shell
    Point local{};             ///< in the body's frame, m
    double arc_fraction = 0.5; ///< of the shell
    Quantity quantity = Quantity::X;
};

/// Settings of the numerics; the defaults are those of Quality::Laboratory.
/// How finely the segments of a protocol are stepped (plugin/lab/session/accuracy.h).
enum class Accuracy : std::uint8_t { Exact, Standard, Fast };
/// As in scenes and on the command line, in the order of the enum.
inline const std::vector<std::string> kAccuracies = {"exact", "standard", "fast"};

struct Numerics {
    Accuracy accuracy = Accuracy::Exact;
    double dt_max = 0.0;     ///< s; 0: from the crosshead's speed (R / 500 of travel), 4 ms without a crosshead
    double dt_min = 0.0;     ///< s; 0: 1 us for shells of radius 19.2 mm, in proportion
    double fixed_dt = 0.0;   ///< s; > 0: constant steps
    double tolerance = 1e-8; ///< contact residual, 1
    std::optional<bool> quasi_static; ///< only rest matters, vibration is damped; empty: with a protocol
    double position_tolerance = 0.0;  ///< m, local error per step; 0: 5 um for a radius of 19.2 mm, in proportion
};

/// Selects the numbers of the summary.
struct Report {
    std::string kind = "free"; ///< "stack" | "snap" | "squeeze" | "cantilever" | "pinning" | "ramp" | "free"
    double R = 0.0192;         ///< m, radius for scaled numbers
    double B = 0.0;            ///< N m^2, bending modulus for scaled numbers; 0: that of the first shell
    double sample_dt = 0.02;   ///< s, largest spacing of series and trajectory (events are sampled finer)
};

/// A kind of shell that a level offers: supercircle::scaled_shell with these values.
struct GamePart {
    std::string name;
    std::uint32_t colour = 0x3a7bd5; ///< 0xRRGGBB
    double radius = 0.5;             ///< m
    double mass = 0.5;               ///< kg
    double phi_bar = 0.75;           ///< opening angle / 2 pi
    double stiffness = 1.0;          ///< bending stiffness over that of the default shell at this radius and mass, 1
    double mu = 0.35;                ///< friction coefficient, 1
    int elements = 15;
    double cost = 1.0;       ///< in units of the budget
    std::optional<Point> at; ///< m, position at the start (clip)
};

/// The section "game" of a level (docs/how-to/levels.md). Keys that a kind of game does not use keep their defaults.
struct Game {
    std::string kind; ///< "egg_drop" | "lander" | "clip"
    std::string title, hint;
    std::string actor;                        ///< the dynamic body of the game: egg, craft or load
    std::string carrier;                      ///< clip: kinematic body that carries the load
    std::string service;                      ///< lander: body whose clamps hold spent legs while the craft pulls off
    Point viewLower{-8, -1}, viewUpper{8, 8}; ///< m, the visible area
    Point goalLower{}, goalUpper{};           ///< m, area that the actor has to reach ...
    double hold = 1.0;                        ///< s, ... and stay in so long
    double time = 60.0;                       ///< s, time limit
    double limit = 10.0;                      ///< g, largest acceleration that the actor survives
    double budget = 10.0;                     ///< egg_drop: for the costs of the shells
    std::vector<double> heights; ///< m, of the egg's lowest point above the crate's floor, one for each drop
    double fuel = 20.0;          ///< s of full thrust
    double thrust = 400.0;       ///< N
    double wind = 0.0;           ///< N, to the right
    double speed = 1.0;          ///< m/s, of the carrier
    std::vector<GamePart> parts;
};

struct Scene {
    std::string name;
    std::string about;
    std::string file;
    std::vector<Parameter> parameters; ///< with their final values
    step::RigidWorldDefinition rigid;
    std::vector<ShellDef> shells;
    std::vector<HoldDef> holds;
    std::vector<PointLoad> loads;
    bool starts_at_rest = false; ///< the shells settle under gravity and loads before time 0; false: as they are placed
    std::optional<Drop> drop;
    std::optional<Protocol> protocol;
    std::vector<Observation> observe;
    std::vector<effects::Setting> effects; ///< gravity and misalignment are already applied to the scene
    Numerics numerics;
    Report report;
    std::optional<Game> game;
    double duration = 0.0; ///< s, for scenes without a protocol; a protocol ends with its last segment
};

/// Whether joints have springs or dry friction, which experiments simulate and Box2D does not.
bool isMechanism(const Scene& scene);

} // namespace supercircle::scene
