// Contact in motion: rebounds, their dependence on the step, order, energy that must not grow.

#include "tests/supercircle/step/setup.h"
#include "tests/support/fake_host.h"

#include <algorithm>

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kDrop = 0.5; ///< m

step::Settings settingsOfImpact(bool game) {
    return game ? step::gameSettings() : step::Settings{};
}

/// A ring of 1 m whose softest mode swings at 8 Hz, above a floor.
struct Ring {
    step::World world;
    FakeHost host;
    double gained = 0.0;   ///< most energy that a frame brought in but for what overlaps gave, of the fall's
    double injected = 0.0; ///< most that overlaps gave in a frame
    double above = 0.0;    ///< most energy at the end of a frame, with what overlaps gave, over that of the start
    double energy = 0.0, overlaps = 0.0;

    explicit Ring(int elements, const Vec2& velocity = Vec2::Zero(), double spin = 0.0) {
        rod::RodDefinition d;
        d.thickness = 0.02;
        d.length = 2.0 * M_PI * radius();
        d.linearMass = 1.0;
        d.bendingModulus = 21.7;
        d.closed = true;
        d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0 / radius());
        world.gravity = host.g = {0.0, -kG};
        host.addGround(1, 0.3);
        put(world, d, {0.0, 0.5 * d.thickness + kDrop}, 0.0, 0.3); // its middle is its lowest point
        step::Rod& r = world.rods[0];
        Eigen::VectorXd v = Eigen::VectorXd::Zero(r.model.dofs());
        v.segment<2>(r.model.dofX()) = velocity + spin * rod::perp(r.kin.middle() - rod::massCentre(r.kin, r.gauss));
        v[r.model.dofTheta()] = spin;
        step::placeRod(world, 0, r.q, v);
    }
    static double radius() { return 0.5; }
    [[nodiscard]] double fall() const { return world.rods[0].model.mass() * kG * kDrop; } ///< J

    void frame(step::Stepper& stepper, double length) {
        const auto end = stepper.advance(world, length, &host, {});
        REQUIRE(end.failure.empty());
        host.step(length);
        const double given = world.energyBalance.injected.sum();
        const double now = world.energyBalance.stored() - world.energyBalance.added - given;
        gained = std::max(gained, (now - energy) / fall());
        injected = std::max(injected, (given - overlaps) / fall());
        above = std::max(above, (now + given) / fall());
        energy = now;
        overlaps = given;
    }
    /// Height to which the centre of mass would rise, over that of the drop.
    [[nodiscard]] double rise() const {
        const step::Rod& r = world.rods[0];
        Vec2 v = Vec2::Zero();
        for (std::size_t g = 0; g < r.u.size(); ++g)
            v += (r.gauss.mass[g] / r.model.mass()) * r.u[g];
        const double rest = radius() + 0.5 * r.model.definition().thickness;
        return (rod::massCentre(r.kin, r.gauss).y() + 0.5 * v.y() * v.y() / kG - rest) / kDrop;
    }
};

/// Rise after the first bounce; the first frame is `phase` of the others, every second one `alternate` of them.
double play(Ring& ring, const step::Settings& settings, double frame, double phase = 1.0, double alternate = 1.0) {
    step::Stepper stepper(settings);
    ring.frame(stepper, phase * frame);
    bool shorter = false;
    for (double t = phase * frame; t < 2.1 * std::sqrt(2.0 * kDrop / kG); shorter = !shorter) {
        const double length = shorter ? alternate * frame : frame;
        ring.frame(stepper, length);
        t += length;
    }
    CHECK(std::abs(ring.world.energyBalance.residual()) < 1e-9 * ring.fall());
    return ring.rise();
}

double rebound(Ring ring, const step::Settings& settings, double frame, double phase = 1.0, double alternate = 1.0) {
    return play(ring, settings, frame, phase, alternate);
}

} // namespace

