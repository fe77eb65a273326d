#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect softeningOverTime() {
    Effect e;
    e.key = Key::SofteningOverTime;
    e.name = "softening_over_time";
    e.slot = Slot::Material;
    e.perShell = true;
    e.about = "the bending modulus falls with the time since the test began";
    e.law = "exponential: B (1 - drop (1 - exp(-t / tau_s))); logarithmic: B (1 - drop log10(1 + t / "
            "tau_s))";
    e.fingerprint = "all forces decrease with time, independent of the motion: slow runs and late cycles are "
                    "softer";
    e.literature = "Struik, Physical Aging in Amorphous Polymers, 1978; Findley, Lai and Onaran, Creep and "
                   "Relaxation, 1976";
    e.parameters = {amplitude("drop", "1", 0.0, 0.0, 0.95, 0.1,
                              "fraction of B lost in the end (exponential), or per decade of time (logarithmic)"),
                    detail("tau_s", "s", 20.0, 1e-6, 1e9, "time scale"),
                    choice("law", {"exponential", "logarithmic"}, "with a final value, or without")};
    e.apply = [](const Values& v, Model& m) {
        m.material.softening = v[0];
        m.material.softeningTime = v[1];
        m.material.softeningByDecades = v[2] == 1.0;
    };
    return e;
}

} // namespace supercircle::effects
