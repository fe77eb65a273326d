#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect nonlinearElasticity() {
    Effect e;
    e.key = Key::NonlinearElasticity;
    e.name = "nonlinear_elasticity";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "moment and curvature are not proportional, without dissipation";
    e.law = "with u = kappa - kappa0: softening M = B u / sqrt(1 + (u/uc)^2); stiffening M = B u (1 "
            "+ (u/uc)^2); ramberg_osgood u = M/B + uc (M/(B uc))^n; learned dM/du = B (1 + S(|u|/uc)), S a "
            "cubic spline on [0, 1]; table the same with more coefficients, for laws that are given as a formula";
    e.fingerprint = "deviation grows with deflection, the same in unloading, at any speed";
    e.literature = "Ramberg and Osgood, NACA TN 902 (1943); Antman, Nonlinear Problems of Elasticity, 2005";
    e.parameters = {choice("law", {"softening", "stiffening", "ramberg_osgood", "learned", "table"},
                           "shape of the moment-curvature curve"),
                    amplitude("uc_1_m", "1/m", kInfinity, 1e-3, kInfinity, 100.0, "curvature change at the knee"),
                    detail("exponent", "1", 3.0, 1.0, 50.0, "n of ramberg_osgood")};
    addCoefficients(e.parameters, -0.95, 100.0, "coefficient of S of a learned law, from curvature change 0 to uc");
    addTable(e.parameters);
    e.apply = [](const Values& v, Model& m) {
        constexpr ElasticModel::Law laws[] = {ElasticModel::Law::Softening, ElasticModel::Law::Stiffening,
                                              ElasticModel::Law::RambergOsgood, ElasticModel::Law::Learned,
                                              ElasticModel::Law::Table};
        m.material.elastic = {laws[static_cast<std::size_t>(v[0])], v[1], v[2], coefficientsAt(v, 3),
                              tableAt(v, 3 + kSplineCoefficients)};
    };
    return e;
}

} // namespace supercircle::effects
