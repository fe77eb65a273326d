#include "supercircle/effects/rod_effects.h"

namespace supercircle::effects {

RodEffects makeRodEffects(const rod::RodModel& rod, const Model& model) {
    RodEffects fx;
    fx.material = makeMaterial(rod, model.material);
    fx.drag = makeDrag(rod, model.drag);
    fx.air = makeAir(rod, model.air);
    fx.surface = makeSurface(rod, model.contact);
    fx.adhesion = makeAdhesion(rod, model.contact.adhesion);
    return fx;
}

RodEffects replaceRodEffects(const rod::RodModel& rod, const Model& model, const RodEffects& before) {
    RodEffects fx = makeRodEffects(rod, model);
    const auto keepEnergy = [&](Slot slot) {
        for (const Effect& e : catalog())
            if (e.slot == slot)
                fx.energies[static_cast<std::size_t>(e.key)].stored =
                    before.energies[static_cast<std::size_t>(e.key)].stored;
    };
    if (model.material == before.material.model) {
        fx.material = before.material;
        keepEnergy(Slot::Material);
    }
    if (model.drag == before.drag.model) {
        fx.drag = before.drag;
        keepEnergy(Slot::Load);
    }
    if (model.contact == before.surface.model) {
        fx.surface = before.surface;
        fx.adhesion = before.adhesion;
        keepEnergy(Slot::Contact);
    }
    return fx;
}

void applyLongRest(RodEffects& fx) {
    applyLongRest(fx.material);
    applyLongRest(fx.surface);
}

} // namespace supercircle::effects
