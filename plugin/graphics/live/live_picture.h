#pragma once
// The picture of a running world: reads Shells and the outlines of the host's bodies into the plain data of
// plugin/graphics/picture, and remembers the snaps that the picture still shows.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/graphics/picture/world_picture.h"
#include "supercircle/step/port.h"

#include <vector>

namespace supercircle::live {

struct Layers {
    bool bodies = true, shells = true;
    bool energy = true; ///< shells coloured by their stored energy; else all alike
    bool contacts = true, forces = false, holds = true;
};

/// Pieces of bodies that are enabled, where they are now.
[[nodiscard]] std::vector<picture::Body> bodiesOf(const step::Port& port,
                                                  const std::vector<step::BodyOutline>& outlines);

/// Shells `alpha` of the way from the start (0) to the end (1) of the last frame, as Shells::pose. A polyline deviates
/// from the true curve by at most `tolerance` (m).
[[nodiscard]] std::vector<picture::Shell> shellsOf(const Shells& shells, double alpha, double tolerance);

/// Contacts that carry force, with their forces or without, and holds.
void addMarks(const Shells& shells, const Layers& layers, picture::Content& content);

/// Snaps of the frames since the last picture.
class SnapWatch {
public:
    /// After each frame.
    void frame(const Shells& shells);
    /// Of a picture at `clock` (s) of the viewer; 0: of the world.
    [[nodiscard]] std::vector<picture::SnapMark> at(const Shells& shells, double clock = 0.0);

private:
    picture::SnapMarks marks_;
};

} // namespace supercircle::live
