#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect bearingFriction() {
    Effect e;
    e.key = Key::BearingFriction;
    e.name = "bearing_friction";
    e.slot = Slot::Contact;
    e.about = "the bearings of a mechanism resist turning";
    e.law = "torque against the relative spin w of the two bodies: (torque_N_m + arm_m |reaction|) sign(w) + "
            "viscous_N_m_s w; at w = 0 any torque up to the dry part holds the joint";
    e.fingerprint = "dry: amplitudes of a free swing fall by the same amount each half swing, and it stops off "
                    "the vertical; viscous: by the same fraction";
    e.literature = "Coulomb (1785); Magnus, Popp and Sextro, Schwingungen, 2013, sec. 2.1; Squire, Am. J. Phys. 54, "
                   "984 (1986)";
    e.parameters = {amplitude("torque_N_m", "N m", 0.0, 0.0, 1e6, 1e-4, "dry torque of a bearing under preload"),
                    amplitude("arm_m", "m", 0.0, 0.0, 1e3, 1e-5, "friction coefficient times radius of the bearing"),
                    amplitude("viscous_N_m_s", "N m s", 0.0, 0.0, 1e6, 1e-5, "viscous torque over spin")};
    e.apply = [](const Values& v, Model& m) {
        m.bodies.bearingTorque = v[0];
        m.bodies.bearingArm = v[1];
        m.bodies.bearingViscosity = v[2];
    };
    return e;
}

} // namespace supercircle::effects
