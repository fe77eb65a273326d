// Joined shells in motion: energy, period, momenta and gaps, against closed forms and invariants.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kFrame = 1.0 / 60.0; ///< s

/// Without the damping that games have by default.
step::Settings settingsOfJoints(bool game) {
    step::Settings s = game ? step::gameSettings() : step::Settings{};
    s.dampingRatio = 0.0;
    return s;
}

step::Link linkOf(step::World& w, std::size_t rod, double s, step::LinkKind kind = step::LinkKind::Pin) {
    step::Link l;
    l.key = w.nextPart++;
    l.kind = kind;
    l.rodA = w.rods[rod].key;
    l.sA = s;
    l.target.point = w.rods[rod].kin.point(rod::locate(w.rods[rod].model, s));
    return l;
}

/// Strips in one line that hangs at `angle`, each joined to the end of the one before, the first one pinned to the
/// world at the origin. They do not touch each other.
step::World chain(int strips, double angle, step::LinkKind kind = step::LinkKind::Pin, bool tied = true,
                  double modulus = 1e3) {
    step::World w;
    w.gravity = {0.0, -kG};
    const rod::RodDefinition d = metreStrip(modulus);
    const Vec2 along(std::sin(angle), -std::cos(angle));
    for (int i = 0; i < strips; ++i) {
        const std::size_t k = put(w, d, (0.5 + i) * along, angle - 0.5 * M_PI, 0.3);
        w.rods[k].mask = 0;
        if (i == 0 && !tied)
            continue;
        step::Link l = linkOf(w, k, 0.0, i > 0 ? kind : step::LinkKind::Pin);
        if (i > 0) {
            l.end = step::LinkEnd::Rod;
            l.rodB = w.rods[k - 1].key;
            l.sB = d.length;
        }
        w.links.push_back(l);
    }
    return w;
}

double angularMomentum(const step::World& w) {
    double sum = 0.0;
    for (const step::Rod& r : w.rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            sum += r.gauss.mass[g] * rod::cross(r.kin.middle() + r.gauss.arm[g], r.u[g]);
    return sum;
}

/// Largest distance of two joined points, m.
double widestGap(const step::World& w) {
    double gap = 0.0;
    for (const step::Link& l : w.links) {
        const auto at = [&](std::uint32_t key, double s) {
            const step::Rod& r = w.rods[static_cast<std::size_t>(step::rodIndex(w, key))];
            return r.kin.point(rod::locate(r.model, s));
        };
        const Vec2 other = l.end == step::LinkEnd::Rod ? at(l.rodB, l.sB) : l.target.point;
        const double apart = (at(l.rodA, l.sA) - other).norm();
        gap = std::max(gap, l.kind == step::LinkKind::Tether ? apart - l.length : apart);
    }
    return gap;
}

} // namespace

TEST_CASE("joined strips keep swinging and gain nothing", "[step][joints]") {
    // Backward Euler leaves 0.27 of the energy after 10 s. Here ten swings: 1 % of amplitude in laboratory quality.
    const bool game = GENERATE(false, true);
    const int strips = GENERATE(1, 2, 3);
    const step::LinkKind kind = GENERATE(step::LinkKind::Pin, step::LinkKind::Weld);
    for (const double angle : {0.1, 0.5, 1.5}) {
        INFO((game ? "game" : "laboratory")
             << ", strips " << strips << ", kind " << static_cast<int>(kind) << ", angle " << angle);
        step::World w = chain(strips, angle, kind);
        const double least = mechanicalEnergy(chain(strips, 0.0, kind)), before = mechanicalEnergy(w);
        step::Stepper stepper(settingsOfJoints(game));
        double most = 0.0, gap = 0.0;
        for (int i = 0; i < static_cast<int>(1000.0 * std::sqrt(strips)); ++i) {
            quietFrame(stepper, w);
            most = std::max(most, (mechanicalEnergy(w) - least) / (before - least));
            gap = std::max(gap, widestGap(w));
        }
        const double left = (mechanicalEnergy(w) - least) / (before - least);
        CHECK(left > (game ? 0.90 : 0.98));
        CHECK(most < 1.0 + 1e-3);
        CHECK(gap < 1e-7); // m, of strips of 1 m: what the projection leaves, and a thousandth of what is drawn
        CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * (before - least));
    }
}

