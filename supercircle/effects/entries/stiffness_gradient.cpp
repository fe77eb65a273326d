#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect stiffnessGradient() {
    Effect e;
    e.key = Key::StiffnessGradient;
    e.name = "stiffness_gradient";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "one end is stiffer (thicker) than the other";
    e.law = "with x = 2 s / L - 1: modulus B (1 + gradient x); thickness B (1 + gradient x)^3; "
            "weight and contact keep the mean thickness";
    e.fingerprint = "left and right slip or snap at different times; markers move to the soft side";
    e.literature = "Timoshenko and Gere, Theory of Elastic Stability, 1961 (bars of variable section)";
    e.parameters = {
        amplitude("gradient", "1", 0.0, -0.95, 0.95, 0.1, "relative change from the middle to the last end"),
        choice("law", {"thickness", "modulus"}, "what changes linearly along the specimen")};
    e.apply = [](const Values& v, Model& m) {
        const Profile::Shape shape = v[1] == 0.0 ? Profile::Shape::Thickness : Profile::Shape::Linear;
        m.material.profiles.push_back({Key::StiffnessGradient, shape, 0.5, 1.0, v[0], 0.0});
    };
    return e;
}

} // namespace supercircle::effects
