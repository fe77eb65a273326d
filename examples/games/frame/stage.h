#pragma once
// A level being played: the b2World, the shells in it, and what the hand of the player holds.

#include "plugin/api/include/supercircle/scene.hpp"
#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/scene/loader/scene.h"

#include <memory>
#include <string>
#include <vector>

class b2Body;

namespace supercircle::frame {

/// The one step of all games, s.
inline constexpr double kStep = 1.0 / 60.0;

/// Where a rigid body was, for pictures between two steps.
struct BodyPose {
    b2Body* body = nullptr;
    double x = 0.0, y = 0.0, angle = 0.0; ///< m, rad; of the body's origin
};

class Stage {
public:
    /// Loads a scene file; the error has one line per problem, file:line:column.
    static Result<std::shared_ptr<Stage>> load(const std::string& path,
                                               const std::vector<std::pair<std::string, double>>& parameters = {},
                                               Quality quality = Quality::Game);
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    [[nodiscard]] const scene::Scene& scene() const;
    /// The level's game section; defaults when the scene has none.
    [[nodiscard]] const scene::Game& game() const;
    [[nodiscard]] const std::string& path() const;
    Shells& shells();
    [[nodiscard]] const Shells& shells() const;
    [[nodiscard]] ScenePlayer& player();

    /// The body of that name; null if there is none. Positions of bodies are in units(), everything else here in m.
    [[nodiscard]] b2Body* body(const std::string& name) const;
    [[nodiscard]] std::uint64_t id(const b2Body& body) const;
    /// Box2D units per metre of this world.
    [[nodiscard]] double units() const;
    [[nodiscard]] Point position(const b2Body& body) const;    ///< of its centre of mass, m
    [[nodiscard]] Point velocity(const b2Body& body) const;    ///< m/s
    void push(b2Body& body, Point force, double torque = 0.0); ///< N and N m during the coming step
    /// A shell of one of the level's kinds at a place; named and coloured after it.
    Result<ShellHandle> add(const scene::GamePart& part, Point middle, double angle, Point velocity = {});
    [[nodiscard]] std::uint32_t colour(ShellHandle shell) const; ///< 0xRRGGBB

    /// One step of the game.
    FrameReport step(double dt = kStep);
    [[nodiscard]] const FrameReport& report() const;
    [[nodiscard]] double time() const; ///< s of play
    [[nodiscard]] std::uint64_t frames() const;
    /// Processor time of the steps so far, ms a frame: mean and worst. Nothing in the game depends on it.
    [[nodiscard]] double meanCost() const;
    [[nodiscard]] double worstCost() const;

    /// The player's hand: takes the shell or dynamic body at (or near) a place, and lets it go. `strength` N, 0: of
    /// Box2D's mouse.
    bool take(Point at, double reach, double strength = 0.0, double shellFrequency = 5.0, double bodyFrequency = 5.0);
    void moveHand(Point to);
    void letGo();
    [[nodiscard]] bool holding() const;
    [[nodiscard]] ShellHandle heldShell() const; ///< null: none
    [[nodiscard]] b2Body* heldBody() const;      ///< null: none
    [[nodiscard]] int timesHeld() const;         ///< how often it has taken hold of something
    [[nodiscard]] Point handAt() const;          ///< what it holds, m
    [[nodiscard]] Point handTarget() const;      ///< m

    /// For pictures: bodies and centre lines `alpha` of the way from the last step to this one (0 .. 1).
    [[nodiscard]] std::vector<BodyPose> bodies(double alpha) const;
    [[nodiscard]] std::vector<Point> line(ShellHandle shell, double alpha) const;

private:
    Stage();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::frame
