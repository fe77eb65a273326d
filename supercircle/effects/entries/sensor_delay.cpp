#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect sensorDelay() {
    Effect e;
    e.key = Key::SensorDelay;
    e.name = "sensor_delay";
    e.slot = Slot::Sensor;
    e.perShell = false;
    e.about = "the force reading is delayed, or smoothed";
    e.law = "reading(t) = F(t - delay_s), then d reading/dt = (F - reading) / lag_s";
    e.fingerprint = "loops that grow with speed, also without sliding; jumps are late or rounded";
    e.literature = "Doebelin, Measurement Systems, 2004";
    e.parameters = {amplitude("delay_s", "s", 0.0, 0.0, 1e3, 0.02, "pure delay"),
                    amplitude("lag_s", "s", 0.0, 0.0, 1e3, 0.02, "time constant of a first-order low pass")};
    e.apply = [](const Values& v, Model& m) {
        m.sensor.delay = v[0];
        m.sensor.lag = v[1];
    };
    return e;
}

} // namespace supercircle::effects
