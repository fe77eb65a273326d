#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect airDrag() {
    Effect e;
    e.key = Key::AirDrag;
    e.name = "air_drag";
    e.slot = Slot::Load;
    e.perShell = true;
    e.about = "air resists the motion of shells, and of rigid bodies in experiments";
    e.law = "against the normal, with v the speed along it: per length linear_N_s_m2 v + quadratic_N_s2_m3 v^2, of "
            "shells everywhere, of rigid bodies on every part of the outline that moves outwards; quadratic = drag "
            "coefficient times depth times half the density of air";
    e.fingerprint = "large swings are damped more strongly: amplitude falls as 1/t (quadratic) or exponentially "
                    "(linear), and never comes to a stop";
    e.literature = "Batchelor, An Introduction to Fluid Dynamics, 1967, sec. 5.11; Nelson and Olsson, Am. J. Phys. 54, "
                   "112 (1986)";
    e.parameters = {
        amplitude("linear_N_s_m2", "N s/m^2", 0.0, 0.0, 1e6, 1e-3, "force per length over speed"),
        amplitude("quadratic_N_s2_m3", "N s^2/m^3", 0.0, 0.0, 1e6, 1e-2, "force per length over speed squared")};
    e.apply = [](const Values& v, Model& m) {
        m.air = {v[0], v[1]};
        m.bodies.airLinear = v[0];
        m.bodies.airQuadratic = v[1];
    };
    return e;
}

} // namespace supercircle::effects
