#include "plugin/bench/bench.h"

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/contact/crossing.h"
#include "supercircle/contact/detection.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/support/trig.h"

#include <cmath>
#include <memory>

namespace supercircle::cli {

namespace {

using rod::Vec2;

/// The paper's shell, bent a little unevenly.
struct BentShell {
    BentShell() : model(definition()), q(Eigen::VectorXd::Zero(model.dofs())) {
        const ShellDef shell;
        for (int i = 0; i < model.elements(); ++i)
            q[model.dofOfElement(i)] = (1.0 + 0.1 * std::sin(i)) / shell.radius;
    }
    static rod::RodDefinition definition() {
        const ShellDef shell;
        rod::RodDefinition d;
        d.length = 2.0 * M_PI * shell.phi_bar * shell.radius;
        d.thickness = shell.thickness;
        d.linearMass = shell.density * shell.width * shell.thickness;
        d.bendingModulus = bending_modulus(shell);
        d.naturalCurvature.assign(static_cast<std::size_t>(shell.elements), 1.0 / shell.radius);
        return d;
    }
    rod::RodModel model;
    Eigen::VectorXd q;
};

/// Evaluations of one rod in a step before contact: curve, mass matrix, momentum, weight, bending.
Measurement measureRod() {
    const BentShell shell;
    rod::Kinematics kin;
    rod::GaussField gauss;
    Eigen::MatrixXd mass(shell.model.dofs(), shell.model.dofs());
    Eigen::VectorXd momentum(shell.model.dofs()), force(shell.model.dofs());
    const std::vector<Vec2> u(static_cast<std::size_t>(shell.model.massPoints()), Vec2(0.01, -0.02));
    return repeat("rod_evaluate", [&] {
        kin.evaluate(shell.model, shell.q);
        rod::evaluateGauss(shell.model, kin, gauss);
        rod::massMatrix(shell.model, kin, gauss, mass);
        rod::momentum(shell.model, kin, gauss, u, momentum);
        rod::uniformForce(shell.model, kin, gauss, Vec2(0.0, -9.81), force);
        rod::addBendingForce(shell.model, shell.q, force);
    });
}

/// Shells in a box: columns of three, nested with their surfaces a few micrometres apart.
struct ShellColumns {
    explicit ShellColumns(std::uint32_t count = 30) {
        const std::uint32_t columns = count / 3;
        const ShellDef shell;
        const double h = shell.thickness, R = shell.radius;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double radius = R * (1.0 + 0.01 * ((i * 7) % 5) - 0.02);
            const double opening = 2.0 * M_PI * shell.phi_bar, first = 0.5 * (M_PI - opening);
            const Vec2 centre((i % columns) * (2.0 * R + 1.05 * h), (i / columns) * 1.02 * h + 0.001 * (i % 3));
            contact::RodCurve curve;
            curve.key = i;
            curve.halfThickness = 0.5 * h;
            curve.nodeS.push_back(0.0);
            const double length = radius * opening / shell.elements;
            for (int k = 0; k < shell.elements; ++k) {
                const double at = first + opening * k / shell.elements;
                curve.arcs.push_back(
                    {centre + radius * Vec2(std::cos(at), std::sin(at)), at + 0.5 * M_PI, 1.0 / radius, length});
                curve.nodeS.push_back(length * (k + 1));
            }
            curve.midS = 0.5 * curve.nodeS.back();
            curves.push_back(std::move(curve));
        }
        const double right = 0.05 * columns;
        const Vec2 corners[] = {{-0.03, 0.5}, {-0.03, -0.02}, {right, -0.02}, {right, 0.5}};
        for (std::uint32_t i = 0; i < 3; ++i) {
            contact::Outline wall;
            wall.key = i;
            wall.points = {corners[i], corners[i + 1]};
            outlines.push_back(std::move(wall));
        }
    }
    /// A step: neighbours slide past each other, back and forth; resting shells stay.
    void step(double distance) {
        direction = -direction;
        for (std::size_t i = 0; i < curves.size(); ++i) {
            if (curves[i].resting)
                continue;
            curves[i].motion = distance;
            for (rod::Arc& arc : curves[i].arcs)
                arc.start += distance * direction * Vec2(i % 2 == 0 ? 0.6 : -0.6, 0.4);
        }
    }
    std::vector<contact::RodCurve> curves;
    std::vector<contact::Outline> outlines;
    double direction = 1.0;
};

Measurement measureDetection(const std::string& name, std::uint32_t shells, bool warm, std::uint32_t awake) {
    ShellColumns pile(shells);
    for (std::uint32_t i = awake; i < shells; ++i)
        pile.curves[i].resting = true;
    std::vector<contact::Candidate> found;
    contact::Detector kept;
    Measurement m = repeat(name, [&] {
        contact::Detector fresh;
        pile.step(1e-5);
        (warm ? kept : fresh).detect(pile.curves, pile.outlines, {}, found);
    });
    m.more = {{"shells", shells}, {"awake", awake}, {"candidates", static_cast<double>(found.size())}};
    return m;
}

Measurement measureUpdate() {
    ShellColumns pile;
    std::vector<contact::Candidate> found;
    contact::Detector().detect(pile.curves, pile.outlines, {}, found);
    Measurement m = repeat("candidate_update", [&] {
        pile.step(1e-6);
        for (contact::Candidate& c : found)
            contact::updateCandidate(c, pile.curves, pile.outlines);
    });
    m.more = {{"shells", 30.0}, {"candidates", static_cast<double>(found.size())}};
    return m;
}

Measurement measureCrossingCheck(const std::string& name, std::uint32_t shells, bool swept, std::uint32_t awake) {
    ShellColumns pile(shells);
    for (std::uint32_t i = awake; i < shells; ++i)
        pile.curves[i].resting = true;
    const ShellColumns before = pile;
    pile.step(1e-5);
    std::vector<contact::Crossing> found;
    Measurement m = repeat(name, [&] {
        if (swept)
            contact::findCrossingsSwept(before.curves, pile.curves, before.outlines, pile.outlines, found);
        else
            contact::findCrossings(pile.curves, pile.outlines, found);
    });
    m.more = {{"shells", shells}, {"awake", awake}};
    return m;
}

/// A thousand sines and cosines, as for the tangents of elements.
Measurement measureSines() {
    std::vector<double> angles;
    for (int i = 0; i < 1000; ++i)
        angles.push_back(0.31 * i - 155.0);
    double sum = 0.0;
    Measurement m = repeat("sine_cosine_1000", [&] {
        for (const double angle : angles) {
            const math::SinCos a = math::sinCos(angle);
            sum += a.sine + a.cosine;
        }
    });
    m.more = {
        {"mean", sum / static_cast<double>(angles.size() * m.samples)}}; // keeps the compiler from removing the loop
    return m;
}

} // namespace

