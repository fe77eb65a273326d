#pragma once
// Everything the effects keep per rod, constants and state: plain data inside the saved world.

#include "supercircle/effects/drag.h"
#include "supercircle/effects/material.h"

namespace supercircle::effects {

struct RodEffects {
    Material material;
    Drag drag;
    Books books{};
    [[nodiscard]] bool on() const { return material.on() || drag.on(); }
};

} // namespace supercircle::effects
