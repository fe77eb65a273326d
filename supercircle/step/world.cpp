#include "supercircle/step/world.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

const char* name(Stage stage) {
    static const char* const names[] = {"check",  "drive", "pull",    "collide", "evaluate", "predict",
                                        "couple", "solve", "advance", "push",    "count"};
    return names[static_cast<int>(stage)];
}

void HostPush::learn(const Vec2& newLinear, double newAngular) {
    const auto agreed = [](double a, double b) { return a * b <= 0.0 ? 0.0 : std::abs(a) < std::abs(b) ? a : b; };
    expectedLinear = {agreed(linear.x(), newLinear.x()), agreed(linear.y(), newLinear.y())};
    expectedAngular = agreed(angular, newAngular);
    linear = newLinear;
    angular = newAngular;
}

Vec2 World::machineForce() const {
    Vec2 sum = Vec2::Zero();
    for (const Body& b : bodies)
        if (b.driven)
            sum += b.force;
    for (const Rod& r : rods)
        for (const Hold& h : r.holds)
            if (h.onMachine)
                sum -= h.reaction;
    return sum;
}

void refreshRod(Rod& rod) {
    rod.kin.evaluate(rod.model, rod.q);
    rod::evaluateGauss(rod.model, rod.kin, rod.gauss);
    rod::velocityField(rod.model, rod.kin, rod.gauss, rod.v, rod.u);
    rod.speed = 0.0;
    for (const Vec2& u : rod.u)
        rod.speed = std::max(rod.speed, u.norm());
}

namespace {

double gravityPotential(const World& world, const Rod& rod) {
    return -rod.model.mass() * world.gravity.dot(rod::massCentre(rod.kin, rod.gauss));
}

void book(World& world, const Rod& rod, double sign) {
    const double kinetic = rod::kineticEnergy(rod.gauss, rod.u);
    const double bending = rod::bendingEnergy(rod.model, rod.q);
    const double gravity = gravityPotential(world, rod);
    world.ledger.kinetic += sign * kinetic;
    world.ledger.bending += sign * bending;
    world.ledger.gravity += sign * gravity;
    world.ledger.added += sign * (kinetic + bending + gravity);
}

} // namespace

std::size_t addRod(World& world, const rod::RodDefinition& definition, const Eigen::VectorXd& q,
                   const Eigen::VectorXd& v, double mu) {
    Rod rod{rod::RodModel(definition), q, v, q, {}, {}, mu, world.nextKey++, 1, 0xffff, false, 0.0, {}, {}};
    refreshRod(rod);
    book(world, rod, 1.0);
    world.rods.push_back(std::move(rod));
    return world.rods.size() - 1;
}

void removeRod(World& world, std::size_t index) {
    book(world, world.rods[index], -1.0);
    world.rods.erase(world.rods.begin() + static_cast<std::ptrdiff_t>(index));
}

void toCurve(const Rod& rod, const rod::Kinematics& kin, contact::Curve& curve) {
    curve.arcs = kin.arcs();
    const int N = rod.model.elements();
    curve.nodeS.resize(static_cast<std::size_t>(N) + 1);
    for (int i = 0; i <= N; ++i)
        curve.nodeS[static_cast<std::size_t>(i)] = rod.model.nodeS(i);
    curve.halfThickness = 0.5 * rod.model.definition().thickness;
    curve.midS = rod.model.midS();
    curve.closed = rod.model.definition().closed;
    curve.key = rod.key;
    curve.category = rod.quarantined ? 0u : rod.category;
    curve.mask = rod.quarantined ? 0u : rod.mask;
}

contact::Outline placed(const BodyOutline& piece, const Vec2& centre, double angle) {
    contact::Outline out = piece.local;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto put = [&](Vec2& p) { p = centre + Vec2(c * p.x() - s * p.y(), s * p.x() + c * p.y()); };
    for (Vec2& p : out.points)
        put(p);
    put(out.neighbourStart);
    put(out.neighbourEnd);
    return out;
}

} // namespace supercircle::step
