#pragma once
// A JSON scene (docs/reference/scene_format.md) in your own loop:
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
    std::vector<std::pair<std::string, double>> parameters; ///< values of the scene's parameters, by name
    std::uint64_t seed = 1;                                 ///< of the random drop
};

/// Plays a scene. Copies refer to the same scene. The Shells it was loaded into must not be moved and must outlive it.
class ScenePlayer {
public:
    /// Advances the scene by at most dt (s): drops shells, moves the crosshead according to the protocol, and calls
    /// Shells::pre_step. The end of a protocol segment ends the frame: step your world by FrameReport::advanced.
    FrameReport pre_step(double dt);
    /// Shells::post_step().
    Status post_step();

    /// The end of the protocol (or, without one, of the scene's duration), or a failure.
    [[nodiscard]] bool finished() const;
    /// The present phase: "drop 7", "settle", "approach", "load 1", "unload 1", "hold", "free", "done".
    [[nodiscard]] std::string phase() const;
    [[nodiscard]] double
    travel() const; ///< of the crosshead along its direction, m; from the first contact if the scene says so
    [[nodiscard]] double force() const; ///< on the crosshead, N; positive while the specimen resists
    [[nodiscard]] const std::vector<ShellHandle>& shells() const; ///< created so far, in order
    [[nodiscard]] const std::string& name() const;

private:
    struct Impl;
    explicit ScenePlayer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
    friend Result<ScenePlayer> load_scene_text(const std::string&, const std::string&, Shells&, const SceneOptions&);
    std::shared_ptr<Impl> impl_;
};

/// Reads and checks a scene file and creates its bodies, joints and shells in the host world of `shells`. The world's
/// gravity becomes that of the scene; its length scale stays (lengthScale of the scene is ignored). After a failure
/// nothing was added, and the error has one line per problem: file:line:column: pointer: what is wrong.
Result<ScenePlayer> load_scene(const std::string& path, Shells& shells, const SceneOptions& options = {});
/// The same from a text; `file` is its name in messages.
Result<ScenePlayer> load_scene_text(const std::string& text, const std::string& file, Shells& shells,
                                    const SceneOptions& options = {});

} // namespace supercircle
