#pragma once
// A world behind a handle, and the way into it: `use(handle, work)` looks it up, locks it and runs the work.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "bridge/c/guard.h"
#include "bridge/c/include/supercircle.h"
#include "bridge/c/tables.h"
#include "plugin/api/include/supercircle/scene.hpp"
#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/graphics/live/live_picture.h"
#include "plugin/graphics/live/live_sound.h"

#include <box2d/box2d.h>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace supercircle::c {

/// A spring on a shell, or (id of the body's joint in Box2D) on a body.
struct Spring {
    MouseJointHandle onShell{};
    std::uint64_t onBody = 0; ///< user data of the b2MouseJoint
};

struct Zone {
    Box box{};
    std::vector<ShellHandle> inside{};
};

struct PlayedScene {
    std::shared_ptr<ScenePlayer> player{};
    std::string parameters{}; ///< as JSON
};

struct World {
    World(std::uint32_t slot, std::unique_ptr<b2World> owned, b2World& world, double unitsPerMetre);

    std::unique_ptr<b2World> own; ///< null: the host's
    b2World* box2d;
    double scale; ///< Box2D units per metre
    bridge::Attachment attachment;
    Shells shells;
    int velocityIterations = 8, positionIterations = 3;

    Names<ShellHandle> shellNames;
    Names<HoldHandle> holdNames;
    Names<JointHandle> jointNames;
    Names<ForceHandle> forceNames;
    Names<BodyId> bodyNames;
    Table<Spring> springs;
    Table<Zone> zones;
    Table<PlayedScene> scenes;

    std::vector<sc_event> zoneEvents; ///< of the last step
    std::string report = "{}";        ///< of the last frame, JSON
    std::deque<Snapshot> saved;       ///< the last ones, to know them again
    double lastStep = 0.0;            ///< of the bodies, s
    live::SnapWatch snaps;            ///< that a picture still shows
    picture::DrawList picture;        ///< the last one
    live::SoundWatch sound;

    std::uint64_t id = 0;
    std::mutex busy;
    bool gone = false;  ///< destroyed while another call waited for it
    std::string broken; ///< what broke it; then only its destruction is left

    // Handles of the library to those of C and back; the way back refuses stale ones.
    sc_shell out(const ShellHandle& h);
    sc_hold out(const HoldHandle& h);
    sc_joint out(const JointHandle& h);
    sc_force out(const ForceHandle& h);
    sc_body outBody(BodyId body);
    ShellHandle in(sc_shell s);
    HoldHandle in(sc_hold h);
    JointHandle in(sc_joint j);
    ForceHandle in(sc_force f);
    b2Body& in(sc_body b);
    BodyId idOf(sc_body b);
    /// Refuses inside the host's own step.
    void requireUnlocked() const;
};

/// Puts a new world into the registry; refuses when it is full.
sc_world enlist(const sc_world_def* def, b2World* host);
/// Takes it out.
void strike(sc_world w);
/// The locked world of a handle (only its slot and generation count); refuses stale, busy and broken ones.
class Inside {
public:
    explicit Inside(sc_world w) : Inside(worldSlot(w.id), w.id == 0 ? 1 : w.id) {}
    /// Of the world with that slot, if `id` is 0: for handles that bring no world.
    Inside(std::uint32_t slot, std::uint64_t id);
    World* operator->() const { return world_.get(); }
    World& operator*() const { return *world_; }

private:
    std::shared_ptr<World> world_;
    std::unique_lock<std::mutex> lock_;
};

/// Runs `work(World&)`. An exception that no call expects breaks the world: its state may be half changed.
template <class F>
void inside(Inside& world, F&& work) {
    try {
        work(*world);
    } catch (const AssertionFailed& e) {
        world->broken = e.why;
        throw Refusal(SC_FAILED, e.why);
    }
}
template <class F>
sc_status use(sc_world w, F&& work) noexcept {
    return shielded([&] {
        Inside world(w);
        inside(world, work);
    });
}
template <class F>
int32_t countIn(sc_world w, F&& work) noexcept {
    return counted([&] {
        Inside world(w);
        int32_t n = 0;
        inside(world, [&](World& x) { n = work(x); });
        return n;
    });
}
template <class R, class F>
R valueIn(sc_world w, R otherwise, F&& work) noexcept {
    return valued(otherwise, [&] {
        Inside world(w);
        R out = otherwise;
        inside(world, [&](World& x) { out = work(x); });
        return out;
    });
}
template <class F>
const char* textIn(sc_world w, F&& work) noexcept {
    return text([&] {
        Inside world(w);
        std::string out;
        inside(world, [&](World& x) { out = work(x); });
        return out;
    });
}
/// 1 if `find(World&)` is true; 0 if not, or if there is no such world.
template <class F>
int32_t validIn(sc_world w, F&& find) noexcept {
    return valueIn(w, int32_t{0}, [&](World& x) { return find(x) ? 1 : 0; });
}

inline Point in(sc_point p) {
    return {p.x, p.y};
}
inline sc_point out(const Point& p) {
    return {p.x, p.y};
}
inline sc_reaction out(const Reaction& r) {
    return {out(r.force), r.torque};
}

/// Advances shells (through the scene, if given) and bodies; refuses with SC_FAILED after a failed frame.
void step(World& w, double dt, sc_frame& out, ScenePlayer* scene);
/// The same in a host's world, before and after the host's step.
void preStep(World& w, double dt, sc_frame& out, ScenePlayer* scene);
void postStep(World& w);
/// After a frame: the report, and what zones have to say.
void describe(World& w, const FrameReport& report, sc_frame& out);
void watchZones(World& w);
/// {"failure", "why", "refused", "note"}
std::string reportJson(const FrameReport& report);

} // namespace supercircle::c
