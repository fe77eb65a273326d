#pragma once
// A user's Box2D world with shells, stepped as by a program, and measures of the quality of the coupling. Lengths are
// in SI; Box2D's are kScale times larger.

#include "bridge/box2d/box2d_port.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>

namespace supercircle::bridge_test {

using rod::Vec2;

constexpr double kScale = 52.1;    ///< Box2D units per metre
constexpr double kRadius = 0.0192; ///< m, of the paper's shell
constexpr double kThick = 0.0005;  ///< m, its thickness
constexpr double kFall = 9.81;     ///< m/s^2

inline b2Vec2 host(double x, double y) {
    return {static_cast<float>(x * kScale), static_cast<float>(y * kScale)};
}

class CoupledWorld {
public:
    explicit CoupledWorld(double g = kFall)
        : world(host(0.0, -g)), port(bridge::attach(world, {kScale})), stepper(step::Settings{}) {}

    /// A floor whose upper face is y = 0: a two-sided edge.
    b2Body* floor(double friction = 0.5, double y = 0.0) {
        b2BodyDef def;
        b2Body* b = world.CreateBody(&def);
        b2EdgeShape edge;
        edge.SetTwoSided(host(-5.0, y), host(5.0, y));
        b2FixtureDef f;
        f.shape = &edge;
        f.friction = static_cast<float>(friction);
        b->CreateFixture(&f);
        return b;
    }
    /// A box of given half sizes and mass, with the inertia of a homogeneous one.
    b2Body* box(double x, double y, double halfX, double halfY, double mass, double friction = 0.5) {
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position = host(x, y);
        b2Body* b = world.CreateBody(&def);
        b2PolygonShape shape;
        shape.SetAsBox(static_cast<float>(halfX * kScale), static_cast<float>(halfY * kScale));
        b2FixtureDef f;
        f.shape = &shape;
        f.friction = static_cast<float>(friction);
        f.density = static_cast<float>(mass / (4.0 * halfX * halfY * kScale * kScale));
        b->CreateFixture(&f);
        return b;
    }
    b2Body* disc(double x, double y, double radius, double mass, double friction = 0.5) {
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position = host(x, y);
        b2Body* b = world.CreateBody(&def);
        b2CircleShape shape;
        shape.m_radius = static_cast<float>(radius * kScale);
        b2FixtureDef f;
        f.shape = &shape;
        f.friction = static_cast<float>(friction);
        f.density = static_cast<float>(mass / (M_PI * radius * radius * kScale * kScale));
        b->CreateFixture(&f);
        return b;
    }
    /// The paper's shell as a half circle that opens downwards, its tips on the floor.
    std::size_t dome(double x, double mu = 0.5, int elements = 15, double phiBar = 0.5) {
        rod::RodDefinition d;
        d.length = 2.0 * M_PI * phiBar * kRadius;
        d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0 / kRadius);
        const double rise = kRadius * (1.0 - std::cos(M_PI * phiBar)); // of the middle above the tips
        return put(d, {x, rise + 0.5 * d.thickness + 1e-6}, M_PI, mu);
    }
    /// Natural shape, its middle at `middle`, tangent at `angle`.
    std::size_t put(const rod::RodDefinition& d, const Vec2& middle, double angle, double mu,
                    const Vec2& velocity = Vec2::Zero()) {
        const rod::RodModel m(d);
        Eigen::VectorXd q = Eigen::VectorXd::Zero(m.dofs()), v = q;
        for (int i = 0; i < m.elements(); ++i)
            q[m.dofOfElement(i)] = d.naturalCurvature[static_cast<std::size_t>(i)];
        q[m.dofX()] = middle.x();
        q[m.dofY()] = middle.y();
        q[m.dofTheta()] = angle;
        v[m.dofX()] = velocity.x();
        v[m.dofY()] = velocity.y();
        return step::addRod(shells, d, q, v, mu);
    }

    void frame(double dt) {
        const step::FrameResult out = stepper.advance(shells, dt, port.get(), {});
        INFO(out.failure);
        REQUIRE(out.failure.empty());
        world.Step(static_cast<float>(dt), 8, 3);
        port->stepped(dt);
        stepper.learnFromHost(shells, *port, dt);
    }

    /// Distance of the shells from the body's outline where Box2D has it now, m (negative: overlap); large if none.
    double gap(const b2Body* body) {
        std::vector<step::BodyOutline> bodyOutlines;
        port->everything(bodyOutlines);
        std::vector<contact::Outline> outlines;
        step::BodyState s;
        REQUIRE(port->state(port->idOf(*body), s));
        for (const step::BodyOutline& o : bodyOutlines)
            if (o.body == port->idOf(*body)) {
                outlines.push_back(step::placed(o, s.centre, s.angle));
                outlines.back().key = static_cast<std::uint32_t>(outlines.size());
            }
        std::vector<contact::RodCurve> curves(shells.rods.size());
        for (std::size_t i = 0; i < curves.size(); ++i)
            step::toCurve(shells.rods[i], shells.rods[i].kin, curves[i]);
        std::vector<contact::Candidate> near;
        contact::Detector().detect(curves, outlines, {4.0 * kThick}, near);
        double least = 1.0;
        for (const contact::Candidate& c : near)
            if (c.outline >= 0)
                least = std::min(least, c.gap);
        return least;
    }
    /// Kinetic and gravitational energy of Box2D's dynamic bodies, J.
    double bodyEnergy() {
        double sum = 0.0;
        for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext()) {
            step::BodyState s;
            if (b->GetType() != b2_dynamicBody || !port->state(port->idOf(*b), s))
                continue;
            sum += 0.5 * s.mass * s.velocity.squaredNorm() + 0.5 * s.inertia * s.spin * s.spin -
                   s.mass * s.gravityScale * port->gravity().dot(s.centre);
        }
        return sum;
    }
    double energy() { return bodyEnergy() + shells.energyBalance.stored(); }
    static double speed(const b2Body* b) { return static_cast<double>(b->GetLinearVelocity().Length()) / kScale; }

    b2World world;
    bridge::Attachment port;
    step::World shells;
    step::Stepper stepper;
};

} // namespace supercircle::bridge_test
