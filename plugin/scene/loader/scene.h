#pragma once
// A scene as plain data, after its parameters have been put in. The loader (loader.h) makes it from JSON; the
// laboratory runner (plugin/lab) plays it.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/effects/effect.h"
#include "supercircle/step/rigid_definition.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

/// A knob the scene declares.
struct Parameter {
    std::string name;
    double value = 0.0;
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    std::string unit = "1";
    std::string about;
    bool integer = false; ///< only whole numbers make sense (counts)
};

/// Shells dropped one by one at random places and angles (paper, Methods; experiment E3).
struct Drop {
    ShellDef shell; ///< template of every dropped shell
    int count = 30;
    int together = 1;           ///< how many fall at a time, side by side: big piles would take for ever one by one
    double x_min = 0.0;         ///< m, range of the middle of the shell's bounding circle
    double x_max = 0.0;         ///< m
    double clearance = 0.005;   ///< m, free height between the pile's top and the lowest point of the new shell
    double settle_speed = 5e-3; ///< m/s, the next one falls when no point moves faster than this ...
    double settle_time = 0.6;   ///< s, ... or when this long has passed
    double final_settle_speed = 2e-4; ///< m/s, the pile is at rest when no point moves faster than this ...
    double final_settle_time = 2.0;   ///< s, ... or when this long has passed since the last shell
    bool adaptive = false;            ///< a fixed step of the numerics counts from the protocol on only
};

/// What ends a move; whichever comes first. Unset ones are infinite.
struct Until {
    double force = std::numeric_limits<double>::infinity(); ///< N, reached from below
    double displacement =
        std::numeric_limits<double>::quiet_NaN(); ///< m of machine travel since touch (see Protocol), NaN: unset
    double time = std::numeric_limits<double>::infinity(); ///< s since the move began
};

struct Move {
    enum class Kind : std::uint8_t { Travel, Hold, Settle } kind = Kind::Hold;
    double speed = 0.0; ///< m/s, Travel: positive along `direction` (pushing), negative back
    Until until;
    bool loading = false; ///< a leg that counts as the loading branch of a cycle
    int cycle = 0;        ///< which cycle this leg belongs to, from 1; 0: none
};

/// The testing machine: drives one kinematic body (`plate`) or the shells' holds that are on_machine.
struct Protocol {
    std::string body;           ///< name of the kinematic body that is the machine head; empty: the holds
    Point direction{0.0, -1.0}; ///< unit vector of positive travel
    bool zero_at_touch =
        false; ///< travel counts from the first touch (stacks: Delta = H0 - H) instead of from the start
    double approach_speed =
        0.0;                 ///< m/s, how the machine reaches the first touch when zero_at_touch; 0: jump to just above
    double touch_gap = 1e-5; ///< m, where 'just above' is
    std::vector<Move> moves; ///< cycles already unrolled
};

/// Resolution of the numerics; the defaults are the laboratory's.
struct Numerics {
    double dt_max = 0.0;             ///< s; 0: by the machine's speed (R / 500 of travel), 4 ms where none moves
    double dt_min = 0.0;             ///< s; 0: 1 us for shells of radius 19.2 mm, in proportion
    double fixed_dt = 0.0;           ///< s; > 0 switches adaptivity off
    double tolerance = 1e-8;         ///< contact residual eta, 1
    double position_tolerance = 0.0; ///< m, local error aimed at per step; 0: 5 um for a radius of 19.2 mm, likewise
};

/// Which numbers the summary reports beside the common ones.
struct Report {
    std::string kind = "free"; ///< "stack" | "snap" | "squeeze" | "cantilever" | "pinning" | "ramp" | "free"
    double R = 0.0192;         ///< m, radius used to scale
    double B = 0.0;            ///< N m^2, bending modulus used to scale; 0: that of the first shell
    double sample_dt = 0.02;   ///< s, series and trajectory spacing at most this (events are sampled finer)
};

/// A kind of shell a game hands out: the paper's shell at the size of games (supercircle::scaledShell).
struct GamePart {
    std::string name;
    std::uint32_t colour = 0x3a7bd5; ///< 0xRRGGBB
    double radius = 0.5;             ///< m
    double mass = 0.5;               ///< kg
    double phi_bar = 0.75;           ///< opening angle / 2 pi
    double stiffness = 1.0; ///< bending stiffness over that of the paper's shell scaled to this radius and mass
    double mu = 0.35;       ///< friction coefficient
    int elements = 15;
    double cost = 1.0;       ///< of the budget
    std::optional<Point> at; ///< m, where it waits (clip)
};

/// What makes a scene a level (docs/levels.md). Keys that a kind of game does not use keep their defaults.
struct Game {
    std::string kind; ///< "egg_drop" | "lander" | "clip"
    std::string title, hint;
    std::string actor;                        ///< body the game is about
    std::string carrier;                      ///< clip: kinematic body that carries
    std::string service;                      ///< lander: body that holds spent legs while they are pulled off
    Point viewLower{-8, -1}, viewUpper{8, 8}; ///< m, what the picture shows at least
    Point goalLower{}, goalUpper{};           ///< m, where the actor has to be ...
    double hold = 1.0;                        ///< s, ... and stay
    double time = 60.0;                       ///< s, limit
    double limit = 10.0;                      ///< g, what the actor survives
    double budget = 10.0;
    std::vector<double> heights; ///< m, of the egg's lowest point above the crate's floor, one drop each
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
    std::optional<Drop> drop;
    std::optional<Protocol> protocol;
    std::vector<effects::Setting> effects; ///< gravity and misalignment are in the scene already
    Numerics numerics;
    Report report;
    std::optional<Game> game;
    double duration = 0.0; ///< s, for scenes without a protocol; with one: stop at the end of the moves
};

} // namespace supercircle::scene
