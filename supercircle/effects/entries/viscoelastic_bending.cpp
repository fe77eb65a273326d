#include "supercircle/effects/entries/entries.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

/// Maxwell branches whose stiffnesses fall with tau^-alpha between both frequencies: the modulus rises with
/// frequency^alpha, and the moment lags by alpha pi / 2. Two branches a decade leave a ripple of 0.1 %, one leaves 5 %;
/// four cost twice as much.
void addLossFactor(double loss, double low, double high, std::vector<MaxwellBranch>& branches) {
    constexpr double kPerDecade = 2.0;
    if (loss <= 0.0)
        return;
    const double alpha = 2.0 / M_PI * math::atan(loss), decades = math::log10(high / low);
    const int count = std::max(1, static_cast<int>(std::round(kPerDecade * decades)));
    const double ratio = math::pow(high / low, 1.0 / count); // of neighbouring times
    const double longest = 1.0 / (2.0 * M_PI * low);
    for (int k = 0; k < count; ++k) {
        const double below = math::pow(ratio, -(k + 0.5)); // of the longest time
        branches.push_back({alpha * math::log(ratio) * math::pow(below, -alpha), longest * below});
    }
}

} // namespace

Effect viscoelasticBending() {
    Effect e;
    e.key = Key::ViscoelasticBending;
    e.name = "viscoelastic_bending";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "bending resists its rate: internal damping of the material";
    e.law = "kelvin_voigt: M = B (kappa - kappa0) + eta dkappa/dt; standard_linear_solid: a Maxwell "
            "branch of stiffness branch_over_B B and relaxation time tau_s beside the bending spring; loss_factor: "
            "branches "
            "between f_low_Hz and f_high_Hz, of strengths tau^-alpha, alpha = 2 / pi atan(loss_factor), whose moments "
            "lag by the same angle at every frequency";
    e.fingerprint = "loading above, unloading below the quasi-static curve by an amount that grows with "
                    "speed; force relaxes in holds; vanishes in the slow limit";
    e.literature = "Christensen, Theory of Viscoelasticity, 1982; Linn, Lang and Tuganov, Mech. Sci. 4, 79 "
                   "(2013)";
    e.parameters = {
        choice("law", {"kelvin_voigt", "standard_linear_solid", "loss_factor"},
               "dashpot beside the spring, a Maxwell branch beside it, or many for a loss independent of frequency"),
        amplitude("eta_over_B_s", "s", 0.0, 0.0, 1e4, 0.05, "bending viscosity over bending modulus (kelvin_voigt)"),
        amplitude("branch_over_B", "1", 0.0, 0.0, 1e3, 0.1, "stiffness of the Maxwell branch (standard_linear_solid)"),
        detail("tau_s", "s", 1.0, 1e-6, 1e9, "relaxation time of the branch"),
        amplitude("loss_factor", "1", 0.0, 0.0, 1.0, 0.02, "loss modulus over storage modulus (loss_factor)"),
        detail("f_low_Hz", "Hz", 1e-2, 1e-9, 1e6, "frequency below which the modulus is B (loss_factor)"),
        detail("f_high_Hz", "Hz", 1e4, 1e-8, 1e7, "frequency above which nothing is lost (loss_factor)")};
    e.apply = [](const Values& v, Model& m) {
        m.material.viscosity += v[1];
        if (v[2] > 0.0)
            m.material.branches.push_back({v[2], v[3]});
        addLossFactor(v[4], v[5], v[6], m.material.branches);
    };
    e.check = [](const Values& v) -> std::string {
        if (v[0] != 0.0 && v[1] != 0.0)
            return "eta_over_B_s belongs to law kelvin_voigt";
        if (v[0] != 1.0 && v[2] != 0.0)
            return "branch_over_B belongs to law standard_linear_solid";
        if (v[0] != 2.0 && v[4] != 0.0)
            return "loss_factor belongs to law loss_factor";
        if (v[4] != 0.0 && !(v[6] > v[5]))
            return "f_high_Hz is not above f_low_Hz";
        return {};
    };
    e.repeatable = true;
    return e;
}

} // namespace supercircle::effects
