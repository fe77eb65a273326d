// The scenes of the project: their parameters, and their start states against closed forms.

#include "tests/plugin/scene/loader/support.h"

#include <cmath>
#include <map>

using namespace scenetest;

namespace {

// Beyond the round-off of a few operations on lengths of 0.1 m; far below the gaps (1e-8 m).
constexpr double roundOff = 1e-15;

const std::vector<double> angles = {0.5, 0.55, 0.65, 0.75, 0.83, 0.9, 0.97, 0.99};
const std::vector<double> thicknesses = {1e-5, 1e-4, 5e-4, 1e-3};

/// Least distance of the sampled centre line to something, and the fraction where.
template <typename Distance>
std::pair<double, double> least(const Uniform& shell, Distance&& distance) {
    std::pair<double, double> best{INFINITY, 0.0};
    constexpr int n = 400; // even: the middle is a sample, as are both tips
    for (int i = 0; i <= n; ++i) {
        const double f = static_cast<double>(i) / n;
        best = std::min(best, {distance(shell.at(f)), f});
    }
    return best;
}

} // namespace

TEST_CASE("every scene has the parameters of the interface") {
    const std::map<std::string, std::vector<std::string>> wanted = {
        {"stack30", {"shells", "phi_bar", "mu", "cycles", "plate_speed", "max_force", "elements"}},
        {"shell_on_cylinder", {"phi_bar", "mu", "elements", "speed", "thickness", "travel_over_R"}},
        {"two_shells", {"phi_bar", "mu", "elements", "speed", "thickness", "travel_over_R"}},
        {"cantilever", {"gamma", "c", "elements"}},
        {"squeeze", {"phi_bar", "mu", "elements", "speed", "thickness"}},
        {"pinning", {"mu", "elements", "speed"}},
        {"ramp", {"mu", "angle"}}};
    for (const auto& [name, parameters] : wanted) {
        const Scene s = loaded(scenePath(name));
        CHECK(s.name == name);
        CHECK_FALSE(s.about.empty());
        for (const std::string& p : parameters) {
            INFO(name << " " << p);
            CHECK(
                std::any_of(s.parameters.begin(), s.parameters.end(), [&](const Parameter& q) { return q.name == p; }));
        }
        for (const Parameter& p : s.parameters) {
            INFO(name << " " << p.name);
            CHECK_FALSE(p.about.empty());
            CHECK(std::isfinite(p.min));
            CHECK(std::isfinite(p.max));
        }
    }
}

TEST_CASE("every scene loads without a note, at its defaults and at the ends of every range") {
    for (const std::string& name : sceneNames()) {
        std::vector<Problem> problems;
        const auto scene = load(scenePath(name), {}, problems);
        INFO(say(problems));
        REQUIRE(scene);
        CHECK(problems.empty());
        for (const Parameter& p : scene->parameters) {
            for (const double value : {p.min, p.max}) {
                INFO(name << " " << p.name << " = " << value);
                const Scene s = loaded(scenePath(name), {{p.name, value}});
                CHECK(s.rigid.lengthScale == 52.1);
            }
        }
        // All corners of the box of parameters at once: low and high in turn by the bits of a counter.
        const std::size_t n = scene->parameters.size();
        for (std::size_t bits = 0; bits < (std::size_t{1} << n); ++bits) {
            std::vector<Override> corner;
            for (std::size_t i = 0; i < n; ++i)
                corner.push_back({scene->parameters[i].name,
                                  ((bits >> i) & 1) ? scene->parameters[i].max : scene->parameters[i].min});
            loaded(scenePath(name), corner);
        }
    }
}

TEST_CASE("the paper's values") {
    const Scene s = loaded(scenePath("stack30"));
    const ShellDef& d = s.drop->shell;
    CHECK(s.drop->count == 30);
    CHECK(d.phi_bar == 0.75);
    CHECK(d.mu == 0.35);
    CHECK(d.elements == 15);
    CHECK(d.radius == 0.0192);
    CHECK(bending_modulus(d) == Approx(2.2e9 * 0.01 * std::pow(0.0005, 3) / 12).epsilon(1e-14));
    CHECK(s.report.kind == "stack");
    REQUIRE(s.protocol->segments.size() == 2);
    CHECK(s.protocol->segments[0].speed == 0.005);
    CHECK(s.protocol->segments[0].stop_when.force == 5.0);
    CHECK(s.protocol->segments[0].loading);
    CHECK(s.protocol->segments[1].stop_when.displacement == 0.0);
    CHECK(loaded(scenePath("stack30"), {{"cycles", 10}}).protocol->segments.back().cycle == 10);
    const double stroke =
        loaded(scenePath("stack30"), {{"max_travel_over_R", 2}}).protocol->segments[0].stop_when.displacement;
    CHECK(stroke == Approx(2 * 0.0192).epsilon(1e-14));
}

