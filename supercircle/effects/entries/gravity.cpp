#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect gravity() {
    Effect e;
    e.key = Key::Gravity;
    e.name = "gravity";
    e.slot = Slot::Load;
    e.perShell = false;
    e.about = "gravity acts though the description says it does not, or its direction is wrong";
    e.law = "adds (x, y) to the declared gravity";
    e.fingerprint = "sag before contact and a different weight on the load cell: a force offset that does not "
                    "depend on speed, larger for soft specimens";
    e.literature = "Wang, Int. J. Mech. Sci. 28, 549 (1986)";
    e.parameters = {amplitude("x_m_s2", "m/s^2", 0.0, -1e3, 1e3, 1.0, "to the right, beside what is declared"),
                    amplitude("y_m_s2", "m/s^2", 0.0, -1e3, 1e3, -9.81, "upwards, beside what is declared")};
    e.apply = [](const Values& v, Model& m) { m.gravity += Vec2(v[0], v[1]); };
    return e;
}

} // namespace supercircle::effects
