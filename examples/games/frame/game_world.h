#pragma once
// The world of a level or scene: the b2World, its shells, and what the mouse drags.

#include "plugin/api/include/supercircle/scene.hpp"
#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/graphics/live/live_picture.h"
#include "plugin/graphics/live/live_sound.h"
#include "plugin/scene/loader/scene.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

class b2Body;

namespace supercircle::frame {

/// Step of all games, s.
inline constexpr double kStep = 1.0 / 60.0;

/// Pose of a rigid body, for pictures between two steps.
struct BodyPose {
    b2Body* body = nullptr;
    double x = 0.0, y = 0.0, angle = 0.0; ///< m, rad; of the body's origin
};

class GameWorld {
public:
    /// Loads a scene file; the error has one line per problem, file:line:column.
    static Result<std::shared_ptr<GameWorld>> load(const std::string& path,
                                                   const std::vector<std::pair<std::string, double>>& parameters = {},
                                                   Quality quality = Quality::Game);
    ~GameWorld();
    GameWorld(const GameWorld&) = delete;
    GameWorld& operator=(const GameWorld&) = delete;

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
    /// Creates a shell of one of the level's kinds, with its name and colour.
    Result<ShellHandle> add(const scene::GamePart& part, Point middle, double angle, Point velocity = {});
    [[nodiscard]] std::uint32_t colour(ShellHandle shell) const; ///< 0xRRGGBB

    /// One step of the game.
    FrameReport step(double dt = kStep);
    [[nodiscard]] const FrameReport& report() const;
    [[nodiscard]] double time() const; ///< s of play
    [[nodiscard]] std::uint64_t frames() const;
    /// Processor time of the steps so far, ms per frame: mean and largest. No result depends on it.
    [[nodiscard]] double meanCost() const;
    [[nodiscard]] double worstCost() const;

    /// Starts to drag the shell or dynamic body at (or within `reach`, m, of) a point. `strength`: largest force, N; 0:
    /// as Box2D's mouse joint. False if nothing is there.
    bool startDrag(Point at, double reach, double strength = 0.0, double shellFrequency = 5.0,
                   double bodyFrequency = 5.0);
    void moveMouse(Point to);
    void releaseMouse();
    [[nodiscard]] bool dragging() const;
    [[nodiscard]] ShellHandle draggedShell() const; ///< null: none
    [[nodiscard]] b2Body* draggedBody() const;      ///< null: none
    [[nodiscard]] int dragCount() const;            ///< drags so far
    [[nodiscard]] Point dragPoint() const;          ///< the dragged point, m
    [[nodiscard]] Point dragTarget() const;         ///< m

    /// For pictures: bodies and centre lines `alpha` of the way from the last step to this one (0 .. 1).
    [[nodiscard]] std::vector<BodyPose> bodies(double alpha) const;
    [[nodiscard]] std::vector<Point> line(ShellHandle shell, double alpha) const;
    /// The fixtures of a body, sensors left out.
    [[nodiscard]] std::vector<picture::Body> pieces(const BodyPose& pose) const;
    /// All shells, in the order of Shells::shells().
    [[nodiscard]] std::vector<picture::Shell> shellPictures(double alpha, double tolerance) const;
    [[nodiscard]] std::vector<picture::SnapMark> snaps();
    /// The sound of the steps since the last call, `seconds` of it.
    [[nodiscard]] std::span<const float> sound(double seconds);

private:
    GameWorld();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::frame
