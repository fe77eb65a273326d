#pragma once
// Which contact candidates a step really needs (private to step/; Settings::cull).
//
// Detection bounds how far a rod moves but not its direction: in a rain of shells, all falling alike, at steps of 1/60
// s four candidates of five part or keep their distance. Here each is asked whether its two points approach each other
// fast enough to meet within the step, with room for changes of velocity. What is left out by mistake - a rod thrown
// against its neighbour by an impact within the step - is seen at the end of the step, where all candidates are found
// anew: it is then added and the step linearised again, or cut. On 200 falling shells this leaves a quarter of the
// candidates.

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Candidates of `all` that may touch within `dt` (s); those that carry force are kept. `slack` in m.
void cull(const World& world, double dt, double slack, const std::vector<contact::Candidate>& all,
          std::vector<contact::Candidate>& kept);

} // namespace supercircle::step