TEST_CASE("joined strips whose material stores energy take as many steps as plain ones", "[step][joints]") {
    // What a spring of the material or a branch gives back is no energy that the step brings in. Counted as such, it
    // cuts the strips' own steps to their shortest.
    const bool game = GENERATE(false, true);
    effects::Model branch, stiffer;
    branch.material.branches.push_back({0.3, 1000.0}); // s: it relaxes by a hundredth
    effects::Profile flat;
    flat.shape = effects::Profile::Shape::Flat;
    flat.width = 10.0;
    flat.stiffness = 0.3;
    stiffer.material.profiles.push_back(flat);
    const auto workOf = [&](const effects::Model& model) {
        step::World w = chain(3, 1.5);
        for (std::size_t i = 0; i < w.rods.size(); ++i)
            step::setEffects(w, i, model);
        step::Stepper stepper(settingsOfJoints(game));
        double work = 0.0;
        for (int i = 0; i < 300; ++i) {
            const step::FrameResult out = stepper.advance(w, kFrame, nullptr, {});
            REQUIRE(out.failure.empty());
            CHECK(out.gained == 0.0);
            work += out.work;
        }
        return work;
    };
    const double plain = workOf({}), withBranch = workOf(branch), withSpring = workOf(stiffer);
    CAPTURE(game, plain, withBranch, withSpring);
    // 30 % stiffer strips have frequencies higher by the root of it, and as many more steps. The wrong count: a third.
    CHECK(withBranch < 1.14 * plain);
    CHECK(withSpring < 1.14 * plain);
}

TEST_CASE("a pinned strip has the period of a pendulum", "[step][joints]") {
    // 4 K(sin(A/2)) sqrt(2 L / 3 g); the bending of the strip adds the square of its frequencies' ratio, 6e-5.
    const bool game = GENERATE(false, true);
    for (const double angle : {0.1, 0.5, 1.5}) {
        step::World w = chain(1, angle);
        step::Stepper stepper(settingsOfJoints(game));
        double last = angle, first = 0.0, end = 0.0;
        int passes = 0;
        while (passes < 11) {
            const double before = w.time;
            quietFrame(stepper, w);
            const Vec2 c = centre(w.rods[0]);
            const double now = std::atan2(c.x(), -c.y());
            if (last > 0.0 && now <= 0.0) { // downwards through the middle, once a period
                const double t = before + (w.time - before) * last / (last - now);
                (passes == 0 ? first : end) = t;
                ++passes;
            }
            last = now;
        }
        const double period = 4.0 * std::comp_ellint_1(std::sin(0.5 * angle)) * std::sqrt(2.0 / (3.0 * kG));
        INFO((game ? "game" : "laboratory") << ", angle " << angle);
        CHECK((end - first) / 10.0 == Approx(period).epsilon(game ? 0.02 : 0.002));
    }
}

TEST_CASE("errors of joined strips fall by four when steps are halved", "[step][joints]") {
    // Strips so stiff that they move as rigid bodies: what bends is far smaller than the errors of the swing.
    const auto tip = [](double dt) {
        step::World w = chain(2, 1.0, step::LinkKind::Pin, true, 1e6);
        step::Settings s = settingsOfJoints(false);
        s.fixedDt = dt;
        step::Stepper stepper(s);
        for (int i = 0; i < 25; ++i)
            REQUIRE(stepper.advance(w, 0.016, nullptr, std::function<bool(const step::World&)>{}).failure.empty());
        return w.rods[1].kin.node(w.rods[1].model.elements());
    };
    const Vec2 exact = tip(0.25e-3);
    double last = 0.0;
    for (const double dt : {16e-3, 8e-3, 4e-3, 2e-3}) {
        const double error = (tip(dt) - exact).norm();
        if (last > 0.0)
            CHECK(last / error == Approx(4.0).epsilon(0.15));
        last = error;
    }
}

