#include "tests/blind_benchmark/synthetic_cases/cases.h"

#include <algorithm>

namespace supercircle::blind_benchmark {

namespace {

void shuffle(std::vector<CasePlan>& all, Random& draw) {
    for (std::size_t i = all.size(); i > 1; --i)
        std::swap(all[i - 1], all[static_cast<std::size_t>(draw.integer(static_cast<int>(i)))]);
}

void add(std::vector<CasePlan>& all, const std::string& kind, const std::string& strength,
         const std::vector<std::string>& families) {
    CasePlan p;
    p.kind = kind;
    p.strength = strength;
    p.families = families;
    all.push_back(p);
}

std::vector<CasePlan> tuning() {
    std::vector<CasePlan> all;
    for (int i = 0; i < 4; ++i)
        add(all, "nothing", "", {});
    for (const char* f : {"relaxation", "static_friction", "machine", "drift", "wear", "plasticity"})
        add(all, "single", "strong", {f});
    for (const char* f : {"stribeck", "damage", "softening"})
        add(all, "single", "weak", {f});
    add(all, "pair", "strong", {"kelvin_voigt", "drift"});
    add(all, "removed", "strong", {"relaxation"});
    add(all, "outside", "strong", {"periodic"});
    return all;
}

std::vector<CasePlan> blind() {
    std::vector<CasePlan> all;
    for (int i = 0; i < 18; ++i)
        add(all, "nothing", i < 2 ? "snaps" : "", {});
    for (const Family& f : families())
        if (f.known)
            for (const char* strength : {"strong", "weak"})
                add(all, "single", strength, {f.name});
    for (const auto& two : std::vector<std::vector<std::string>>{{"relaxation", "machine"},
                                                                 {"stribeck", "drift"},
                                                                 {"adhesion", "offset"},
                                                                 {"plasticity", "backlash"},
                                                                 {"wear", "softening"},
                                                                 {"static_friction", "delay"}})
        add(all, "pair", "strong", two);
    for (const char* f :
         {"kelvin_voigt", "static_friction", "drift", "plasticity", "drag", "damage", "machine", "wear"})
        add(all, "removed", "strong", {f});
    for (const char* f : {"rough_patches", "periodic"})
        add(all, "outside", "strong", {f});
    return all;
}

/// Effects so weak that a diagnosis should ask for another run (--further), and controls without effect.
std::vector<CasePlan> limit() {
    std::vector<CasePlan> all;
    for (int i = 0; i < 5; ++i)
        add(all, "nothing", "", {});
    for (const Family& f : families())
        if (f.known)
            add(all, "single", "limit", {f.name});
    return all;
}

Drive through(std::vector<double> time, std::vector<double> millimetres) {
    for (double& d : millimetres)
        d *= 1e-3;
    return {std::move(time), std::move(millimetres)};
}

Specimen drawSpecimen(Random& draw, Description& d) {
    Specimen s;
    s.thickness = 5e-4;
    d.width = 1e-3 * std::round(draw.uniform(9.0, 12.4));
    const double radius = 1e-4 * std::round(draw.uniform(190.0, 210.0));
    s.curvature = 1.0 / radius;
    s.modulus = 2.2e9 * d.width * std::pow(s.thickness, 3) / 12.0;
    s.linearMass = 1270.0 * d.width * s.thickness;
    s.stretchModulus = 2.2e9 * d.width * s.thickness;
    return s;
}

/// Height of the apex of a shell whose tips touch a circle of radius `seat` around the origin.
double touching(const Specimen& s, double half, double seat) {
    const double radius = 1.0 / s.curvature, width = radius * std::sin(half);
    return std::sqrt(seat * seat - width * width) + radius * (1.0 - std::cos(half));
}

void cylinder(Random& draw, Description& d, bool snaps) {
    d.protocol = "shell_on_rigid_cylinder";
    d.description =
        "An open shell, opening downwards, is glued at its middle to a loading bar and pushed onto a fixed rigid "
        "cylinder, then pulled back.";
    Specimen s = drawSpecimen(draw, d);
    const double radius = 1.0 / s.curvature,
                 half = M_PI * (snaps ? draw.uniform(0.85, 0.87) : draw.uniform(0.70, 0.77));
    s.length = 2.0 * half * radius;
    s.clamp = ClampAt::Middle;
    s.onCrosshead = true;
    s.angle = M_PI;
    s.point = {0.0, 1e-7 * std::round(1e7 * (touching(s, half, radius) + 3e-4))};
    Obstacle o;
    o.cylinder = true;
    o.radius = radius - 0.5 * s.thickness;
    d.nominal.specimens = {s};
    d.nominal.obstacles = {o};
    d.nominal.friction = 0.01 * std::round(snaps ? 40.0 : draw.uniform(25.0, 36.0));
    d.noise = 1e-4 * std::round(draw.uniform(6.0, 9.0)) * (snaps ? 10.0 : 1.0);
    addRun(d, through({0, 1, 12, 23, 24}, {0, 0, 22, 0, 0}), 20);
    addRun(d, through({0, 1, 3.2, 5.4, 6.4}, {0, 0, 22, 0, 0}), 60);
    addRun(d, through({0, 1, 5.4, 9.8, 14.2, 18.6, 19.6}, {0, 0, 22, 0, 22, 0, 0}), 20);
    d.markers = {{0, 0.02}, {0, 0.18}, {0, 0.34}, {0, 0.66}, {0, 0.82}, {0, 0.98}};
}

void shells(Random& draw, Description& d) {
    d.protocol = "two_shells";
    d.description =
        "Two identical open shells, both opening downwards; the upper one, glued at its middle to the machine head, "
        "is pushed over the lower one, which is held at its middle, and pulled back.";
    Specimen s = drawSpecimen(draw, d);
    const double radius = 1.0 / s.curvature, half = M_PI * draw.uniform(0.71, 0.75);
    s.length = 2.0 * half * radius;
    s.clamp = ClampAt::Middle;
    s.angle = M_PI;
    s.point = {0.0, radius};
    Specimen upper = s;
    upper.onCrosshead = true;
    upper.point.y() = 1e-7 * std::round(1e7 * (touching(s, half, radius + s.thickness) + 3e-4));
    d.nominal.specimens = {s, upper};
    d.nominal.friction = 0.01 * std::round(draw.uniform(25.0, 33.0));
    d.noise = 1e-4 * std::round(draw.uniform(6.0, 9.0));
    addRun(d, through({0, 1, 11, 21, 22}, {0, 0, 20, 0, 0}), 20);
    addRun(d, through({0, 1, 3.5, 6, 8.5, 11, 12}, {0, 0, 20, 0, 20, 0, 0}), 30);
    d.markers = {{0, 0.02}, {0, 0.25}, {0, 0.75}, {0, 0.98}, {1, 0.02}, {1, 0.25}, {1, 0.75}, {1, 0.98}};
}

void strip(Random& draw, Description& d, bool snaps) {
    d.protocol = "strip_on_rigid_floor";
    d.description =
        "A strip, clamped at its upper end in the machine head and pointing down, is pushed against a rigid floor.";
    Specimen s = drawSpecimen(draw, d);
    s.length = 1e-3 * std::round(draw.uniform(56.0, 64.0));
    s.curvature = 0.4;
    d.curvatureRelUnc = 0.5;
    s.clamp = ClampAt::FirstEnd;
    s.onCrosshead = true;
    s.angle = -0.5 * M_PI + 0.01 * std::round(draw.uniform(4.0, 8.0));
    s.point = {0.0, s.length + 0.5 * s.thickness + 3e-4};
    d.nominal.specimens = {s};
    d.nominal.obstacles = {Obstacle{}};
    d.nominal.friction = snaps ? 0.25 : 0.01 * std::round(draw.uniform(45.0, 50.0));
    d.noise = 1e-3 * std::round(draw.uniform(4.0, 6.0));
    const double most = snaps ? 9 : 14;
    addRun(d, through({0, 1, 15, 29, 30}, {0, 0, most, 0, 0}), 15);
    // A strip that leaves the floor vibrates, and damping decides where its tip lands next. It gets a pause.
    addRun(d, through({0, 1, 3.4, 5.8, 7.3, 9.7, 12.1, 13.1}, {0, 0, most, 0, 0, most, 0, 0}), 40);
    addRun(d, through({0, 1, 8, 20, 27, 28}, {0, 0, most, most, 0, 0}), 15);
    d.markers = {{0, 0.25}, {0, 0.5}, {0, 0.75}, {0, 0.99}};
}

void arch(Random& draw, Description& d) {
    d.protocol = "arch_between_plates";
    d.description =
        "A free arch (open shell, opening downwards) stands on a rigid floor on its two ends and is squeezed by a "
        "flat plate carried by the machine head.";
    Specimen s = drawSpecimen(draw, d);
    const double radius = 1.0 / s.curvature, half = M_PI * draw.uniform(0.45, 0.58);
    s.length = 2.0 * half * radius;
    d.nominal.specimens = {s};
    Obstacle plate;
    plate.normal = {0.0, -1.0};
    plate.onCrosshead = true;
    plate.point = {0.0, 1e-7 * std::round(1e7 * (radius * (1.0 - std::cos(half)) + s.thickness + 4e-4))};
    d.nominal.obstacles = {Obstacle{}, plate};
    d.nominal.friction = 0.01 * std::round(draw.uniform(25.0, 36.0));
    d.noise = 5e-4 * std::round(draw.uniform(4.0, 6.0));
    addRun(d, through({0, 1, 13, 25, 26}, {0, 0, 6, 0, 0}), 20);
    addRun(d, through({0, 1, 2.2, 3.4, 4.6, 5.8, 6.8}, {0, 0, 6, 0, 6, 0, 0}), 60);
    addRun(d, through({0, 1, 4, 15, 18, 20}, {0, 0, 6, 6, 0, 0}), 20);
    d.markers = {{0, 0.02}, {0, 0.25}, {0, 0.5}, {0, 0.75}, {0, 0.98}};
}

} // namespace

void addRun(Description& d, Drive drive, double rate, bool specimenReversed) {
    RunPlan r;
    r.file = "run_" + std::to_string(d.runs.size() + 1) + ".csv";
    r.markersFile = "run_" + std::to_string(d.runs.size() + 1) + "_markers.csv";
    r.drive = std::move(drive);
    r.sampling = rate;
    r.markersSampling = 4.0;
    r.specimenReversed = specimenReversed;
    d.runs.push_back(r);
}

std::vector<CasePlan> casePlans(const std::string& part, std::uint64_t seed) {
    std::vector<CasePlan> all = part == "tuning" ? tuning() : part == "limit" ? limit() : blind();
    Random draw(seed);
    shuffle(all, draw); // a part of the set is a fair sample
    for (std::size_t i = 0; i < all.size(); ++i) {
        char name[32];
        std::snprintf(name, sizeof name, "%s_%02zu", part.c_str(), i + 1);
        all[i].name = name;
        all[i].part = part;
        all[i].seed = seed * 1000003ULL + i * 7919ULL + 17ULL;
    }
    return all;
}

Description drawDescription(Random& draw, Protocol protocol, bool weightless, bool markers, bool snaps) {
    Description d;
    if (protocol == Protocol::Cylinder)
        cylinder(draw, d, snaps);
    else if (protocol == Protocol::Shells)
        shells(draw, d);
    else if (protocol == Protocol::Strip)
        strip(draw, d, snaps);
    else
        arch(draw, d);
    d.nominal.gravity = {0.0, weightless ? 0.0 : -9.81};
    const bool tracked = draw.chance(0.3);
    if (!markers && !tracked)
        d.markers.clear();
    return d;
}

Offsets drawOffsets(Random& draw) {
    Offsets o;
    for (double Offsets::*const offset : kOffsets)
        o.*offset = draw.uniform(-1.0, 1.0);
    return o;
}

SensorNoise drawSensorNoise(Random& draw, const Description& d) {
    SensorNoise n;
    const double total = d.noise * draw.uniform(0.75, 1.3), ratio = draw.logarithmic(0.3, 1.0);
    n.white = total / std::hypot(1.0, ratio);
    n.correlated = ratio * n.white;
    n.correlationTime = draw.uniform(0.18, 0.35);
    n.quantum = draw.chance(0.5) ? draw.uniform(0.2, 1.0) * total : 0.0;
    n.heavyTails = draw.chance(0.25);
    n.marker = d.markerNoise * draw.uniform(0.8, 1.25);
    return n;
}

} // namespace supercircle::blind_benchmark
