#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect machineCompliance() {
    Effect e;
    e.key = Key::MachineCompliance;
    e.name = "machine_compliance";
    e.slot = Slot::Apparatus;
    e.perShell = false;
    e.about = "the testing machine is compliant: its crosshead moves less than commanded";
    e.law = "crosshead = commanded - F / k_N_m";
    e.fingerprint = "curve sheared in proportion to force; steep branches change most, plateaus not at all";
    e.literature = "Kalidindi, Abusafieh and El-Danaf, Exp. Mech. 37, 210 (1997)";
    e.parameters = {
        amplitude("k_N_m", "N/m", kInfinity, 1e-3, kInfinity, 5000.0, "stiffness between drive and specimen")};
    e.apply = [](const Values& v, Model& m) { m.apparatus.compliance += 1.0 / v[0]; };
    return e;
}

} // namespace supercircle::effects
