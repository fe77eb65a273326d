#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect guideFriction() {
    Effect e;
    e.key = Key::GuideFriction;
    e.name = "guide_friction";
    e.slot = Slot::Contact;
    e.about = "the guides of a mechanism resist sliding";
    e.law = "force against the relative speed v along each guide: force_N sign(v) + viscous_N_s_m v + "
            "quadratic_N_s2_m2 |v| v; at v = 0 any force up to the dry part holds the guide";
    e.fingerprint = "dry: amplitudes of a free oscillation fall by the same amount each half cycle, and it stops off "
                    "the middle; viscous: by the same fraction; quadratic: large ones lose more than their share";
    e.literature = "Coulomb (1785); Magnus, Popp and Sextro, Schwingungen, 2013, sec. 2.1";
    e.parameters = {amplitude("force_N", "N", 0.0, 0.0, 1e9, 1e-2, "dry friction"),
                    amplitude("viscous_N_s_m", "N s/m", 0.0, 0.0, 1e9, 1e-2, "viscous force over speed"),
                    amplitude("quadratic_N_s2_m2", "N s^2/m^2", 0.0, 0.0, 1e9, 1e-2, "force over speed squared")};
    e.apply = [](const Values& v, Model& m) {
        m.bodies.guideForce = v[0];
        m.bodies.guideViscosity = v[1];
        m.bodies.guideQuadratic = v[2];
    };
    return e;
}

} // namespace supercircle::effects
