#pragma once
// Everything the effects keep per rod, constants and state: plain data inside the saved world.

#include "supercircle/effects/effect.h"
#include "supercircle/effects/laws/adhesion.h"
#include "supercircle/effects/laws/air.h"
#include "supercircle/effects/laws/drag.h"
#include "supercircle/effects/laws/material.h"
#include "supercircle/effects/surface.h"

namespace supercircle::effects {

struct RodEffects {
    Material material;
    Drag drag;
    Air air;
    Surface surface;
    Adhesion adhesion;
    EffectEnergies energies{};
    std::vector<Setting> settings; ///< what the models were made of, if given as settings; no step reads it
    /// True for effects of the rod alone; surface and adhesion involve other objects, too.
    [[nodiscard]] bool on() const { return material.on() || drag.on() || air.on(); }
};

/// All slots that act on a rod, in their initial state.
RodEffects makeRodEffects(const rod::RodModel& rod, const Model& model);
/// The same on a rod that has effects already: slots whose model stays keep their state and stored energy, the others
/// start at rest. Nothing is dissipated yet.
RodEffects replaceRodEffects(const rod::RodModel& rod, const Model& model, const RodEffects& before);
/// State after a long rest: viscous stresses have relaxed, surfaces have healed. Plastic curvature, wear and the
/// springs of dry friction stay.
void applyLongRest(RodEffects& effects);

} // namespace supercircle::effects
