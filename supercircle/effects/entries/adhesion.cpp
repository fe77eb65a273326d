#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect adhesion() {
    Effect e;
    e.key = Key::Adhesion;
    e.name = "adhesion";
    e.slot = Slot::Contact;
    e.perShell = false;
    e.about = "near surfaces attract each other; surfaces that adhere also resist sliding";
    e.law = "attraction per length p(x) against x = gap / range_m: hump F 27/4 x (1 - x)^2, nothing "
            "in contact; decaying F (1 - x)^2, largest in contact, where it presses the surfaces "
            "together so that friction acts without load; learned F S(x), S a cubic spline that ends smoothly at x = 1";
    e.fingerprint = "pull-off force when the surfaces part, late release in unloading; with decaying also "
                    "friction at zero load";
    e.literature = "Johnson, Kendall and Roberts, Proc. R. Soc. A 324, 301 (1971); Derjaguin, Muller and "
                   "Toporov, J. Colloid Interface Sci. 53, 314 (1975)";
    e.parameters = {choice("law", {"hump", "decaying", "learned"}, "attraction against the gap"),
                    amplitude("F_a_N_m", "N/m", 0.0, 0.0, 1e6, 10.0, "largest attraction per length of rod"),
                    detail("range_m", "m", 1e-4, 1e-7, 1.0, "gap where it ends"),
                    detail("spots_m", "m", 0.0, 0.0, 1.0,
                           "distance of attracting spots, including both tips; 0: the whole surface attracts")};
    addCoefficients(e.parameters, -10.0, 10.0, "coefficient of S of a learned law, from contact to the range");
    e.apply = [](const Values& v, Model& m) {
        constexpr AdhesionModel::Law laws[] = {AdhesionModel::Law::Hump, AdhesionModel::Law::Decaying,
                                               AdhesionModel::Law::Learned};
        m.contact.adhesion = {laws[static_cast<std::size_t>(v[0])], v[1], v[2], v[3], coefficientsAt(v, 4)};
    };
    return e;
}

} // namespace supercircle::effects