TEST_CASE("strips that spin about a pin keep their angular momentum", "[step][joints]") {
    const bool game = GENERATE(false, true), tied = GENERATE(true, false);
    const int strips = GENERATE(1, 2);
    if (strips == 1 && !tied)
        return;
    step::World w = chain(strips, 0.0, step::LinkKind::Pin, tied);
    w.gravity.setZero();
    for (std::size_t i = 0; i < w.rods.size(); ++i) { // 3 rad/s about the origin, the second strip 1 rad/s slower
        step::Rod& r = w.rods[i];
        Eigen::VectorXd v = r.v;
        const double spin = i == 0 ? 3.0 : 2.0;
        v[r.model.dofTheta()] = spin;
        v.segment<2>(r.model.dofX()) = i == 0 ? Vec2(1.5, 0.0) : Vec2(4.0, 0.0);
        step::placeRod(w, i, r.q, v);
    }
    step::Stepper stepper(settingsOfJoints(game));
    const double before = angularMomentum(w), energy = mechanicalEnergy(w);
    const Vec2 drift = momentum(w);
    for (int i = 0; i < 600; ++i)
        quietFrame(stepper, w);
    CHECK(angularMomentum(w) == Approx(before).epsilon(game ? 0.02 : 1e-4));
    CHECK(mechanicalEnergy(w) < energy * (1.0 + 1e-3));
    if (!tied)
        CHECK((momentum(w) - drift).norm() < 1e-9 * drift.norm());
}

TEST_CASE("a joint that breaks lets the strip go as it moves", "[step][joints]") {
    // At the bottom the pin holds m g (1 + 3/2 (1 - cos A)) = 23 N for A = 1.5 rad, m g / 4 at the start.
    const bool game = GENERATE(false, true);
    step::World w = chain(1, 1.5);
    w.links[0].maxForce = 15.0;
    step::Stepper stepper(settingsOfJoints(game));
    const double before = mechanicalEnergy(w), least = mechanicalEnergy(chain(1, 0.0));
    bool broke = false;
    double spin = 0.0;
    const auto aboutCentre = [&] { return angularMomentum(w) - rod::cross(centre(w.rods[0]), momentum(w)); };
    for (int i = 0; i < 60; ++i) {
        const step::FrameResult out = stepper.advance(w, kFrame, nullptr, std::function<bool(const step::World&)>{});
        REQUIRE(out.failure.empty());
        CHECK(out.gained == 0.0);
        CHECK(std::abs(mechanicalEnergy(w) - before) < (game ? 1e-2 : 1e-3) * (before - least));
        if (w.links.empty() && !broke)
            spin = aboutCentre();
        broke = w.links.empty();
    }
    REQUIRE(broke);
    CHECK(aboutCentre() == Approx(spin).epsilon(1e-9)); // free motion keeps it to round-off
}

TEST_CASE("a tether goes slack and taut and brings in nothing", "[step][joints]") {
    const bool game = GENERATE(false, true);
    step::World w;
    w.gravity = {0.0, -kG};
    put(w, metreStrip(1e3), {0.3, 0.0}, 0.0, 0.3);
    step::Link l = linkOf(w, 0, 0.2, step::LinkKind::Tether);
    l.target.point = {0.0, 0.4};
    l.length = l.goal = 0.8;
    w.links.push_back(l);
    step::Stepper stepper(settingsOfJoints(game));
    double energy = mechanicalEnergy(w), gap = 0.0;
    const double least = -0.7 * kG; // hanging straight down: 0.8 m less 0.4 m, and 0.3 m to its middle
    const double allowed = 1e-3 * (energy - least);
    int taut = 0, slack = 0;
    for (int i = 0; i < 900; ++i) {
        quietFrame(stepper, w);
        CHECK(mechanicalEnergy(w) < energy + allowed);
        energy = std::min(energy, mechanicalEnergy(w));
        gap = std::max(gap, widestGap(w));
        (w.links[0].force.isZero(0.0) ? slack : taut) += 1;
    }
    CHECK(taut > 100);
    CHECK(slack > 10);
    CHECK(gap < 0.02 * 0.02 * 1.5); // h, as LinkGap allows
}
