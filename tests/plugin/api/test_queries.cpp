// Queries: exact results, against closed forms and brute force.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

using namespace supercircle;
using namespace supercircle::test;
using rod::Vec2;

namespace {

/// Random bends, so that no element is like another.
ShellDef crooked(std::mt19937& random, int elements) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    ShellDef d;
    d.length = 0.2;
    d.thickness = 0.004;
    d.elements = elements;
    d.radius = kInf; // the natural shape has no part in queries
    for (int i = 0; i < elements; ++i)
        d.curvature.push_back(40.0 * unit(random));
    d.position = {0.05 * unit(random), 0.05 * unit(random)};
    d.angle = 3.0 * unit(random);
    return d;
}

/// Distance of p from the centre line, by ten thousand points.
double bruteDistance(const step::Rod& rod, const Vec2& p, double& s) {
    double best = kInf;
    const double length = rod.model.definition().length;
    for (int i = 0; i <= 10000; ++i) {
        const double at = length * i / 10000;
        const double d = (rod.kin.point(rod::locate(rod.model, at)) - p).norm();
        if (d < best) {
            best = d;
            s = at;
        }
    }
    return best;
}

double size(const Point& p) {
    return std::hypot(p.x, p.y);
}

} // namespace

TEST_CASE("rays hit the thick dome where the circles are", "[plugin][queries]") {
    Shells shells(nullptr);
    const double R = 0.05, h = 0.002;
    const ShellHandle shell = *shells.create(dome(R, h));
    // from far outside straight at the centre, under many angles: outer circle, radial normal
    for (int i = 1; i < 40; ++i) {
        const double a = M_PI * i / 40.0;
        const auto hit = shells.ray_cast({0.2 * std::cos(a), 0.2 * std::sin(a)}, {0.0, 0.0});
        REQUIRE(hit);
        CHECK(hit->shell == shell);
        CHECK(size(hit->point) == Approx(R + 0.5 * h).epsilon(1e-12));
        CHECK(hit->normal.x == Approx(std::cos(a)).margin(1e-9));
        CHECK(hit->normal.y == Approx(std::sin(a)).margin(1e-9));
        CHECK(hit->fraction == Approx((0.2 - R - 0.5 * h) / 0.2).epsilon(1e-12));
        CHECK(hit->arc_fraction == Approx(a / M_PI).margin(1e-9)); // the shell starts at (R, 0)
        const auto from = shells.ray_cast({0.0, 0.0}, {0.2 * std::cos(a), 0.2 * std::sin(a)});
        REQUIRE(from);
        CHECK(size(from->point) == Approx(R - 0.5 * h).epsilon(1e-12)); // the inner one from within
        CHECK(from->normal.x == Approx(-std::cos(a)).margin(1e-9));
    }
    // across: two walls, entered at the outer surface on the right and the inner one on the left
    const double y = 0.02;
    const auto both = shells.ray_cast_all({0.1, y}, {-0.1, y});
    REQUIRE(both);
    REQUIRE(both->size() == 2);
    const auto x = [&](double r) { return std::sqrt(r * r - y * y); };
    CHECK((*both)[0].point.x == Approx(x(R + 0.5 * h)).epsilon(1e-12));
    CHECK((*both)[1].point.x == Approx(-x(R - 0.5 * h)).epsilon(1e-12));
    CHECK((*both)[0].fraction < (*both)[1].fraction);
    // the round end: a ray from below onto the tip at (R, 0)
    const auto tip = shells.ray_cast({R + 0.0004, -0.1}, {R + 0.0004, 0.1});
    REQUIRE(tip);
    CHECK(tip->point.y == Approx(-std::sqrt(0.25 * h * h - 0.0004 * 0.0004)).epsilon(1e-10));
    CHECK(tip->arc_fraction == Approx(0.0).margin(1e-12));
    CHECK_FALSE(shells.ray_cast({0.0, -0.1}, {0.0, 0.04})); // through the open side, too short
    CHECK_FALSE(shells.ray_cast({0.1, 0.1}, {0.2, 0.2}));
    // starting inside the wall
    const auto inside = shells.ray_cast({0.0, R + 0.0002}, {0.0, 1.0});
    REQUIRE(inside);
    CHECK(inside->fraction == 0.0);
    CHECK(inside->normal.y == Approx(1.0));
}

