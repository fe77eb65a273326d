#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect planarDrag() {
    Effect e;
    e.key = Key::PlanarDrag;
    e.name = "planar_drag";
    e.slot = Slot::Load;
    e.perShell = true;
    e.about = "dry friction of the whole specimen against walls in front and behind";
    e.law = "force per length f against the motion of every point, at any speed; within presliding_m "
            "of a reversal it is elastic";
    e.fingerprint = "a force step of +- f L as soon as anything moves, also before contact; it changes sign "
                    "with the motion and persists in holds";
    e.literature = "Goyal, Ruina and Papadopoulos, Wear 143, 307 (1991); Prandtl, Z. Angew. Math. Mech. 8, "
                   "85 (1928)";
    e.parameters = {amplitude("f_N_m", "N/m", 0.0, 0.0, 1e4, 0.1, "friction force per length"),
                    detail("presliding_m", "m", 3e-6, 1e-9, 1e-2, "elastic motion before a point slides")};
    e.apply = [](const Values& v, Model& m) { m.drag = {v[0], v[1]}; };
    return e;
}

} // namespace supercircle::effects
