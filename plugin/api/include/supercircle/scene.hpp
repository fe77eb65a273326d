#pragma once
// A JSON scene (docs/scenes.md) inside a loop of your own:
//
//     auto loaded = supercircle::load_scene("scenes/stack30.json", shells);
//     if (!loaded) return complain(loaded.error());            // file:line:column: what is wrong
//     for (supercircle::ScenePlayer scene = *loaded; !scene.finished();) {
//         const auto frame = scene.pre_step(1.0 / 60.0);       // instead of shells.pre_step
//         world.Step(float(frame.advanced), 8, 3);
//         scene.post_step();
//     }

#include "shells.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supercircle {

struct SceneOptions {
    std::vector<std::pair<std::string, double>> parameters; ///< values for the scene's knobs, by name
    std::uint64_t seed = 1;                                 ///< of the random drop
};

/// A scene being played. A cheap handle: copies play the same scene. The Shells it was loaded into must stay where they
/// are and outlive it.
class ScenePlayer {
public:
    /// Advances the scene by at most dt (s): drops shells when their turn comes, moves the machine as the protocol
    /// says, and calls Shells::pre_step. A move that ends inside the frame ends the frame: step your world by
    /// FrameReport::advanced.
    FrameReport pre_step(double dt);
    /// Shells::post_step().
    void post_step();

    /// The protocol (or, without one, the scene's duration) is over, or the shells could not go on.
    [[nodiscard]] bool finished() const;
    /// What is going on: "drop 7", "settle", "approach", "load 1", "unload 1", "hold", "free", "done".
    [[nodiscard]] std::string phase() const;
    [[nodiscard]] double travel() const; ///< m, of the machine along its direction, since first touch if so defined
    [[nodiscard]] double force() const;  ///< N, on the machine, positive while the specimen resists
    [[nodiscard]] const std::vector<ShellHandle>& shells() const; ///< so far, in order of appearance
    [[nodiscard]] const std::string& name() const;

private:
    struct Impl;
    explicit ScenePlayer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
    friend Result<ScenePlayer> load_scene(const std::string&, Shells&, const SceneOptions&);
    std::shared_ptr<Impl> impl_;
};

/// Reads and checks a scene file, builds its rigid bodies and joints in the host world of `shells` (whose gravity
/// becomes the scene's; the scene's lengthScale is ignored, the world's own scale rules) and puts its shells there.
/// On failure nothing was added, and the error has one line per problem: file:line:column: pointer: what is wrong.
Result<ScenePlayer> load_scene(const std::string& path, Shells& shells, const SceneOptions& options = {});

} // namespace supercircle
