#include "supercircle/effects/rod_effects.h"

namespace supercircle::effects {

RodEffects makeRodEffects(const rod::RodModel& rod, const Model& model) {
    RodEffects fx;
    fx.material = makeMaterial(rod, model.material);
    fx.drag = makeDrag(rod, model.drag);
    fx.surface = makeSurface(rod, model.contact);
    fx.attraction = makeAttraction(rod, model.contact.adhesion);
    return fx;
}

void rest(RodEffects& fx) {
    rest(fx.material);
    rest(fx.surface);
}

} // namespace supercircle::effects
