#pragma once
// Definitions of shells: plain structs in SI units, defaults in the initialisers. No Box2D, no JSON, no Eigen.

#include <cstdint>
#include <string>
#include <vector>

namespace supercircle {

struct Point {
    double x = 0.0; ///< m
    double y = 0.0; ///< m
};

/// Number of a surface material. Shells::set_friction sets the friction of a pair of them; 0: none.
using FrictionMaterial = std::uint32_t;

/// A small heavy body that moves with a section of a shell. It has no shape and does not stiffen the shell.
struct PointMassDef {
    double arc_fraction = 1.0; ///< 0 first end, 1 last end
    double mass = 0.0;         ///< kg
    double inertia = 0.0;      ///< about its place, kg m^2: at most mass times the square of the shell's length
};

/// A flexible open shell: an inextensible elastic rod of circular arcs. The default is the paper's shell
/// (PET-G, R = 19.2 mm, h = 0.5 mm, w = 10 mm) with phi_bar = 0.75.
struct ShellDef {
    Point position{};       ///< of the middle of the shell, m
    double angle = 0.0;     ///< of the tangent at the middle, rad; pi: a dome that opens downwards
    double length = 0.0;    ///< arc length, m; 0: opening angle times natural radius
    double phi_bar = 0.75;  ///< opening angle / 2 pi, 1; used when length is 0
    double radius = 0.0192; ///< natural radius, m (natural curvature is 1/radius); infinite: a straight strip
    std::vector<double> natural_curvature; ///< per element, 1/m; empty: 1/radius everywhere
    std::vector<double> curvature;         ///< initial, per element, 1/m; empty: the natural one
    double thickness = 0.0005;             ///< m
    double width = 0.010;                  ///< m
    double density = 1270.0;               ///< kg/m^3
    double young_modulus = 2.2e9;          ///< Pa
    std::vector<PointMassDef> mass_at;     ///< small bodies on the shell, such as an accelerometer
    double mu = 0.35;                      ///< friction coefficient, 1
    /// Of the shell's first mode, 1: 0 to 100; negative: 0 in Quality::Laboratory, 0.05 in Quality::Game. It acts as a
    /// bending viscosity (Kelvin-Voigt): a mode of n times the frequency has n times the ratio.
    double damping_ratio = -1.0;
    int elements = 15;           ///< number of arcs
    double tip_refinement = 1.0; ///< length of the middle arcs over that of the tip arcs, 1
    bool closed = false;         ///< a ring: the ends are welded; `curvature`, if given, turns once, by 2 pi
    Point velocity{};            ///< m/s
    double spin = 0.0;           ///< rad/s
    std::uint16_t category = 1;  ///< collision filter as in Box2D
    std::uint16_t mask = 0xffff;
    std::int16_t group = 0; ///< as in Box2D: negative groups never collide among themselves, positive ones always
    FrictionMaterial friction_material = 0; ///< 0: none
    std::uint64_t user_data = 0;
    std::string name;
};

/// Bending modulus B = E w h^3 / 12, N m^2.
inline double bending_modulus(const ShellDef& d) {
    return d.young_modulus * d.width * d.thickness * d.thickness * d.thickness / 12.0;
}

/// The default shell at another size, for games. Thickness over radius and weight R^2 / B stay the same, so that under
/// gravity of 9.81 m/s^2 a shell of radius 1 m sags, rolls and snaps as one of 19.2 mm does. Its width is 1 m.
/// `radius` (m) and `mass` (kg) must be positive; `stiffness` (1) multiplies the bending modulus.
inline ShellDef scaled_shell(double radius, double mass, double phi_bar = 0.75, double stiffness = 1.0) {
    const ShellDef paper;
    const double k = radius / paper.radius;
    ShellDef d;
    d.phi_bar = phi_bar;
    d.radius = radius;
    d.thickness = k * paper.thickness;
    d.width = 1.0;
    d.density = mass / (6.283185307179586 * phi_bar * radius * d.thickness);           // per metre of width
    d.young_modulus = stiffness * paper.young_modulus * k * d.density / paper.density; // keeps weight R^2 / B
    return d;
}

enum class HoldKind : std::uint8_t {
    Pin,  ///< position held
    Clamp ///< position and direction held
};

/// What a held point is attached to.
enum class HoldBase : std::uint8_t {
    Fixed, ///< the ground; Shells::set_target moves it
    Moving ///< the crosshead of the testing machine; Shells::set_crosshead_velocity moves it
};

/// Holds one point of a shell that is found by its name, as scene files do.
struct HoldDef {
    std::string shell;         ///< name of the shell
    double arc_fraction = 0.5; ///< place along the shell, 0 = first end, 1 = last end
    HoldKind kind = HoldKind::Clamp;
    HoldBase base = HoldBase::Fixed;
};

} // namespace supercircle
