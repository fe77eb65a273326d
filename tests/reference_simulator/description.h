#pragma once
// Description of an experiment, rod-recordings/1, read and written without the project's own reader.

#include "tests/reference_simulator/simulation.h"

#include <string>
#include <vector>

namespace supercircle::reference_simulator {

struct RunPlan {
    std::string file, markersFile;
    Drive drive;                                   ///< m
    double sampling = 50.0, markersSampling = 5.0; ///< Hz
    bool specimenReversed = false;                 ///< specimens and their markers are mounted end for end
    bool markersTracked = true;                    ///< the markers of the description are tracked
    [[nodiscard]] std::vector<double> times(double rate) const;
};

/// Nominal values and the half-widths of their intervals.
struct Description {
    std::string protocol, description;
    Setup nominal;                  ///< without effects
    double width = 0.01;            ///< of specimens, m
    double curvatureRelUnc = 0.005; ///< relative half-widths
    double modulusRelUnc = 0.06, massRelUnc = 0.02;
    double thicknessUnc = 1e-5, frictionUnc = 0.05, gapUnc = 5e-5;
    double noise = 1e-3, markerNoise = 3e-5, displacementNoise = 1e-6; ///< as stated, N, m, m
    std::vector<RunPlan> runs;
    std::vector<Marker> markers;
};

/// Throws std::runtime_error with the file's name.
Description readDescription(const std::string& file);
std::string writeDescription(const Description& d);

/// True parameters inside their intervals, each from -1 to 1 times its half-width.
struct Offsets {
    double modulus = 0.0, curvature = 0.0, friction = 0.0, thickness = 0.0, mass = 0.0, gap = 0.0;
};
/// All of them, in the order of drawing.
inline constexpr double Offsets::*kOffsets[] = {&Offsets::modulus,   &Offsets::curvature, &Offsets::friction,
                                                &Offsets::thickness, &Offsets::mass,      &Offsets::gap};
Setup trueSetup(const Description& d, const Offsets& o, const Effects& effects);

} // namespace supercircle::reference_simulator
