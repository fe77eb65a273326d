#pragma once
// Everything the effects keep per rod, constants and state: plain data inside the saved world.

#include "supercircle/effects/laws/attraction.h"
#include "supercircle/effects/laws/drag.h"
#include "supercircle/effects/laws/material.h"
#include "supercircle/effects/laws/surface.h"

namespace supercircle::effects {

struct RodEffects {
    Material material;
    Drag drag;
    Surface surface;
    Attraction attraction;
    Books books{};
    /// Of one rod alone; its surface and attraction concern others too.
    [[nodiscard]] bool on() const { return material.on() || drag.on(); }
};

/// All slots that act on a rod, at rest.
RodEffects makeRodEffects(const rod::RodModel& rod, const Model& model);
/// A long rest: viscous stresses go, surfaces heal. What is plastic, worn or held by dry friction stays.
void rest(RodEffects& effects);

} // namespace supercircle::effects