TEST_CASE("stack30: the box is 200 mm wide, the plate fills it, and no shell starts in a wall") {
    const Scene s = loaded(scenePath("stack30"));
    const auto& box = s.rigid.bodies.at(0);
    const auto& plate = s.rigid.bodies.at(1);
    double left = -INFINITY, right = INFINITY, plateHalf = 0.0;
    for (const auto& v : box.fixtures.at(1).vertices)
        left = std::max(left, v.x());
    for (const auto& v : box.fixtures.at(2).vertices)
        right = std::min(right, v.x());
    for (const auto& v : plate.fixtures.at(0).vertices)
        plateHalf = std::max(plateHalf, v.x());
    CHECK(right - left == Approx(0.2).epsilon(1e-14));
    // Room for the plate, but none for a shell beside it.
    CHECK(right - plateHalf > 0.0);
    CHECK(right - plateHalf < 0.5 * s.drop->shell.thickness);
    const double reach =
        s.drop->shell.radius + 0.5 * s.drop->shell.thickness; // of a shell round the middle of its circle
    CHECK(s.drop->x_min - reach > left);
    CHECK(s.drop->x_max + reach < right);
    CHECK(plate.type == step::BodyType::Kinematic);
    CHECK(plate.position.y() >= 0.6);
    // All fixtures have the shells' friction: the mixed coefficient sqrt(mu mu) is mu.
    for (const auto& body : loaded(scenePath("stack30"), {{"mu", 0.7}}).rigid.bodies)
        for (const auto& f : body.fixtures)
            CHECK(f.friction == 0.7);
    // Walls of a thousand shells are above their densest packing by half.
    const Scene tall = loaded(scenePath("stack30"), {{"shells", 1000}});
    CHECK(tall.rigid.bodies.at(1).position.y() > 1.5 * 1000 * 2 * std::sqrt(3.0) * 0.0192 * 0.0192 / 0.2);
}

TEST_CASE("shell_on_cylinder starts touching by its tips, for all angles, thicknesses and numbers of elements") {
    for (const double phiBar : angles) {
        for (const double h : thicknesses) {
            for (const double n : {3.0, 15.0, 200.0}) {
                INFO(phiBar << " " << h << " " << n);
                const Scene s =
                    loaded(scenePath("shell_on_cylinder"), {{"phi_bar", phiBar}, {"thickness", h}, {"elements", n}});
                const auto& disc = s.rigid.bodies.at(0).fixtures.at(0);
                CHECK(disc.radius == 0.0192 - 0.5 * h);
                const Uniform shell(s.shells.at(0));
                const auto [distance, where] = least(shell, [](const rod::Vec2& p) { return p.norm(); });
                const double gap = distance - disc.radius - 0.5 * h;
                CHECK(gap >= 1e-8 - roundOff);
                CHECK(gap <= 1e-6);
                CHECK((where == 0.0 || where == 1.0 ||
                       phiBar == 0.5)); // the half circle stands at right angles: all but equal
                CHECK(shell.at(0.0).x() == Approx(-shell.at(1.0).x()).margin(1e-16));
                // The crosshead stops before the crown reaches the cylinder.
                const double crown = shell.at(0.5).y() - s.protocol->segments[0].stop_when.displacement;
                CHECK(crown - 0.5 * h > disc.radius);
            }
        }
    }
}

TEST_CASE("shell_on_cylinder: the way to the seat is -2 cos(phi) R, whatever the thickness") {
    for (const double phiBar : {0.55, 0.65, 0.75, 0.9}) {
        const Scene s = loaded(scenePath("shell_on_cylinder"), {{"phi_bar", phiBar}, {"thickness", 1e-4}});
        // The gap of 1e-8 m raises the start by at most sqrt(2 R gap) = 2e-5 m, by about gap / |cos(phi)| here.
        CHECK(s.protocol->segments[0].stop_when.displacement / 0.98 ==
              Approx(-2 * std::cos(M_PI * phiBar) * 0.0192).margin(1e-8 / std::abs(std::cos(M_PI * phiBar)) + 1e-12));
    }
}

TEST_CASE("two_shells start touching tips on back, for all angles and thicknesses") {
    for (const double phiBar : angles) {
        for (const double h : thicknesses) {
            INFO(phiBar << " " << h);
            const Scene s = loaded(scenePath("two_shells"), {{"phi_bar", phiBar}, {"thickness", h}});
            const Uniform lower(s.shells.at(0));
            const Uniform upper(s.shells.at(1));
            const auto [distance, where] = least(upper, [&](const rod::Vec2& p) {
                return least(lower, [&](const rod::Vec2& q) { return (p - q).norm(); }).first;
            });
            // Sampling the lower centre line every 2 pi R / 400 misses the nearest point by at most half a sample, and
            // the distance h by that squared over 2 h.
            const double spacing = M_PI * 0.0192 * phiBar / 400;
            CHECK(distance - h >= 1e-8 - roundOff);
            CHECK(distance - h <= std::min(spacing, spacing * spacing / (2 * h)) + 1e-7);
            CHECK((where == 0.0 || where == 1.0 || phiBar == 0.5));
            // Exactly: the tip lies R + h + gap from the lower centre, over a part of its circle that is there.
            const rod::Vec2 tip = upper.at(0.0);
            CHECK(tip.norm() - (0.0192 + h) >= 1e-8 - roundOff);
            CHECK(tip.norm() - (0.0192 + h) <= 1e-8 + roundOff);
            CHECK(std::atan2(std::abs(tip.x()), tip.y()) <= M_PI * phiBar);
            CHECK(s.holds.at(1).base == HoldBase::Moving);
            CHECK(s.holds.at(0).base == HoldBase::Fixed);
            CHECK(upper.at(0.5).y() - s.protocol->segments[0].stop_when.displacement > 0.0192 + h);
        }
    }
}