TEST_CASE("rays and closest points agree with brute force on irregular shells", "[plugin][queries]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int round = 0; round < 30; ++round) {
        Shells shells(nullptr);
        const int elements[] = {3, 4, 5, 15};
        ShellDef d = crooked(random, elements[round % 4]);
        if (round % 4 == 0)
            d.curvature.assign(d.curvature.size(), 25.0 + 5.0 * unit(random)); // nearly a circle
        if (round % 5 == 0)
            d.curvature.assign(d.curvature.size(), round % 10 == 0 ? 0.0 : 1e-9); // straight, or as good as
        const ShellHandle shell = *shells.create(d);
        const step::Rod& rod = shells.world().rods[0];
        const double half = 0.5 * d.thickness;
        for (int k = 0; k < 20; ++k) {
            const Vec2 p(0.15 * unit(random), 0.15 * unit(random));
            double s = 0.0;
            const double distance = bruteDistance(rod, p, s);
            const auto near = shells.closest_point(shell, {p.x(), p.y()});
            REQUIRE(near);
            // ten thousand points on 0.2 m: 1e-5 beside the foot at a distance above 1e-3 is below 1e-7
            CHECK(near->distance == Approx(distance - half).margin(distance > 1e-3 ? 1e-7 : 1e-5));
            CHECK(near->distance <= distance - half + 1e-12);
            CHECK(std::hypot(near->point.x - p.x(), near->point.y - p.y()) ==
                  Approx(std::abs(near->distance)).margin(1e-12));
            CHECK(static_cast<bool>(shells.overlap_point({p.x(), p.y()})->size()) == (near->distance <= 0.0));
            const double r = std::abs(0.1 * unit(random));
            CHECK(shells.overlap_circle({p.x(), p.y()}, r)->size() == (near->distance <= r ? 1u : 0u));
            // a ray: march along it
            const Vec2 to(0.15 * unit(random), 0.15 * unit(random));
            const auto all = shells.ray_cast_all({p.x(), p.y()}, {to.x(), to.y()});
            REQUIRE(all);
            for (const RayHit& hit : *all) {
                const auto at = shells.closest_point(shell, hit.point);
                if (hit.fraction > 0.0)
                    CHECK(at->distance == Approx(0.0).margin(1e-11)); // on the surface
                CHECK(size(hit.normal) == Approx(1.0));
            }
            std::size_t entered = 0;
            bool inside = false, grazing = false;
            for (int i = 0; i <= 2000; ++i) {
                const Vec2 x = p + (to - p) * (i / 2000.0);
                const double depth = shells.closest_point(shell, {x.x(), x.y()})->distance;
                grazing = grazing || std::abs(depth) < 2e-4;
                entered += depth <= 0.0 && !inside ? 1 : 0;
                inside = depth <= 0.0;
            }
            if (!grazing || entered > all->size()) // the march may miss what it only brushes
                CHECK(all->size() == entered);
            else
                CHECK(all->size() >= entered);
            const auto first = shells.ray_cast({p.x(), p.y()}, {to.x(), to.y()});
            CHECK(static_cast<bool>(first) == !all->empty());
            if (first)
                CHECK(first->fraction == all->front().fraction);
        }
    }
}

TEST_CASE("boxes overlap shells up to the surface, corners included", "[plugin][queries]") {
    Shells shells(nullptr);
    const double R = 0.05, h = 0.002;
    REQUIRE(shells.create(dome(R, h)));
    const auto meets = [&](double x0, double y0, double x1, double y1) {
        return !shells.overlap_box({{x0, y0}, {x1, y1}})->empty();
    };
    const double top = R + 0.5 * h;
    CHECK(meets(-0.001, top - 1e-9, 0.001, 0.2));
    CHECK_FALSE(meets(-0.001, top + 1e-9, 0.001, 0.2));
    CHECK_FALSE(meets(-0.03, 0.0, 0.03, 0.03));      // within the dome
    CHECK(meets(-0.2, -0.2, 0.2, 0.2));              // around it
    CHECK(meets(0.0, 0.0, 0.0, 0.2));                // a box without width
    const double c = (R + 0.5 * h) / std::sqrt(2.0); // a corner from the upper right
    CHECK(meets(c - 1e-9, c - 1e-9, 0.2, 0.2));
    CHECK_FALSE(meets(c + 1e-9, c + 1e-9, 0.2, 0.2));
}

TEST_CASE("the bounding box is the smallest one", "[plugin][queries]") {
    Shells shells(nullptr);
    const double R = 0.05, h = 0.002;
    const ShellState m = *shells.state(*shells.create(dome(R, h)));
    CHECK(m.box.upper.y == Approx(R + 0.5 * h).epsilon(1e-12));
    CHECK(m.box.lower.y == Approx(-0.5 * h).epsilon(1e-9));
    CHECK(m.box.upper.x == Approx(R + 0.5 * h).epsilon(1e-12));
    CHECK(m.box.lower.x == Approx(-R - 0.5 * h).epsilon(1e-12));
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        Shells other(nullptr);
        const ShellHandle shell = *other.create(crooked(random, 3 + round % 6));
        const Box box = other.state(shell)->box;
        const step::Rod& rod = other.world().rods[0];
        Vec2 low = Vec2::Constant(kInf), high = Vec2::Constant(-kInf);
        for (int i = 0; i <= 20000; ++i) {
            const Vec2 p = rod.kin.point(rod::locate(rod.model, 0.2 * i / 20000));
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        const double half = 0.002; // 1e-5 m between points, curvature below 40: 5e-10
        CHECK(box.lower.x == Approx(low.x() - half).margin(1e-8));
        CHECK(box.lower.y == Approx(low.y() - half).margin(1e-8));
        CHECK(box.upper.x == Approx(high.x() + half).margin(1e-8));
        CHECK(box.upper.y == Approx(high.y() + half).margin(1e-8));
    }
}

