#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect backlash() {
    Effect e;
    e.key = Key::Backlash;
    e.name = "backlash";
    e.slot = Slot::Apparatus;
    e.perShell = false;
    e.about = "backlash in the drive or in the load train";
    e.law = "reversal: at each change of direction the first travel of play_m is lost; force: the "
            "crosshead shifts by play_m where the force changes its sign, smoothed over force_N";
    e.fingerprint = "a horizontal segment of length play_m at each reversal, or where the force passes zero; "
                    "independent of speed";
    e.literature = "Nordin and Gutman, Automatica 38, 1633 (2002)";
    e.parameters = {
        amplitude("play_m", "m", 0.0, 0.0, 1.0, 1e-4, "width of the backlash"),
        choice("law", {"reversal", "force"}, "taken up when the drive reverses, or when the force changes its sign"),
        detail("force_N", "N", 1e-3, 1e-9, 1e6, "force scale over which the backlash is taken up (law force)")};
    e.apply = [](const Values& v, Model& m) {
        (v[1] == 0.0 ? m.apparatus.backlash : m.apparatus.slack) = v[0];
        m.apparatus.slackForce = v[2];
    };
    return e;
}

} // namespace supercircle::effects
