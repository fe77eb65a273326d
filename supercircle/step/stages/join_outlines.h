#pragma once
// Outlines as they are read, joined where they touch (private to step/; contact/seams.h says why).

#include "supercircle/contact/seams.h"
#include "supercircle/step/world.h"

namespace supercircle::step {

/// Where a shell may get within the frame.
struct ShellReach {
    Box box;
    double thickness = 0.0; ///< m
};

/// What was joined last, kept from frame to frame so that a world at rest costs a comparison. No state.
struct OutlineJoining {
    std::vector<BodyOutline> raw; ///< as the host gave them
    std::vector<contact::SeamPiece> pieces;
    double frame = 0.0; ///< s
    contact::SeamJoiner joiner;
    std::vector<BodyOutline> rawNext, found; ///< storage
    std::vector<contact::SeamPiece> next;
    std::vector<Vec2> farther;
    std::vector<ShellReach> shells;
    std::vector<contact::OutlineSeams> spare;
};

/// Replaces outlines as the host gives them in the region `read` (sorted by body and key) by joined ones. `bodies` are
/// sorted by id and own all of them; the host is about to step by `frame` s.
void joinOutlines(const World& world, const Port& port, const Box& read, const std::vector<Body>& bodies, double frame,
                  OutlineJoining& joining, std::vector<BodyOutline>& outlines);

/// Empties a list of joined outlines and keeps the storage of their seams.
void clearJoined(OutlineJoining& joining, std::vector<BodyOutline>& outlines);

/// True if two outlines are equal but for their seams. Seams follow from the outlines and from where shells are; they
/// change before a shell is near, so that no known contact depends on the change. Points that lie no farther apart than
/// `joined` are the same.
bool sameButSeams(const BodyOutline& a, const BodyOutline& b, double joined = 0.0);

} // namespace supercircle::step
