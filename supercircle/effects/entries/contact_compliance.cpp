#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect contactCompliance() {
    Effect e;
    e.key = Key::ContactCompliance;
    e.name = "contact_compliance";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "every contact is elastic along the normal, and along the tangent before it slides";
    e.law = "gap + normal_m_N N = 0 in contact; a tangential spring of tangential_m_N under the "
            "Coulomb slider";
    e.fingerprint = "steep branches (reversals, flat contacts) are less steep in proportion to force; like "
                    "machine compliance, but distributed over the contacts";
    e.literature = "Johnson, Contact Mechanics, 1985; Mindlin, J. Appl. Mech. 16, 259 (1949)";
    e.parameters = {amplitude("normal_m_N", "m/N", 0.0, 0.0, 1.0, 1e-5, "normal compliance"),
                    amplitude("tangential_m_N", "m/N", 0.0, 0.0, 1.0, 1e-5, "tangential compliance before sliding")};
    e.apply = [](const Values& v, Model& m) { m.contact.compliance = {v[0], v[1]}; };
    return e;
}

} // namespace supercircle::effects
