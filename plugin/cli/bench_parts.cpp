#include "plugin/cli/bench.h"

#include "plugin/include/supercircle/definitions.hpp"
#include "supercircle/contact/crossing.h"
#include "supercircle/contact/detection.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"

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
        d.bendingModulus = bendingModulus(shell);
        d.naturalCurvature.assign(static_cast<std::size_t>(shell.elements), 1.0 / shell.radius);
        return d;
    }
    rod::RodModel model;
    Eigen::VectorXd q;
};

/// Everything a step evaluates about one rod before contact: curve, mass matrix, momentum, weight, bending.
Measurement measureRod() {
    const BentShell shell;
    rod::Kinematics kin;
    rod::GaussField gauss;
    Eigen::MatrixXd mass(shell.model.dofs(), shell.model.dofs());
    Eigen::VectorXd momentum(shell.model.dofs()), force(shell.model.dofs());
    const std::vector<Vec2> u(static_cast<std::size_t>(shell.model.gaussPoints()), Vec2(0.01, -0.02));
    return repeat("rod_evaluate", [&] {
        kin.evaluate(shell.model, shell.q);
        rod::evaluateGauss(shell.model, kin, gauss);
        rod::massMatrix(shell.model, kin, gauss, mass);
        rod::momentum(shell.model, kin, gauss, u, momentum);
        rod::uniformForce(shell.model, kin, gauss, Vec2(0.0, -9.81), force);
        rod::addBendingForce(shell.model, shell.q, force);
    });
}

/// Thirty shells in a box: ten columns of three, nested with their surfaces a few micrometres apart.
struct Pile {
    Pile() {
        const ShellDef shell;
        const double h = shell.thickness, R = shell.radius;
        for (std::uint32_t i = 0; i < 30; ++i) {
            const double radius = R * (1.0 + 0.01 * ((i * 7) % 5) - 0.02);
            const double opening = 2.0 * M_PI * shell.phi_bar, first = 0.5 * (M_PI - opening);
            const Vec2 centre((i % 10) * (2.0 * R + 1.05 * h), (i / 10) * 1.02 * h + 0.001 * (i % 3));
            contact::Curve curve;
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
        const Vec2 corners[] = {{-0.03, 0.5}, {-0.03, -0.02}, {0.5, -0.02}, {0.5, 0.5}};
        for (std::uint32_t i = 0; i < 3; ++i) {
            contact::Outline wall;
            wall.key = i;
            wall.points = {corners[i], corners[i + 1]};
            outlines.push_back(std::move(wall));
        }
    }
    /// A step of the pile: neighbours slide past each other, back and forth.
    void step(double distance) {
        direction = -direction;
        for (std::size_t i = 0; i < curves.size(); ++i) {
            curves[i].motion = distance;
            for (rod::Arc& arc : curves[i].arcs)
                arc.start += distance * direction * Vec2(i % 2 == 0 ? 0.6 : -0.6, 0.4);
        }
    }
    std::vector<contact::Curve> curves;
    std::vector<contact::Outline> outlines;
    double direction = 1.0;
};

Measurement measureDetection(bool warm) {
    Pile pile;
    std::vector<contact::Candidate> found;
    contact::Detector kept;
    Measurement m = repeat(warm ? "detection_warm" : "detection_cold", [&] {
        contact::Detector fresh;
        pile.step(1e-5);
        (warm ? kept : fresh).detect(pile.curves, pile.outlines, {}, found);
    });
    m.more = {{"shells", 30.0}, {"candidates", static_cast<double>(found.size())}};
    return m;
}

Measurement measureWitness(bool swept) {
    Pile pile;
    const Pile before = pile;
    pile.step(1e-5);
    std::vector<contact::Crossing> found;
    Measurement m = repeat(swept ? "crossing_witness_swept" : "crossing_witness", [&] {
        if (swept)
            contact::findCrossingsSwept(before.curves, pile.curves, before.outlines, pile.outlines, found);
        else
            contact::findCrossings(pile.curves, pile.outlines, found);
    });
    m.more = {{"shells", 30.0}};
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
    add("detection_cold", [] { return measureDetection(false); });
    add("detection_warm", [] { return measureDetection(true); });
    add("crossing_witness", [] { return measureWitness(false); });
    add("crossing_witness_swept", [] { return measureWitness(true); });
}

} // namespace supercircle::cli
