// Test by cutting: a floor in pieces gives the motion on the uncut chain.

#include "cut_world.h"

using namespace supercircle;
using namespace supercircle::seam_test;

namespace {

constexpr Cut kCuts[] = {Cut::Boxes, Cut::OneBody, Cut::Edges, Cut::Bricks, Cut::Overlapping, Cut::BesideChain};

std::string nameOf(Cut cut, Quality quality, int n) {
    const char* names[] = {"chain", "boxes", "one body", "edges", "bricks", "overlapping", "beside a chain"};
    return std::string(names[static_cast<int>(cut)]) + (quality == Quality::Game ? ", game, " : ", laboratory, ") +
           std::to_string(n);
}

double slideOver(Cut cut, Quality quality, int n, double step, double h) {
    CutWorld w(quality, 0.0);
    makeFloor(w, cut, n, step);
    const ShellHandle strip = w.strip({1.0, step}, 0.0, 3.0, 1.0, h);
    w.run(5.0);
    return w.speed(strip);
}

} // namespace

TEST_CASE("a frictionless strip keeps its speed on a floor of many pieces", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game})
        for (const int n : {10, 60})
            for (const Cut cut : kCuts) {
                INFO(nameOf(cut, quality, n));
                CHECK(slideOver(cut, quality, n, 0.0, 0.02) == Approx(3.0).epsilon(1e-3));
            }
}

TEST_CASE("steps of a tenth of the thickness are slopes", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game})
        for (const int n : {10, 60})
            for (const Cut cut : kCuts) {
                INFO(nameOf(cut, quality, n));
                CHECK(slideOver(cut, quality, n, 0.005, 0.05) == Approx(3.0).epsilon(1e-2));
                CHECK(slideOver(cut, quality, n, 0.002, 0.02) == Approx(3.0).epsilon(1e-2));
            }
}

TEST_CASE("a strip slides down a cut slope as down a chain", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        double speed = 0.0;
        for (const Cut cut : {Cut::Chain, Cut::Boxes, Cut::Edges, Cut::Overlapping}) {
            INFO(nameOf(cut, quality, 40));
            CutWorld w(quality, 0.1);
            makeFloor(w, cut, 40, 0.0, -0.3);
            const ShellHandle strip = w.strip({1.0 * std::cos(0.3), -1.0 * std::sin(0.3)}, -0.3, 0.0);
            w.run(4.0);
            if (cut == Cut::Chain)
                speed = w.speed(strip);
            CHECK(w.speed(strip) == Approx(speed).epsilon(5e-3));
        }
        CHECK(speed > 5.0);
    }
}

TEST_CASE("edges in a row without ghost vertices are a hill like a chain", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        Point velocity{};
        for (const bool cut : {false, true}) {
            CutWorld w(quality, 0.0);
            std::vector<b2Vec2> points;
            for (int i = 0; i <= 60; ++i)
                points.push_back(CutWorld::at(0.3 * i, 0.4 * std::sin(0.5 * 0.3 * i)));
            if (!cut)
                w.chain(points);
            for (std::size_t i = 0; cut && i + 1 < points.size(); ++i)
                w.edge(points[i], points[i + 1]);
            const ShellHandle strip = w.strip({1.0, 0.22}, 0.15, 3.0, 0.5);
            w.run(3.0);
            if (!cut)
                velocity = w.velocity(strip);
            CHECK(w.velocity(strip).x == Approx(velocity.x).epsilon(1e-2));
            CHECK(w.velocity(strip).y == Approx(velocity.y).margin(0.03));
        }
        CHECK(velocity.x > 2.0);
    }
}

TEST_CASE("a ring rolls over seams", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        double x = 0.0;
        for (const Cut cut : {Cut::Chain, Cut::Boxes, Cut::Edges, Cut::Overlapping}) {
            INFO(nameOf(cut, quality, 60));
            CutWorld w(quality, 0.5);
            makeFloor(w, cut, 60, 0.0);
            ShellDef d = scaled_shell(0.25, 1.0, 1.0, 20);
            d.closed = true;
            d.elements = 20;
            d.mu = 0.5;
            d.position = {1.0, 0.5 * d.thickness + 1e-4};
            d.velocity = {3.0, 0.0};
            const ShellHandle ring = w.made(d);
            w.run(4.0);
            if (cut == Cut::Chain)
                x = w.centre(ring).x;
            CHECK(w.centre(ring).x == Approx(x).epsilon(1e-2));
        }
        CHECK(x > 5.0);
    }
}

