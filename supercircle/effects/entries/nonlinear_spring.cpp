#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect nonlinearSpring() {
    Effect e;
    e.key = Key::NonlinearSpring;
    e.name = "nonlinear_spring";
    e.slot = Slot::Material;
    e.about = "the springs of a mechanism are not linear";
    e.law = "force of a spring k x (1 + cubic_1_m2 x^2), torque of a turning one k x (1 + cubic_1_rad2 x^2), x from "
            "its rest; positive: hardens, negative: softens";
    e.fingerprint = "the frequency changes with the amplitude, by 3 cubic A^2 / 8 of itself; losses do not do that";
    e.literature = "Duffing, Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz (1918)";
    e.parameters = {amplitude("cubic_1_m2", "1/m^2", 0.0, -1e12, 1e12, 10.0, "cubic part over the linear one"),
                    amplitude("cubic_1_rad2", "1/rad^2", 0.0, -1e6, 1e6, 0.1, "the same of a turning spring")};
    e.apply = [](const Values& v, Model& m) {
        m.bodies.springCubic = v[0];
        m.bodies.turningSpringCubic = v[1];
    };
    return e;
}

} // namespace supercircle::effects
