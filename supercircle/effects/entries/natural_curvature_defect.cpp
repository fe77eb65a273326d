#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect naturalCurvatureDefect() {
    Effect e;
    e.key = Key::NaturalCurvatureDefect;
    e.name = "natural_curvature_defect";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "a part of the specimen is flatter, or more curved, than stated";
    e.law = "kappa0 + curvature_change_1_m g(s): g is 1 on a part of length_m around arc_fraction "
            "(flat), or exp(-((s - s0) / length_m)^2 / 2) (gauss)";
    e.fingerprint = "first contact earlier or later and one-sided, forces of small deflections off; "
                    "stiffness unchanged";
    e.literature = "Timoshenko and Gere, Theory of Elastic Stability, 1961 (initial curvature)";
    e.parameters = {
        amplitude("curvature_change_1_m", "1/m", 0.0, -1e4, 1e4, -15.0, "change of natural curvature"),
        detail("arc_fraction", "1", 0.5, 0.0, 1.0, "middle of the part: 0 first end, 1 last end"),
        detail("length_m", "m", 1e-2, 1e-6, 10.0, "length of the part (flat) or standard deviation (gauss)"),
        choice("shape", {"flat", "gauss"}, "sharp or smooth ends")};
    e.apply = [](const Values& v, Model& m) {
        const Profile::Shape shape = v[3] == 0.0 ? Profile::Shape::Flat : Profile::Shape::Gauss;
        m.material.profiles.push_back({Key::NaturalCurvatureDefect, shape, v[1], v[2], 0.0, v[0]});
    };
    e.repeatable = true;
    return e;
}

} // namespace supercircle::effects
