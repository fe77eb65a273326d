// Shells that hang on mouse joints and touch nothing, against closed forms and invariants.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kDraggedFrame = 1.0 / 60.0; ///< s

step::Settings settingsOfDragged(bool game) {
    step::Settings s = game ? step::gameSettings() : step::Settings{};
    s.dampingRatio = 0.0; // games have some by default
    return s;
}

/// One that nothing touches.
std::size_t putDraggedStrip(step::World& w, const Vec2& middle, double angle, double modulus = 1e4) {
    const std::size_t i = put(w, metreStrip(modulus), middle, angle, 0.3);
    w.rods[i].mask = 0;
    return i;
}

step::MouseJoint jointAt(double s, const Vec2& target, double frequency, double dampingRatio = 0.0,
                         double maxForce = 1e9) {
    const double omega = 2.0 * M_PI * frequency; // of 1 kg
    step::MouseJoint m;
    m.s = s;
    m.target = target;
    m.stiffness = omega * omega;
    m.damping = 2.0 * dampingRatio * omega;
    m.maxForce = maxForce;
    return m;
}

/// With that of the springs of the mouse joints, J.
double energyWithMouseJoints(const step::World& w) {
    double e = mechanicalEnergy(w);
    for (const step::Rod& r : w.rods)
        for (const step::MouseJoint& m : r.mouseJoints)
            e += 0.5 * m.stiffness * (m.target - r.kin.point(rod::locate(r.model, m.s))).squaredNorm();
    return e;
}

} // namespace

TEST_CASE("a shell on a mouse joint swings as a mass on a spring does", "[step][joints]") {
    // x = a exp(-z w t) (cos(wd t) + z w / wd sin(wd t)), from 60 to 6 frames a period, over ten periods. Backward
    // Euler keeps 1e-5 of the energy at six frames a period.
    const bool game = GENERATE(false, true);
    const double frequency = GENERATE(1.0, 4.0, 10.0), damping = GENERATE(0.0, 0.02);
    CAPTURE(game, frequency, damping);
    constexpr double kAway = 0.1;
    step::World w;
    const std::size_t i = putDraggedStrip(w, {kAway, 0.0}, 0.5 * M_PI, 100.0 * frequency * frequency);
    w.rods[i].mouseJoints.push_back(jointAt(0.5, Vec2::Zero(), frequency, damping));
    step::Stepper stepper(settingsOfDragged(game));
    const double before = energyWithMouseJoints(w), omega = 2.0 * M_PI * frequency;
    while (w.time < 10.0 / frequency - 0.5 * kDraggedFrame)
        quietFrame(stepper, w);
    const double rate = damping * omega, swing = omega * std::sqrt(1.0 - damping * damping), t = w.time;
    const step::Rod& r = w.rods[i];
    const double x = centre(r).x(), v = momentum(w).x(); // of 1 kg
    const double amplitude = std::hypot(x, (v + rate * x) / swing) / std::hypot(kAway, rate * kAway / swing);
    const double phase =
        std::remainder(std::atan2(-(v + rate * x) / swing, x) + std::atan2(rate, swing) - swing * t, 2.0 * M_PI);
    const double beyond = 2.0 * std::log(amplitude) + 2.0 * rate * t; // of the energy, over what damping takes
    CHECK(beyond > std::log(game ? 0.90 : 0.99));
    CHECK(beyond < 1e-3 + (game ? 0.1 : 0.02) * 2.0 * rate * t); // as for other dampings
    CHECK(std::abs(phase) < (game ? 0.02 : 0.002) * swing * t);
    CHECK(std::abs(w.energyBalance.residual()) < 1e-12 * before);
}

TEST_CASE("a mouse joint of limited force pulls with it", "[step][joints]") {
    // Far from its target a constant force along a constant line: the scheme is exact.
    const bool game = GENERATE(false, true);
    step::World w;
    const std::size_t i = putDraggedStrip(w, Vec2::Zero(), 0.0, 100.0);
    w.rods[i].mouseJoints.push_back(jointAt(0.5, {0.0, 100.0}, 5.0, 0.7, 3.0));
    step::Stepper stepper(settingsOfDragged(game));
    for (int k = 0; k < 60; ++k)
        quietFrame(stepper, w);
    const double t = w.time;
    CHECK(centre(w.rods[i]).y() == Approx(0.5 * 3.0 * t * t).epsilon(1e-9));
    CHECK(momentum(w).y() == Approx(3.0 * t).epsilon(1e-9));
    CHECK(w.rods[i].mouseJoints[0].force.y() == Approx(3.0).epsilon(1e-12));
    // Past the end of a limit that acts at first it comes to rest where the spring has no stretch.
    w.rods[i].mouseJoints[0].maxForce = 300.0;
    w.rods[i].mouseJoints[0].target = {0.0, centre(w.rods[i]).y() + 0.5};
    for (int k = 0; k < 120; ++k)
        quietFrame(stepper, w);
    CHECK((centre(w.rods[i]) - w.rods[i].mouseJoints[0].target).norm() < 1e-6); // m, of a swing of metres
}

TEST_CASE("strips that swing on a mouse joint keep their energy", "[step][joints]") {
    const bool game = GENERATE(false, true);
    const int strips = GENERATE(1, 2);
    const double frequency = GENERATE(3.0, 30.0);
    CAPTURE(game, strips, frequency);
    const auto hang = [&](double angle) {
        step::World w;
        w.gravity = {0.0, -kG};
        const Vec2 along(std::sin(angle), -std::cos(angle));
        for (int k = 0; k < strips; ++k) {
            const std::size_t i = putDraggedStrip(w, (0.5 + k) * along, angle - 0.5 * M_PI);
            if (k == 0) {
                w.rods[i].mouseJoints.push_back(jointAt(0.0, Vec2::Zero(), frequency));
                continue;
            }
            step::Link l;
            l.key = w.nextPart++;
            l.kind = step::LinkKind::Pin;
            l.rodA = w.rods[i].key;
            l.end = step::LinkEnd::Rod;
            l.rodB = w.rods[i - 1].key;
            l.sB = 1.0;
            w.links.push_back(l);
        }
        return w;
    };
    step::World w = hang(1.0);
    const double swing = energyWithMouseJoints(w) - energyWithMouseJoints(hang(0.0));
    const double before = energyWithMouseJoints(w);
    step::Stepper stepper(settingsOfDragged(game));
    double most = before;
    for (int k = 0; k < 600; ++k) {
        quietFrame(stepper, w);
        most = std::max(most, energyWithMouseJoints(w));
    }
    CHECK(energyWithMouseJoints(w) - before > -(game ? 0.10 : 0.02) * swing);
    CHECK(most - before < 1e-3 * swing);
    CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * swing);
}

TEST_CASE("errors on a mouse joint fall by four when steps are halved", "[step][joints]") {
    const auto tip = [](double dt) {
        step::World w;
        w.gravity = {0.0, -kG};
        const std::size_t i = putDraggedStrip(w, {0.5, 0.0}, 0.0);
        w.rods[i].mouseJoints.push_back(jointAt(0.0, Vec2::Zero(), 1.0, 0.1));
        step::Settings s = settingsOfDragged(false);
        s.fixedDt = dt;
        step::Stepper stepper(s);
        for (int k = 0; k < 25; ++k)
            quietFrame(stepper, w, 0.016);
        return w.rods[i].kin.node(w.rods[i].model.elements());
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
