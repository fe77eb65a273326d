#pragma once
// The same experiment in other units: a test that no constant is sized for one specimen.

#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/experiment.h"

#include <string>

namespace replaytest {

/// Factors of lengths, times and forces. Masses follow.
struct Factors {
    double length = 1.0, time = 1.0, force = 1.0;
    [[nodiscard]] double mass() const { return force * time * time / length; }
};

inline void scale(supercircle::experiment::Stated& s, double factor) {
    s.value *= factor;
    s.halfWidth *= factor;
}

inline void scale(std::vector<double>& values, double factor) {
    for (double& v : values)
        v *= factor;
}

inline void scale(supercircle::Point& p, double factor) {
    p.x *= factor;
    p.y *= factor;
}

/// A driven specimen with its recordings.
inline supercircle::experiment::Experiment scaled(const supercircle::experiment::Experiment& e, const Factors& f) {
    supercircle::experiment::Experiment out = e;
    scale(out.gravity, f.length / (f.time * f.time));
    for (auto& s : out.specimens) {
        s.length *= f.length;
        s.width *= f.length;
        scale(s.naturalCurvature, 1.0 / f.length);
        scale(s.thickness, f.length);
        scale(s.bendingModulus, f.force * f.length * f.length);
        s.youngModulus *= f.force / (f.length * f.length);
        s.stretchModulus *= f.force;
        scale(s.linearMass, f.mass() / f.length);
        s.clamp.arcPosition *= f.length;
        s.clamp.clampedLength *= f.length;
        scale(s.clamp.initialPoint, f.length);
    }
    for (auto& o : out.obstacles) {
        scale(o.point, f.length);
        o.radius *= f.length;
    }
    for (auto& s : out.strings)
        scale(s.point, f.length);
    out.initialGapHalfWidth *= f.length;
    for (auto& r : out.runs) {
        scale(r.driveTime, f.time);
        scale(r.driveDisplacement, f.length);
        r.samplingRate /= f.time;
        r.markersSamplingRate /= f.time;
        scale(r.readings.time, f.time);
        scale(r.readings.displacement, f.length);
        scale(r.readings.force, f.force);
        scale(r.markers.time, f.time);
        for (auto* axis : {&r.markers.x, &r.markers.y})
            for (auto& track : *axis)
                scale(track, f.length);
    }
    out.sensors.forceNoise *= f.force;
    out.sensors.forceZeroWindow *= f.time;
    out.sensors.displacementNoise *= f.length;
    out.sensors.markerNoise *= f.length;
    return out;
}

/// Powers of two round off nothing: what differs then is due to a constant.
inline const Factors kFactors[] = {{0.125, 1.0, 1.0}, {8.0, 1.0, 1.0},   {1.0, 1.0, 1024.0},   {1.0, 0.0078125, 1.0},
                                   {1.0, 128.0, 1.0}, {0.1, 1.0, 1.0},   {10.0, 1.0, 1.0},     {1.0, 1.0, 1000.0},
                                   {1.0, 0.01, 1.0},  {1.0, 100.0, 1.0}, {10.0, 100.0, 1000.0}};

inline std::string words(const Factors& f) {
    return "lengths x " + std::to_string(f.length) + ", times x " + std::to_string(f.time) + ", forces x " +
           std::to_string(f.force);
}

} // namespace replaytest
