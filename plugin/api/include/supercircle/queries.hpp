#pragma once
// Queries of the geometry and the state of shells. A shell is its arcs, thickened by half the thickness on both sides
// and round at the ends, as contact takes it. Results are exact up to rounding; no polygons are involved. Queries
// change nothing (Shells::hash() stays equal) and are allowed at any time, also in an observer.

#include "definitions.hpp"
#include "handle.hpp"

#include <cstdint>

namespace supercircle {

/// An axis-aligned box.
struct Box {
    Point lower{}; ///< m
    Point upper{}; ///< m
};

/// A ray enters a shell.
struct RayHit {
    ShellHandle shell{};
    Point point{};             ///< on the shell's surface, m
    Point normal{};            ///< unit vector out of the shell; where the ray starts inside, away from the centre line
    double fraction = 0.0;     ///< of the ray, from 0 at its start to 1 at its end; 0 where the ray starts inside
    double arc_fraction = 0.0; ///< of the closest point of the centre line, 0 = first end, 1 = last end
};

/// The point of a shell's surface that is closest to a given point.
struct ClosestPoint {
    ShellHandle shell{};
    Point point{};             ///< on the surface, m
    Point normal{};            ///< unit vector from the centre line towards the given point
    double distance = 0.0;     ///< of the given point from the surface, negative inside the shell, m
    double arc_fraction = 0.0; ///< of the closest point of the centre line, 1
};

/// A shell at one place of its length. At a node between two elements, curvature and what follows from it are those of
/// the second element.
struct ShellSection {
    Point position{};               ///< of the centre line, m
    Point tangent{};                ///< unit vector towards the last end
    double angle = 0.0;             ///< of the tangent, continuous along the shell, rad
    Point velocity{};               ///< mean over the last inner step, m/s
    double spin = 0.0;              ///< of the section, rad/s
    double curvature = 0.0;         ///< kappa, 1/m
    double natural_curvature = 0.0; ///< kappa0, 1/m
    double bending_moment = 0.0;    ///< B (kappa - kappa0), N m
    double surface_strain = 0.0;    ///< h |kappa - kappa0| / 2, largest over the thickness, 1
    double energy_density = 0.0;    ///< B (kappa - kappa0)^2 / 2 per length, J/m
};

/// A shell as a whole.
struct ShellState {
    double length = 0.0;             ///< m
    double mass = 0.0;               ///< kg
    Point centre{};                  ///< of mass, m
    Point momentum{};                ///< kg m/s
    double angular_momentum = 0.0;   ///< about the centre of mass, kg m^2/s
    double kinetic_energy = 0.0;     ///< J
    double stored_energy = 0.0;      ///< elastic, J
    double max_surface_strain = 0.0; ///< largest h |kappa - kappa0| / 2, 1
    Box box{};                       ///< exact, thickness included, m
    bool quarantined = false;        ///< taken out of the motion (QuarantineEvent)
};

/// Selects the shells of a query: those whose category has a bit in common with it.
using QueryMask = std::uint16_t;

} // namespace supercircle
