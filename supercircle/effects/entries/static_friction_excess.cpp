#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect staticFrictionExcess() {
    Effect e;
    e.key = Key::StaticFrictionExcess;
    e.name = "static_friction_excess";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "friction at rest is higher than in sliding: it weakens with slip and heals at rest";
    e.law = "mu = mu_k (1 + (mu_s_over_mu_k - 1) w), dw/dt = (1 - w) / tau_heal_s - w |v| / Dc_m; w "
            "= 1 on fresh surfaces; before it slides a contact deflects by presliding_m F / (mu N)";
    e.fingerprint = "force peaks at first sliding, after every reversal and after holds, higher after longer "
                    "ones; small stick-slip";
    e.literature = "Rabinowicz, J. Appl. Phys. 22, 1373 (1951); Dieterich, J. Geophys. Res. 84, 2161 "
                   "(1979); Baumberger and Caroli, Adv. Phys. 55, 279 (2006) (also the elastic length, 3.3)";
    e.parameters = {amplitude("mu_s_over_mu_k", "1", 1.0, 1.0, 100.0, 1.4,
                              "static over kinetic friction; the declared coefficient is the kinetic one"),
                    detail("Dc_m", "m", 1e-4, 1e-7, 1.0, "slip in which the excess fades"),
                    detail("tau_heal_s", "s", 3.0, 1e-6, 1e9, "time at rest in which it recovers"),
                    detail("presliding_m", "m", 0.0, 0.0, 1e-2,
                           "elastic motion before sliding (0: none); its stiffness is mu N / presliding_m")};
    e.apply = [](const Values& v, Model& m) {
        m.contact.friction.staticRatio = v[0];
        m.contact.friction.slipWeakening = v[1];
        m.contact.friction.healing = v[2];
        m.contact.friction.presliding = v[3];
    };
    return e;
}

} // namespace supercircle::effects
