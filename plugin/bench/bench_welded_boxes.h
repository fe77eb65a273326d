#pragma once
// Shells as Box2D users build them, for comparison: N boxes joined by weld joints whose springs carry the bending
// stiffness, in the same scenes and with the same crossing check as shells of Supercircle.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/bench/bench_game_scenes.h"
#include "supercircle/contact/geometry.h"
#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <memory>
#include <string>
#include <vector>

namespace supercircle::cli {

/// How the boxes are welded and stepped.
struct WeldedBoxSettings {
    int substeps = 1;        ///< of the host, per frame of 1/60 s (8 velocity and 3 position iterations each)
    bool soft = true;        ///< springs of stiffness B / length in the joints; false: rigid welds
    double damping = 0.1;    ///< damping ratio of the springs; 0.02 and 1 give the same results
    double lengthScale = 10; ///< Box2D units per metre: boxes of 0.26 units, well above Box2D's skin of 0.01
};

/// Shells of welded boxes in a host world.
class WeldedShells {
public:
    WeldedShells(step::RigidWorldDefinition rest, const WeldedBoxSettings& settings)
        : settings_(settings), definition_(std::move(rest)) {
        definition_.lengthScale = settings.lengthScale;
    }
    /// `pose` is where the shell is; one box per arc. `held`: the middle box is kinematic.
    void add(const ShellDef& shell, const ShellPose& pose, bool held);
    /// Builds the world. Empty, or why not.
    [[nodiscard]] std::string build(std::unique_ptr<step::HostWorld>& host);

    /// Centre lines through the joints, for the crossing check.
    [[nodiscard]] std::vector<contact::RodCurve> curves(const step::HostWorld& host) const;
    /// Largest distance between the two ends that a joint should keep together, over all shells: of one joint, and the
    /// sum over a shell relative to its length.
    [[nodiscard]] double stretch(const step::HostWorld& host) const;
    [[nodiscard]] step::BodyId heldBody() const { return held_; }
    [[nodiscard]] std::size_t boxes() const { return boxes_.size(); }

private:
    struct Box {
        step::BodyId id = 0;
        double half = 0.0; ///< half length, m
    };
    struct BoxShell {
        std::size_t first = 0, count = 0;
        double length = 0.0, thickness = 0.0;
    };
    WeldedBoxSettings settings_;
    step::RigidWorldDefinition definition_;
    std::vector<Box> boxes_;
    std::vector<BoxShell> shells_;
    step::BodyId held_ = 0;
};

GameRun weldedCylinder(const CylinderCase& which, const WeldedBoxSettings& settings, int boxes);
GameRun weldedPile(const PileCase& pile, const WeldedBoxSettings& settings);

/// Content of a PNG file: both piles side by side; empty after an error.
[[nodiscard]] std::string weldedBoxesPicture(const GameRun& ours, const GameRun& boxes, const GameRun& tuned,
                                             std::string& error);

} // namespace supercircle::cli
