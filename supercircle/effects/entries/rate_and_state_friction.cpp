#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect rateAndStateFriction() {
    Effect e;
    e.key = Key::RateAndStateFriction;
    e.name = "rate_and_state_friction";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "friction depends on the speed of sliding and on the age of the contacts";
    e.law = "mu (1 + a_over_mu ln((|v| + creep_m_s) / V0_m_s) + b_over_mu ln(theta V0_m_s / Dc_m)), the declared mu in "
            "steady sliding at V0_m_s; ageing dtheta/dt = 1 - |v| theta / Dc_m; slip dtheta/dt = -x ln x, x = |v| "
            "theta / Dc_m";
    e.fingerprint = "after a jump of the speed friction first follows it and then comes back over a slip of Dc; steady "
                    "friction changes by a - b; the peak after a rest grows with the logarithm of its duration";
    e.literature = "Dieterich, J. Geophys. Res. 84, 2161 (1979); Ruina, J. Geophys. Res. 88, 10359 (1983); Marone, "
                   "Annu. Rev. Earth Planet. Sci. 26, 643 (1998)";
    e.parameters = {choice("law", {"ageing", "slip"}, "whether contacts age at rest or with slip alone"),
                    amplitude("a_over_mu", "1", 0.0, 0.0, 1.0, 0.02, "direct effect of the speed"),
                    amplitude("b_over_mu", "1", 0.0, 0.0, 1.0, 0.03, "effect of the age of the contacts"),
                    detail("Dc_m", "m", 1e-5, 1e-9, 1.0, "slip that renews the contacts"),
                    detail("V0_m_s", "m/s", 1e-3, 1e-9, 1e3, "speed of the declared coefficient"),
                    detail("creep_m_s", "m/s", 1e-7, 1e-12, 1e3,
                           "speed below which friction does not depend on it, so that surfaces stick"),
                    detail("rest_s", "s", 60.0, 1e-6, 1e9, "age of the contacts of a rested specimen")};
    e.apply = [](const Values& v, Model& m) {
        FrictionModel& f = m.contact.friction;
        f.stateBySlip = v[0] != 0.0;
        f.direct = v[1];
        f.evolution = v[2];
        f.stateSlip = v[3];
        f.stateSpeed = v[4];
        f.stateCreep = v[5];
        f.stateRest = v[6];
    };
    return e;
}

} // namespace supercircle::effects
