#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect clampCompliance() {
    Effect e;
    e.key = Key::ClampCompliance;
    e.name = "clamp_compliance";
    e.slot = Slot::Apparatus;
    e.perShell = false;
    e.about = "clamps yield: the clamped section turns in proportion to its moment";
    e.law = "angle at the clamp = stated angle + compliance_rad_N_m times the moment";
    e.fingerprint = "a cantilever swings slower and sags more, the more so the shorter it is; markers turn about the "
                    "clamp as a whole, and the strip bends as before";
    e.literature = "O'Donnell, J. Eng. Ind. 85, 265 (1963); MacBain and Genin, J. Sound Vib. 27, 197 (1973)";
    e.parameters = {
        amplitude("compliance_rad_N_m", "rad/(N m)", 0.0, 0.0, 1e9, 0.1, "angle over moment, of every clamp")};
    e.apply = [](const Values& v, Model& m) { m.apparatus.clampCompliance = v[0]; };
    return e;
}

} // namespace supercircle::effects