TEST_CASE("cantilever: clamped horizontally at the origin, with the two pure numbers it is asked for") {
    for (const double gamma : {0.001, 1.0, 100.0, 10000.0}) {
        for (const double c : {-6.0, -1.0, 0.0, 1e-9, 1.0, 6.0}) {
            INFO(gamma << " " << c);
            const Scene s = loaded(scenePath("cantilever"), {{"gamma", gamma}, {"c", c}});
            const ShellDef& d = s.shells.at(0);
            const Uniform rod(d);
            CHECK(rod.at(0.0).norm() == Approx(0.0).margin(1e-16));
            CHECK(rod.arc.angleAt(-rod.half) == Approx(0.0).margin(1e-15));
            const double lambda = d.density * d.width * d.thickness;
            CHECK(lambda * -s.rigid.gravity.y() * std::pow(d.length, 3) / bending_modulus(d) ==
                  Approx(gamma).epsilon(1e-13));
            CHECK(-d.natural_curvature[0] * d.length == Approx(c).epsilon(1e-13).margin(1e-16));
            if (c > 0.0)
                CHECK(rod.at(1.0).y() < 0.0); // positive c curls downwards
        }
    }
}

TEST_CASE("squeeze: tips on the floor and crown under the plate, just touching") {
    for (const double phiBar : angles) {
        for (const double h : thicknesses) {
            const Scene s = loaded(scenePath("squeeze"), {{"phi_bar", phiBar}, {"thickness", h}});
            const Uniform shell(s.shells.at(0));
            INFO(phiBar << " " << h);
            const auto low = least(shell, [](const rod::Vec2& p) { return p.y(); });
            const double plate = s.rigid.bodies.at(1).position.y();
            const auto high = least(shell, [&](const rod::Vec2& p) { return plate - p.y(); });
            for (const double distance : {low.first, high.first}) {
                CHECK(distance - 0.5 * h >= 1e-8 - roundOff);
                CHECK(distance - 0.5 * h <= 1e-8 + roundOff);
            }
            CHECK((low.second == 0.0 || low.second == 1.0 || phiBar == 0.5));
            CHECK(high.second == 0.5);
        }
    }
}

TEST_CASE("pinning: clamped upright, the tip just touching the floor, bent to one side") {
    for (const double imperfection : {1e-6, 0.002, 0.1}) {
        const Scene s = loaded(scenePath("pinning"), {{"imperfection", imperfection}});
        const Uniform strip(s.shells.at(0));
        const double h = s.shells[0].thickness;
        CHECK(strip.arc.angleAt(-strip.half) == Approx(-M_PI / 2).epsilon(1e-15));
        CHECK(strip.at(0.0).x() == Approx(0.0).margin(1e-16));
        const auto low = least(strip, [](const rod::Vec2& p) { return p.y(); });
        CHECK(low.second == 1.0);
        CHECK(low.first - 0.5 * h >= 1e-8 - roundOff);
        CHECK(low.first - 0.5 * h <= 1e-8 + 10 * roundOff);
        CHECK(strip.at(1.0).x() > 0.0);
        CHECK(s.holds.at(0).base == HoldBase::Moving);
    }
}

TEST_CASE("ramp: both tips just touch the incline") {
    for (const double angle : {0.0, 0.3, 1.0}) {
        for (const double phiBar : {0.5, 0.75, 0.9}) {
            INFO(angle << " " << phiBar);
            const Scene s = loaded(scenePath("ramp"), {{"angle", angle}, {"phi_bar", phiBar}});
            const Uniform shell(s.shells.at(0));
            CHECK(s.rigid.bodies.at(0).angle == angle);
            const rod::Vec2 normal(-std::sin(angle), std::cos(angle));
            const double r = 0.5 * s.shells[0].thickness;
            for (const double tip : {0.0, 1.0}) {
                const double gap = shell.at(tip).dot(normal) - r;
                CHECK(gap >= 1e-7 - roundOff);
                CHECK(gap <= 1e-7 + roundOff);
            }
            CHECK(least(shell, [&](const rod::Vec2& p) { return p.dot(normal); }).first - r >= 1e-7 - roundOff);
        }
    }
}
