#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect misalignment() {
    Effect e;
    e.key = Key::Misalignment;
    e.name = "misalignment";
    e.slot = Slot::Apparatus;
    e.perShell = false;
    e.about = "the crosshead is off axis or tilted";
    e.law = "what the crosshead carries is displaced by offset_m to the right and rotated by tilt_rad "
            "counter-clockwise";
    e.fingerprint = "one side touches, slips or snaps before the other: two small steps where there was one; "
                    "markers asymmetric";
    e.literature = "ASTM E1012 (verification of alignment); Lord and Morrell, J. Phys. Conf. Ser. 7, 1 "
                   "(2007)";
    e.parameters = {amplitude("offset_m", "m", 0.0, -1.0, 1.0, 1e-3, "to the right"),
                    amplitude("tilt_rad", "rad", 0.0, -1.57, 1.57, 0.02, "counter-clockwise")};
    e.apply = [](const Values& v, Model& m) {
        m.apparatus.offset += v[0];
        m.apparatus.tilt += v[1];
    };
    return e;
}

} // namespace supercircle::effects