TEST_CASE("sections and sums of a bent shell in rigid motion", "[plugin][queries]") {
    Shells shells(nullptr);
    ShellDef d = dome();
    d.curvature.assign(9, 14.0); // natural 20
    d.velocity = {0.3, -0.1};    // of the middle
    d.spin = 2.0;
    const ShellHandle shell = *shells.create(d);
    const double B = bending_modulus(d), L = M_PI * d.radius;
    const Point middle = shells.section(shell, 0.5)->position;
    CHECK(middle.x == Approx(0.0).margin(1e-15));
    for (const double f : {0.0, 0.1, 0.37, 0.5, 0.99, 1.0}) {
        const auto s = shells.section(shell, f);
        REQUIRE(s);
        CHECK(s->curvature == 14.0);
        CHECK(s->natural_curvature == Approx(20.0));
        CHECK(s->bending_moment == Approx(-6.0 * B));
        CHECK(s->surface_strain == Approx(0.5 * d.thickness * 6.0));
        CHECK(s->energy_density == Approx(0.5 * B * 36.0));
        CHECK(s->angle == Approx(M_PI + 14.0 * (f - 0.5) * L).epsilon(1e-12));
        CHECK(size(s->tangent) == Approx(1.0));
        CHECK(s->spin == Approx(2.0).epsilon(1e-12));
        CHECK(s->velocity.x == Approx(0.3 - 2.0 * (s->position.y - middle.y)).epsilon(1e-12));
        CHECK(s->velocity.y == Approx(-0.1 + 2.0 * (s->position.x - middle.x)).epsilon(1e-12));
        CHECK(size({s->position.x, s->position.y - (d.radius - 1.0 / 14.0)}) == Approx(1.0 / 14.0).epsilon(1e-12));
    }
    const ShellState m = *shells.state(shell);
    const double mass = d.density * d.width * d.thickness * L;
    CHECK(m.length == Approx(L));
    CHECK(m.mass == Approx(mass));
    CHECK(m.stored_energy == Approx(0.5 * B * 36.0 * L));
    CHECK(m.max_surface_strain == Approx(0.5 * d.thickness * 6.0));
    // centroid of a circular arc: r sin(a)/a from its centre
    const double r = 1.0 / 14.0, a = 0.5 * 14.0 * L;
    const double fromCentre = r * std::sin(a) / a;
    CHECK(m.centre.y == Approx(d.radius - r + fromCentre).epsilon(1e-9));
    const double lever = m.centre.y - middle.y;
    CHECK(m.momentum.x == Approx(mass * (0.3 - 2.0 * lever)).epsilon(1e-9));
    CHECK(m.momentum.y == Approx(-0.1 * mass).epsilon(1e-9));
    const double inertia = mass * (r * r - fromCentre * fromCentre); // about the centroid
    CHECK(m.angular_momentum == Approx(2.0 * inertia).epsilon(1e-9));
    const double v2 = std::pow(0.3 - 2.0 * lever, 2) + 0.01;
    CHECK(m.kinetic_energy == Approx(0.5 * mass * v2 + 0.5 * inertia * 4.0).epsilon(1e-9));
    CHECK_FALSE(m.quarantined);
}

TEST_CASE("of several shells the closest, the first hit, and those selected by the mask", "[plugin][queries]") {
    Shells shells(nullptr);
    std::vector<ShellHandle> made;
    for (int i = 0; i < 4; ++i) {
        ShellDef d = dome(0.02, 0.001);
        d.position.x = 0.1 * i;
        d.category = static_cast<std::uint16_t>(1u << i);
        made.push_back(*shells.create(d));
    }
    const auto all = shells.ray_cast_all({-1.0, 0.01}, {1.0, 0.01});
    REQUIRE(all->size() == 8);
    CHECK((*all)[0].shell == made[0]);
    CHECK((*all)[7].shell == made[3]);
    CHECK(shells.ray_cast({1.0, 0.01}, {-1.0, 0.01})->shell == made[3]);
    CHECK(shells.ray_cast({1.0, 0.01}, {-1.0, 0.01}, 0x3)->shell == made[1]);
    CHECK_FALSE(shells.ray_cast({1.0, 0.01}, {-1.0, 0.01}, 0x10));
    CHECK(shells.closest_point({0.19, 0.1})->shell == made[2]);
    CHECK(shells.closest_point({0.19, 0.1}, 1.0, 0x9)->shell == made[3]);
    CHECK_FALSE(shells.closest_point({0.19, 0.1}, 0.01));
    CHECK(*shells.overlap_circle({0.1, 0.0}, 0.09) == std::vector<ShellHandle>{made[0], made[1], made[2]});
}

