#include "supercircle/effects/rod_effects.h"

namespace supercircle::effects {

RodEffects makeRodEffects(const rod::RodModel& rod, const Model& model) {
    RodEffects fx;
    fx.material = makeMaterial(rod, model.material);
    fx.drag = makeDrag(rod, model.drag);
    fx.surface = makeSurface(rod, model.contact);
    fx.adhesion = makeAdhesion(rod, model.contact.adhesion);
    return fx;
}

void applyLongRest(RodEffects& fx) {
    applyLongRest(fx.material);
    applyLongRest(fx.surface);
}

} // namespace supercircle::effects
