#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect viscoelasticBending() {
    Effect e;
    e.key = Key::ViscoelasticBending;
    e.name = "viscoelastic_bending";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "bending resists its rate: internal damping of the material";
    e.law = "kelvin_voigt: M = B (kappa - kappa0) + eta dkappa/dt; standard_linear_solid: a Maxwell "
            "branch of stiffness branch_over_B B and relaxation time tau_s beside the bending spring";
    e.fingerprint = "loading above, unloading below the quasi-static curve by an amount that grows with "
                    "speed; force relaxes in holds; vanishes in the slow limit";
    e.literature = "Christensen, Theory of Viscoelasticity, 1982; Linn, Lang and Tuganov, Mech. Sci. 4, 79 "
                   "(2013)";
    e.parameters = {
        choice("law", {"kelvin_voigt", "standard_linear_solid"},
               "dashpot beside the spring, or a Maxwell branch beside it"),
        amplitude("eta_over_B_s", "s", 0.0, 0.0, 1e4, 0.05, "bending viscosity over bending modulus (kelvin_voigt)"),
        amplitude("branch_over_B", "1", 0.0, 0.0, 1e3, 0.1, "stiffness of the Maxwell branch (standard_linear_solid)"),
        detail("tau_s", "s", 1.0, 1e-6, 1e9, "relaxation time of the branch")};
    e.apply = [](const Values& v, Model& m) {
        m.material.viscosity += v[1];
        if (v[2] > 0.0)
            m.material.branches.push_back({v[2], v[3]});
    };
    e.check = [](const Values& v) -> std::string {
        if (v[0] == 0.0 && v[2] != 0.0)
            return "branch_over_B belongs to law standard_linear_solid";
        if (v[0] == 1.0 && v[1] != 0.0)
            return "eta_over_B_s belongs to law kelvin_voigt";
        return {};
    };
    e.repeatable = true;
    return e;
}

} // namespace supercircle::effects
