#include "supercircle/effects/entries/entries.h"

namespace supercircle::effects {

Effect sensorGain() {
    Effect e;
    e.key = Key::SensorGain;
    e.name = "sensor_gain";
    e.slot = Slot::Sensor;
    e.perShell = false;
    e.about = "the calibration of the load cell is wrong";
    e.law = "reading = (1 + error) F";
    e.fingerprint = "all forces, weights and pull-off included, are scaled alike: the same as another bending "
                    "modulus if gravity and adhesion are negligible";
    e.literature = "ISO 376; ISO 7500-1";
    e.parameters = {amplitude("error", "1", 0.0, -0.99, 100.0, 0.05, "relative error")};
    e.apply = [](const Values& v, Model& m) { m.sensor.gain = v[0]; };
    return e;
}

} // namespace supercircle::effects
