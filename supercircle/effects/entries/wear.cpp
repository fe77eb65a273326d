#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect wear() {
    Effect e;
    e.key = Key::Wear;
    e.name = "wear";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "the friction coefficient changes as the surfaces run in";
    e.law = "mu (1 + change (1 - exp(-S / distance_m))), S: accumulated slip of this point of the surface; learned mu "
            "(1 + change s(S / distance_m)), s a cubic spline on [0, 1]; table the same with more coefficients";
    e.fingerprint = "friction loop changes from cycle to cycle, with the slip distance and not with time";
    e.literature = "Archard, J. Appl. Phys. 24, 981 (1953); Blau, Tribol. Int. 38, 1007 (2005)";
    e.parameters = {amplitude("change", "1", 0.0, -0.95, 100.0, 0.3, "relative change of the coefficient in the end"),
                    detail("distance_m", "m", 0.05, 1e-6, 1e6, "slip distance of the change"),
                    choice("law", {"exponential", "learned", "table"}, "how it depends on the slip distance")};
    addCoefficients(e.parameters, -0.95, 100.0, "coefficient of S of a learned law, from no slip to distance_m");
    addTable(e.parameters);
    e.apply = [](const Values& v, Model& m) {
        m.contact.friction.wearChange = v[0];
        m.contact.friction.wearDistance = v[1];
        constexpr FrictionModel::Wear laws[] = {FrictionModel::Wear::Exponential, FrictionModel::Wear::Learned,
                                                FrictionModel::Wear::Table};
        m.contact.friction.wear = laws[static_cast<std::size_t>(v[2])];
        m.contact.friction.wearCurve = coefficientsAt(v, 3);
        m.contact.friction.wearTable = tableAt(v, 3 + kSplineCoefficients);
    };
    return e;
}

} // namespace supercircle::effects
