#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect sensorDrift() {
    Effect e;
    e.key = Key::SensorDrift;
    e.name = "sensor_drift";
    e.slot = Slot::Sensor;
    e.perShell = false;
    e.about = "the zero of the load cell drifts with time";
    e.law = "reading += a_N (1 - exp(-t / tau_s)) + rate_N_s t, t since the start of the run";
    e.fingerprint = "a function of time only: also without contact, and independent of the motion";
    e.literature = "Stefanescu, Handbook of Force Transducers, 2011";
    e.parameters = {amplitude("a_N", "N", 0.0, -1e6, 1e6, 0.01, "drift in the end"),
                    detail("tau_s", "s", 20.0, 1e-6, 1e9, "time constant"),
                    amplitude("rate_N_s", "N/s", 0.0, -1e6, 1e6, 1e-3, "steady drift")};
    e.apply = [](const Values& v, Model& m) {
        m.sensor.drift = v[0];
        m.sensor.driftTime = v[1];
        m.sensor.driftRate = v[2];
    };
    return e;
}

} // namespace supercircle::effects
