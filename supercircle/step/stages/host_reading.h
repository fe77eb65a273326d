#pragma once
// What is read from the host, before it takes the place of what the world knew (private to step/).

#include "supercircle/step/stages/join_outlines.h"
#include "supercircle/step/world.h"

namespace supercircle::step {

struct HostReading {
    std::vector<BodyOutline> outlines;
    std::vector<BodyId> ids;
    std::vector<Body> bodies;
    std::vector<BodyId> refused;        ///< bodies with numbers that are not finite
    std::vector<BodyId> jumped;         ///< bodies that took along what is joined to them, sorted
    std::vector<std::uint32_t> carried; ///< keys of rods that went along
    std::string why;                    ///< what was left out, for the user; empty: nothing
    OutlineJoining joining;
    std::vector<Box> regions; ///< per rod, of which the hull was read. No step is accepted that leaves it
};

} // namespace supercircle::step
