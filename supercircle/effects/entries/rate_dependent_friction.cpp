#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect rateDependentFriction() {
    Effect e;
    e.key = Key::RateDependentFriction;
    e.name = "rate_dependent_friction";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "friction depends on the speed of sliding";
    e.law = "stribeck mu (1 + strength (1 - exp(-|v| / speed_m_s))); logarithmic mu (1 + strength "
            "ln(1 + |v| / speed_m_s)); viscous mu (1 + strength |v| / speed_m_s); learned mu (1 + strength "
            "S(1/2 + log10(|v| / speed_m_s) / 4)), S a cubic spline on [0, 1]; table the same over six decades; the "
            "declared "
            "coefficient is that of the slow limit";
    e.fingerprint = "the plateau of sliding moves with speed, with the same sign in loading and unloading; "
                    "holds and slow runs do not show it";
    e.literature = "Stribeck, VDI-Z. 46 (1902); Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica "
                   "30, 1083 (1994)";
    e.parameters = {
        choice("law", {"stribeck", "logarithmic", "viscous", "learned", "table"}, "how it depends on speed"),
        amplitude("strength", "1", 0.0, -0.95, 100.0, 0.2,
                  "relative change of the coefficient; negative: falls with speed"),
        detail("speed_m_s", "m/s", 1e-3, 1e-9, 1e3, "speed scale")};
    addCoefficients(e.parameters, -0.95, 100.0, "coefficient of S of a learned law, from slow to fast");
    addTable(e.parameters);
    e.apply = [](const Values& v, Model& m) {
        constexpr FrictionModel::Rate laws[] = {FrictionModel::Rate::Stribeck, FrictionModel::Rate::Logarithmic,
                                                FrictionModel::Rate::Viscous, FrictionModel::Rate::Learned,
                                                FrictionModel::Rate::Table};
        m.contact.friction.rate = laws[static_cast<std::size_t>(v[0])];
        m.contact.friction.rateStrength = v[1];
        m.contact.friction.rateSpeed = v[2];
        m.contact.friction.rateCurve = coefficientsAt(v, 3);
        m.contact.friction.rateTable = tableAt(v, 3 + kSplineCoefficients);
    };
    return e;
}

} // namespace supercircle::effects