void addPartBenchmarks(std::vector<Benchmark>& all) {
    const auto add = [&](const std::string& name, const std::function<Measurement()>& measure) {
        all.push_back({{name}, false, [name, measure](const auto& wanted, const auto& done) {
                           if (wanted(name))
                               done(measure());
                           return std::string();
                       }});
    };
    add("rod_evaluate", measureRod);
    add("sine_cosine_1000", measureSines);
    const auto detection = [&](const std::string& name, std::uint32_t shells, bool warm, std::uint32_t awake) {
        add(name, [=] { return measureDetection(name, shells, warm, awake); });
    };
    detection("detection_cold", 30, false, 30);
    detection("detection_warm", 30, true, 30);
    detection("detection_warm_300", 300, true, 300);
    detection("detection_warm_1200", 1200, true, 1200);
    detection("detection_warm_300_asleep", 300, true, 10);
    add("candidate_update", measureUpdate);
    const auto crossingCheck = [&](const std::string& name, std::uint32_t shells, bool swept, std::uint32_t awake) {
        add(name, [=] { return measureCrossingCheck(name, shells, swept, awake); });
    };
    crossingCheck("crossing_check", 30, false, 30);
    crossingCheck("crossing_check_swept", 30, true, 30);
    crossingCheck("crossing_check_swept_300", 300, true, 300);
    crossingCheck("crossing_check_swept_1200", 1200, true, 1200);
    crossingCheck("crossing_check_swept_300_asleep", 300, true, 10);
}

} // namespace supercircle::cli