TEST_CASE("shells skipped for their distance are far away", "[plugin][queries]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    Shells shells(nullptr);
    std::vector<ShellHandle> made;
    for (int i = 0; i < 40; ++i) {
        ShellDef d = crooked(random, 5 + i % 4);
        d.position = {unit(random), unit(random)};
        if (i % 5 == 0) // straight ones reach as far as their length allows
            d.curvature.assign(static_cast<std::size_t>(d.elements), 0.0);
        made.push_back(*shells.create(d));
    }
    for (int i = 0; i < 300; ++i) {
        const Point p{1.2 * unit(random), 1.2 * unit(random)}, to{1.2 * unit(random), 1.2 * unit(random)};
        const double radius = 0.3 * std::abs(unit(random));
        double nearest = kInf;
        std::vector<ShellHandle> near;
        for (const ShellHandle& h : made) { // one by one: none is left out
            const double d = shells.closest_point(h, p)->distance;
            nearest = std::min(nearest, d);
            if (d <= radius)
                near.push_back(h);
        }
        REQUIRE(shells.closest_point(p)->distance == nearest);
        REQUIRE(*shells.overlap_circle(p, radius) == near);
        REQUIRE(static_cast<bool>(shells.closest_point(p, radius)) == !near.empty());
        const double side = radius * std::sqrt(0.5); // a box inside the disc, and one around it
        const auto within = shells.overlap_box({{p.x - side, p.y - side}, {p.x + side, p.y + side}});
        for (const ShellHandle& h : *within)
            REQUIRE(std::count(near.begin(), near.end(), h) == 1);
        const auto around = shells.overlap_box({{p.x - radius, p.y - radius}, {p.x + radius, p.y + radius}});
        for (const ShellHandle& h : near)
            REQUIRE(std::count(around->begin(), around->end(), h) == 1);
        const auto hit = shells.ray_cast(p, to);
        const double length = std::hypot(to.x - p.x, to.y - p.y);
        if (nearest < 0.0) { // the ray begins within a shell
            REQUIRE(hit->fraction == 0.0);
            continue;
        }
        for (int k = 0; k <= 50; ++k) { // nothing of a shell lies on the way to the first hit
            const double t = (hit ? hit->fraction : 1.0) * k / 50.0;
            REQUIRE(shells.closest_point({p.x + t * (to.x - p.x), p.y + t * (to.y - p.y)})->distance >= -1e-9 * length);
        }
    }
}

TEST_CASE("bad queries fail with a reason", "[plugin][queries]") {
    Shells shells(nullptr);
    const ShellHandle shell = *shells.create(dome());
    const ShellHandle stale{shell.index, shell.generation + 1, shell.world};
    for (const double bad : {kNan, kInf, -kInf, 1e200}) {
        CHECK_FALSE(shells.ray_cast({bad, 0.0}, {0.0, 0.0}));
        CHECK_FALSE(shells.ray_cast_all({0.0, 0.0}, {0.0, bad}));
        CHECK_FALSE(shells.overlap_point({bad, 0.0}));
        CHECK_FALSE(shells.overlap_circle({0.0, 0.0}, bad));
        CHECK_FALSE(shells.overlap_box({{0.0, bad}, {1.0, 1.0}}));
        CHECK_FALSE(shells.closest_point({0.0, bad}));
        CHECK_FALSE(shells.closest_point(shell, {bad, bad}));
        CHECK_FALSE(shells.section(shell, bad));
    }
    CHECK_FALSE(shells.ray_cast({0.0, 0.0}, {0.0, 0.0}));
    CHECK_FALSE(shells.overlap_box({{1.0, 0.0}, {0.0, 1.0}}));
    CHECK_FALSE(shells.overlap_circle({0.0, 0.0}, -1.0));
    CHECK_FALSE(shells.closest_point({0.0, 0.0}, kNan));
    CHECK_FALSE(shells.section(shell, -0.1));
    CHECK_FALSE(shells.section(stale, 0.5));
    CHECK_FALSE(shells.state(stale));
    CHECK_FALSE(shells.closest_point(stale, {0.0, 0.0}));
    CHECK_FALSE(shells.closest_point(ShellHandle{}, {0.0, 0.0}).error().empty());
    CHECK(shells.closest_point({0.0, 0.0})); // the centre of the circle: every point is as near
    CHECK(shells.closest_point({0.0, 0.0})->distance == Approx(0.05 - 0.001));
}
