#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect plasticity() {
    Effect e;
    e.key = Key::Plasticity;
    e.name = "plasticity";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "the section yields where the moment is large and keeps a permanent curvature";
    e.law = "yield at |M| = M_y with linear hardening H: dM/dkappa = B H / (B + H) beyond; isotropic "
            "(the range widens with the accumulated plastic curvature) or kinematic (it moves)";
    e.fingerprint = "a knee in the first loading only; unloading is parallel and ends with a permanent set; later "
                    "cycles inside the yielded range are elastic";
    e.literature = "Simo and Hughes, Computational Inelasticity, 1998";
    e.parameters = {
        amplitude("My_over_B_1_m", "1/m", kInfinity, 1e-6, kInfinity, 25.0, "yield moment over bending modulus"),
        detail("H_over_B", "1", 0.3, 0.0, 1e3, "hardening modulus over bending modulus"),
        choice("hardening", {"isotropic", "kinematic"},
               "whether yielding in one direction delays yielding in the other")};
    e.apply = [](const Values& v, Model& m) {
        m.material.yield = v[0];
        m.material.hardening = v[1];
        m.material.kinematic = v[2] == 1.0;
    };
    return e;
}

} // namespace supercircle::effects