TEST_CASE("a ring rebounds at 60 Hz as in frames a sixteenth as long", "[step][rebound]") {
    const bool game = GENERATE(true, false);
    const int elements = GENERATE(15, 30, 60);
    const step::Settings s = settingsOfImpact(game);
    const double fine = rebound(Ring(elements), s, 1.0 / 960.0);
    CAPTURE(game, elements, fine);
    CHECK(fine > 0.25); // backward Euler left 0 in games and a quarter in the laboratory
    CHECK(rebound(Ring(elements), s, 1.0 / 60.0) == Approx(fine).epsilon(game ? 0.1 : 0.02));
    // A ring that spins and slides has more changes of contact on its way.
    const double spun = rebound(Ring(elements, {2.0, 0.0}, 8.0), s, 1.0 / 960.0);
    CHECK(rebound(Ring(elements, {2.0, 0.0}, 8.0), s, 1.0 / 60.0) == Approx(spun).epsilon(game ? 0.1 : 0.02));
}

namespace {

void playAllPhases(bool game, int elements) {
    step::Settings s = settingsOfImpact(game);
    s.dampingRatio = 0.0; // it would hide a gain
    double lowest = 1e9, highest = 0.0;
    for (int k = 1; k <= 20; ++k) {
        Ring ring(elements);
        const double rise = play(ring, s, 1.0 / 60.0, k / 20.0);
        lowest = std::min(lowest, rise);
        highest = std::max(highest, rise);
        CAPTURE(game, elements, k);
        CHECK(ring.gained < 1e-5);   // of the fall: free motion may gain as much where arcs turn fast
        CHECK(ring.above < 1e-5);    // with what overlaps gave: never more than at the start
        CHECK(ring.injected < 5e-3); // half of what raises the alarm
        CHECK(rise < 1.0);
    }
    CHECK(highest - lowest < (game ? 0.1 : 0.02) * highest);
}

} // namespace

TEST_CASE("no phase of the impact changes the rebound or gains energy", "[step][rebound]") {
    playAllPhases(GENERATE(true, false), 15);
}

TEST_CASE("no phase of the impact changes the rebound of finer rings or gains energy", "[step][rebound][slow]") {
    playAllPhases(GENERATE(true, false), GENERATE(30, 60));
}

TEST_CASE("frames that jump by sixteen do not change the rebound", "[step][rebound]") {
    const bool game = GENERATE(true, false);
    const step::Settings s = settingsOfImpact(game);
    const double even = rebound(Ring(15), s, 1.0 / 60.0);
    CHECK(rebound(Ring(15), s, 1.0 / 60.0, 1.0, 1.0 / 16.0) == Approx(even).epsilon(game ? 0.1 : 0.02));
}

TEST_CASE("a ring that has bounced to rest stays on the floor", "[step][rebound]") {
    const bool game = GENERATE(true, false);
    step::Settings s = settingsOfImpact(game);
    s.dampingRatio = 0.2;
    Ring ring(15);
    step::Stepper stepper(s);
    for (int i = 0; i < 240; ++i)
        ring.frame(stepper, 1.0 / 60.0);
    int lost = 0, turns = 0;
    double last = 0.0;
    const auto watch = [&](const step::World& w) { // each step, not each frame alone
        double force = 0.0;
        for (const step::ContactImpulse& c : w.impulses)
            force += c.normal;
        lost += force > 0.0 ? 0 : 1;
        const double v = w.rods[0].v[w.rods[0].model.dofY()]; // of its lowest point, against the floor
        turns += v * last < 0.0 && std::abs(v) > 1e-6 ? 1 : 0;
        last = v;
        return false;
    };
    for (int i = 0; i < 600; ++i) { // ten seconds
        REQUIRE(stepper.advance(ring.world, 1.0 / 60.0, &ring.host, watch).failure.empty());
        ring.host.step(1.0 / 60.0);
    }
    CAPTURE(game);
    CHECK(lost == 0);
    CHECK(turns < 4); // the end of its swing; a step that chatters turns in every frame
}

