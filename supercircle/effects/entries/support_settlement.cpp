#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect supportSettlement() {
    Effect e;
    e.key = Key::SupportSettlement;
    e.name = "support_settlement";
    e.slot = Slot::Apparatus;
    e.perShell = false;
    e.about = "supports bed in under load and do not come back";
    e.law = "crosshead = drive - bedding_m_N times the largest force until then";
    e.fingerprint = "the first loading is sheared in proportion to force, like a soft machine; the way back and later "
                    "cycles below the largest force are not, but shifted";
    e.literature = "Lambe and Whitman, Soil Mechanics, 1969, ch. 14 (settlement of footings in first loading and "
                   "reloading)";
    e.parameters = {
        amplitude("bedding_m_N", "m/N", 0.0, 0.0, 1e3, 1e-5, "travel lost over the largest force until then")};
    e.apply = [](const Values& v, Model& m) { m.apparatus.bedding = v[0]; };
    return e;
}

} // namespace supercircle::effects
