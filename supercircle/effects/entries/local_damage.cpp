#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect localDamage() {
    Effect e;
    e.key = Key::LocalDamage;
    e.name = "local_damage";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "a crease: lost stiffness and a permanent set at one position";
    e.law = "B (1 - stiffness_drop g(s)), kappa0 + curvature_change_1_m g(s), g = exp(-((s - s0) / "
            "gauss_width_m)^2 / 2), s0 = arc_fraction L";
    e.fingerprint = "lower force, and left and right differ; a specimen rotated end for end shows the mirror image";
    e.literature = "Lechenault, Thiria and Adda-Bedia, Phys. Rev. Lett. 112, 244301 (2014)";
    e.parameters = {
        amplitude("stiffness_drop", "1", 0.0, 0.0, 0.99, 0.4, "fraction of the bending modulus lost at the position"),
        amplitude("curvature_change_1_m", "1/m", 0.0, -1e4, 1e4, -20.0, "change of natural curvature at the position"),
        detail("arc_fraction", "1", 0.5, 0.0, 1.0, "position: 0 first end, 1 last end"),
        detail("gauss_width_m", "m", 2.5e-3, 1e-6, 10.0, "standard deviation of the damage along the arc")};
    e.apply = [](const Values& v, Model& m) {
        m.material.profiles.push_back({Key::LocalDamage, Profile::Shape::Gauss, v[2], v[3], -v[0], v[1]});
    };
    e.repeatable = true;
    return e;
}

} // namespace supercircle::effects