TEST_CASE("with contacts that keep their status the step is of second order", "[step][rebound]") {
    // A dome stands on its tips, which stick, and begins to swing in the shape of a load at its top.
    rod::RodDefinition d;
    d.thickness = 0.01;
    d.length = M_PI * 0.2;
    d.linearMass = 1.0;
    d.bendingModulus = 2.0;
    d.naturalCurvature.assign(6, 1.0 / 0.2); // with more arcs the fastest mode asks for shorter steps
    step::World world;
    FakeHost host;
    world.gravity = host.g = {0.0, -kG};
    host.addGround(1, 2.0);
    put(world, d, {0.0, 0.2 + 0.5 * d.thickness}, M_PI, 2.0);
    step::Settings s;
    s.dampingRatio = 0.3;
    step::Stepper rest(s);
    const auto settle = [&](step::World& w) {
        for (int i = 0; i < 300; ++i)
            frame(rest, w, host, 1.0 / 60.0);
    };
    settle(world);
    REQUIRE(world.impulses.size() == 2);
    step::World loaded = world;
    step::AppliedForce load;
    load.s = 0.5 * d.length;
    load.force = {0.0, -0.5};
    loaded.rods[0].forces.push_back(load);
    settle(loaded);
    const Eigen::VectorXd shape = loaded.rods[0].q - world.rods[0].q;
    const std::vector<step::ContactImpulse> forces = world.impulses;
    step::placeRod(world, 0, world.rods[0].q,
                   shape * (0.1 / (loaded.rods[0].kin.middle() - world.rods[0].kin.middle()).norm()));
    world.impulses = forces;
    const auto end = [&](double dt) {
        step::World w = world;
        step::Settings fixed;
        fixed.dtMin = fixed.dtMax = dt;
        fixed.localError = 1e-6; // no error is too small to be worth the second order
        fixed.freeError = 1e3;   // and none too large
        step::Stepper stepper(fixed);
        const int steps = static_cast<int>(std::lround(0.064 / dt));
        for (int i = 0; i < steps; ++i)
            frame(stepper, w, host, dt);
        CHECK(w.counters.steps - world.counters.steps == static_cast<std::uint64_t>(steps));
        return w.rods[0].q;
    };
    const Eigen::VectorXd q[] = {end(2.5e-4), end(1.25e-4), end(6.25e-5), end(3.125e-5)};
    const double coarse = (q[1] - q[0]).norm(), middle = (q[2] - q[1]).norm(), fine = (q[3] - q[2]).norm();
    CAPTURE(coarse, middle, fine);
    CHECK(coarse / middle > 3.2); // 4 for second order, 2 for first
    CHECK(middle / fine > 3.2);
}

TEST_CASE("a clamped strip that strikes a stop never gains energy", "[step][rebound]") {
    const bool game = GENERATE(true, false);
    step::Settings s = settingsOfImpact(game);
    s.dampingRatio = 0.0;
    rod::RodDefinition d;
    d.thickness = 0.007;
    d.length = 0.6;
    d.linearMass = 0.05;
    d.bendingModulus = 2.0;
    d.naturalCurvature.assign(16, 0.0);
    step::World world;
    FakeHost host;
    host.add(1, "stop", {0.5, -0.06}).outlines.push_back(FakeHost::box(1, 0.02, 0.05, 0.3)); // 6.5 mm below the strip
    put(world, d, {0.3, 0.0}, 0.0, 0.3);
    step::Rod& r = world.rods[0];
    step::Hold clamp;
    clamp.target.point = r.kin.point(rod::locate(r.model, 0, 0.0));
    r.holds.push_back(clamp);
    step::applyImpulse(world, 0, d.length, {0.0, -0.01}, 0.0);
    step::Stepper stepper(s);
    const double start = world.energyBalance.stored();
    double energy = start, lowest = 0.0;
    for (int i = 0; i < 240; ++i) {
        frame(stepper, world, host, 1.0 / 60.0);
        CHECK(world.energyBalance.stored() - energy < 1e-4 * start);
        energy = world.energyBalance.stored();
        lowest = std::min(lowest, r.kin.point(rod::locate(r.model, 0.5)).y());
    }
    CHECK(lowest < -0.0055); // it came near the stop
    CHECK(world.counters.activeContactsMax > 0);
    CHECK(lowest > -0.0065 - 0.02 * d.thickness); // the deepest overlap that a step may leave
    CHECK(std::abs(world.energyBalance.residual()) < 1e-9 * start);
    CHECK((r.kin.node(0) - clamp.target.point).norm() < 1e-4 * d.length);
}