TEST_CASE("a dome with friction comes to rest across seams where it does on a chain", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        double x = 0.0;
        for (const Cut cut : {Cut::Chain, Cut::Boxes, Cut::Bricks, Cut::Overlapping}) {
            INFO(nameOf(cut, quality, 60));
            CutWorld w(quality, 0.3);
            makeFloor(w, cut, 60, 0.0);
            ShellDef d;
            d.radius = 0.4;
            d.length = M_PI * 0.4;
            d.phi_bar = 0.5;
            d.thickness = 0.02;
            d.width = 1.0;
            d.density = 50.0;
            d.young_modulus = 12.0 * 50.0 / 8e-6;
            d.elements = 16;
            d.mu = 0.3;
            d.angle = M_PI;
            d.position = {2.0, 0.41 + 1e-3};
            d.velocity = {2.5, 0.0};
            const ShellHandle dome = w.made(d);
            w.run(3.0);
            if (cut == Cut::Chain)
                x = w.centre(dome).x;
            CHECK(w.centre(dome).x == Approx(x).epsilon(1e-2));
            CHECK(w.speed(dome) < 1e-3);
        }
        CHECK(x > 2.5);
    }
}

TEST_CASE("a step of one thickness is a step", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        double x = 0.0;
        for (const bool cut : {false, true}) {
            CutWorld w(quality, 0.0);
            if (cut) {
                w.box(0.0, -1.0, 2.0, 0.0);
                w.box(2.0, -1.0, 4.0, 0.0);
                w.box(4.0, -1.0, 6.0, 0.02);
                w.box(6.0, -1.0, 9.0, 0.02);
            } else {
                w.chain({CutWorld::at(0, 0), CutWorld::at(4, 0), CutWorld::at(4, 0.02), CutWorld::at(9, 0.02)});
            }
            const ShellHandle strip = w.strip({2.0, 0.0}, 0.0, 1.0);
            w.run(3.0);
            INFO("speed " << w.speed(strip) << " at " << w.centre(strip).x);
            CHECK(w.centre(strip).x < 3.6);
            if (!cut)
                x = w.centre(strip).x;
            CHECK(w.centre(strip).x == Approx(x).epsilon(1e-2));
        }
    }
}

TEST_CASE("a strip leaves the end of a cut floor as that of one box", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        Point end{};
        for (const int n : {1, 6}) {
            CutWorld w(quality, 0.2);
            for (int i = 0; i < n; ++i)
                w.box(3.0 * i / n, -1.0, 3.0 * (i + 1) / n, 0.0);
            const ShellHandle strip = w.strip({2.0, 0.0}, 0.0, 3.0);
            w.run(1.0);
            if (n == 1)
                end = w.centre(strip);
            CHECK(w.centre(strip).x == Approx(end.x).epsilon(1e-2));
            CHECK(w.centre(strip).y == Approx(end.y).epsilon(1e-2));
        }
        CHECK(end.y < -0.1);
    }
}

TEST_CASE("crates that move apart open a gap", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        CutWorld w(quality, 0.0);
        b2Body* crates[] = {w.body(b2_kinematicBody), w.body(b2_kinematicBody)};
        w.box(-1.0, -1.0, 0.0, 0.0, crates[0]);
        w.box(0.0, -1.0, 1.0, 0.0, crates[1]);
        const ShellHandle strip = w.strip({0.0, 0.0}, 0.0, 0.0, 0.3);
        w.run(0.5);
        CHECK(w.centre(strip).y == Approx(0.01).margin(1e-4));
        crates[0]->SetLinearVelocity({-0.4f, 0.0f});
        crates[1]->SetLinearVelocity({0.4f, 0.0f});
        w.run(0.75);
        CHECK(w.centre(strip).y < -0.1);
    }
}

TEST_CASE("a crate at rest beside a wall that moves away lets a strip fall between", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        CutWorld w(quality, 0.0);
        w.box(-1.0, -3.0, 0.0, 0.0);
        b2Body* crate = w.body(b2_kinematicBody);
        w.box(0.0, -1.0, 1.0, 0.0, crate);
        const ShellHandle strip = w.strip({0.03, 0.0}, 0.0, 0.0, 0.3);
        w.run(0.5);
        CHECK(w.centre(strip).y == Approx(0.01).margin(1e-4));
        crate->SetLinearVelocity({0.8f, 0.0f});
        w.run(0.75);
        CHECK(w.centre(strip).y < -0.05);
    }
}

TEST_CASE("a strip slides over crates that stand side by side", "[seams]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        CutWorld w(quality, 0.0, 50.0);
        w.box(-1.0, -2.0, 8.0, -1.0);
        for (int i = 0; i < 7; ++i)
            w.box(i, -1.0, i + 1.0, 0.0, w.body(b2_dynamicBody));
        w.run(0.5);
        const ShellHandle strip = w.strip({1.0, 0.0005}, 0.0, 3.0);
        w.run(1.5);
        CHECK(w.speed(strip) == Approx(3.0).epsilon(1e-2));
        CHECK(w.centre(strip).x > 5.4);
    }
}
