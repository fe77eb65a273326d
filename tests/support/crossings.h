#pragma once
// Pairs that cross, by the crossing check alone.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/contact/crossing.h"
#include "supercircle/step/world.h"

#include <vector>

namespace supercircle::test {

/// Number of pairs that cross in the present configuration, whatever the world's overlaps say. Those of the body
/// `without` are left out.
inline std::size_t crossings(const Shells& shells, step::BodyId without = 0) {
    const step::World& w = shells.world();
    std::vector<contact::RodCurve> curves(w.rods.size());
    for (std::size_t i = 0; i < curves.size(); ++i)
        step::toCurve(w.rods[i], w.rods[i].kin, curves[i]);
    std::vector<contact::Outline> outlines;
    for (const step::BodyOutline& o : w.outlines)
        for (const step::Body& b : w.bodies)
            if (b.id == o.body && b.id != without)
                outlines.push_back(step::placed(o, b.state.centre, b.state.angle));
    std::vector<contact::Crossing> found;
    contact::findCrossings(curves, outlines, found);
    return found.size();
}

} // namespace supercircle::test
