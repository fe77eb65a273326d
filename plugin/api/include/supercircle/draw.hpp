#pragma once
// Debug drawing: derive from DebugDraw and pass it to Shells::draw(), or use the adapter to b2Draw in
// <supercircle/box2d_draw.hpp>. Curves are polylines that deviate from the true arcs by at most the tolerance.

#include "definitions.hpp"

#include <span>

namespace supercircle {

/// Components from 0 to 1.
struct Colour {
    float red = 1.0F;
    float green = 1.0F;
    float blue = 1.0F;
    float alpha = 1.0F;
};

/// Receives lines and marks; lengths in metres.
class DebugDraw {
public:
    virtual ~DebugDraw() = default;
    /// An open line through the points (two at least).
    virtual void polyline(std::span<const Point> points, const Colour& colour) = 0;
    /// A closed line; the last point is joined to the first.
    virtual void outline(std::span<const Point> points, const Colour& colour) = 0;
    /// A contact or hold: draw a dot or cross of a few pixels.
    virtual void mark(const Point& at, const Colour& colour) = 0;
};

struct DrawOptions {
    bool centre_lines = true;             ///< of the shells; one line per element when coloured by strain
    bool outlines = true;                 ///< of the thick shells
    bool contacts = true;                 ///< a mark at each contact that carries force
    bool forces = true;                   ///< a line from each such contact along the force on shell a
    bool holds = true;                    ///< a mark at each hold
    bool strain = true;                   ///< centre lines coloured by surface strain, else all in `line`
    double tolerance = 2e-5;              ///< largest deviation of a polyline from its arc, m
    double metres_per_newton = 0.01;      ///< length of force lines, m/N
    double full_strain = 0.02;            ///< surface strain that is drawn red, 1
    Colour line{0.2F, 0.4F, 0.8F};        ///< of centre lines without strain
    Colour outline{0.5F, 0.5F, 0.5F};     ///< of the thick shells
    Colour contact{0.9F, 0.2F, 0.2F};     ///< of contacts and forces
    Colour hold{0.1F, 0.6F, 0.2F};        ///< of holds
    Colour quarantined{1.0F, 0.0F, 1.0F}; ///< of quarantined shells
    double alpha = 1.0; ///< shells between the start (0) and the end (1) of the last frame, as Shells::pose
};

/// Colour of a strain: blue at 0, green at half of `full`, red from `full` on.
Colour strain_colour(double strain, double full);

} // namespace supercircle
