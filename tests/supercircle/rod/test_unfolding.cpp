// Type II snap on a cylinder: the tips stick, become tangent, and the shell rolls on them until friction gives way.
// Static, without contact detection: the contact point of the rolling branch is a pin that moves along rod and cylinder
// alike (s + psi = const, no slip), where the rod is tangent to the cylinder. The remaining error is that of N elements
// of uniform curvature.

#include "reference.h"
#include "supercircle/rod/equilibrium.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;

namespace {

/// Half opening angle `phi`, R = B = 1, cylinder of radius 1 about the origin.
class RollingShell {
public:
    RollingShell(int elements, double phi, double tipRefinement)
        : phi_(phi), model_(make(elements, phi, tipRefinement)), height_(1.0 - 2.0 * std::cos(phi)),
          q_(naturalShape(model_, Vec2(0.0, height_), M_PI)) {}

    struct State {
        double force = 0.0; ///< on the crown
        double ratio = 0.0; ///< friction up the cylinder over normal force
    };

    /// Lowers the crown until the pinned tips are tangent to the cylinder.
    void layDown() {
        while (lean() > 0.0) {
            height_ -= 0.02;
            solve(height_);
        }
    }

    /// Rolls to contact angle psi. The crown's height follows from tangency (secant method).
    State rollTo(double psi) {
        psi_ = psi;
        double h0 = height_, h1 = height_ - 0.02;
        solve(h0);
        double l0 = lean();
        for (int i = 0; i < 30; ++i) {
            solve(h1);
            const double l1 = lean();
            if (std::abs(l1) < 1e-8 || l1 == l0)
                break;
            const double h2 = h1 - l1 * (h1 - h0) / (l1 - l0);
            h0 = h1;
            l0 = l1;
            h1 = h2;
        }
        height_ = h1;
        const Vec2 up(-std::cos(psi), std::sin(psi)), out(std::sin(psi), std::cos(psi));
        const Vec2 f = last_.reactions[0].force;
        return {-last_.reactions[2].force.y(), f.dot(up) / f.dot(out)};
    }

    [[nodiscard]] double psiOfTips() const { return M_PI - phi_; }

private:
    static RodModel make(int elements, double phi, double tipRefinement) {
        RodDefinition d;
        d.length = 2.0 * phi;
        d.thickness = 1e-3;
        d.linearMass = d.bendingModulus = 1.0;
        d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0);
        d.elementLength = gradedLengths(d.length, elements, tipRefinement);
        return RodModel(d);
    }

    [[nodiscard]] double contactS() const { return psi_ - psiOfTips(); } ///< from the first tip

    void solve(double height) {
        const Vec2 right(std::sin(psi_), std::cos(psi_));
        EquilibriumProblem problem;
        problem.supports = {pin(contactS(), right), pin(2.0 * phi_ - contactS(), Vec2(-right.x(), right.y())),
                            clamp(phi_, Vec2(0.0, height), M_PI)};
        last_ = solveEquilibrium(model_, problem, q_);
        INFO("psi " << psi_ << ", height " << height << ": " << last_.failure);
        REQUIRE(last_.converged());
        q_ = last_.q;
    }

    /// Angle between rod and cylinder at the contact; 0: tangent.
    [[nodiscard]] double lean() const {
        Kinematics kin;
        kin.evaluate(model_, q_);
        return kin.angle(locate(model_, contactS())) + psi_;
    }

    double phi_;
    RodModel model_;
    double height_;
    double psi_ = M_PI - phi_;
    Eigen::VectorXd q_;
    Equilibrium last_;
};

/// Forces at which the friction needed on the rolling branch reaches each of `mus` (ascending).
std::vector<double> unfolding(RollingShell shell, const std::vector<double>& mus) {
    shell.layDown();
    std::vector<double> forces;
    const double step = 0.01; // the force is smooth in psi: interpolation errs by 1e-4
    double psi = shell.psiOfTips();
    RollingShell::State before = shell.rollTo(psi);
    while (forces.size() < mus.size() && psi < 0.8) {
        const RollingShell::State now = shell.rollTo(psi += step);
        while (forces.size() < mus.size() && now.ratio >= mus[forces.size()] && before.ratio < mus[forces.size()]) {
            const double w = (mus[forces.size()] - before.ratio) / (now.ratio - before.ratio);
            forces.push_back(before.force + w * (now.force - before.force));
        }
        before = now;
    }
    return forces;
}

} // namespace

TEST_CASE("shell on cylinder: unfolding of a rolling shell converges to the reference", "[reference]") {
    std::vector<double> mus, exact;
    for (const auto& row : reference::read("T2_typeII_unfold_threshold_coarse.csv")) {
        mus.push_back(row.at("mu"));
        exact.push_back(row.at("f_unfold_R2_over_B"));
    }
    // Second order in 1 / elements. The shell leaves the cylinder with zero moment and natural curvature. An element
    // that spans this point averages the moment over its length and misplaces its small rotation. Tip elements of a
    // third of the middle length halve this error, at the cost of the crown.
    for (const double refinement : {1.0, 3.0}) {
        double worst[3] = {};
        const int elements[] = {15, 31, 61};
        for (int k = 0; k < 3; ++k)
            for (const double phiBar : {0.87, 0.90, 0.93}) {
                const std::vector<double> f = unfolding(RollingShell(elements[k], M_PI * phiBar, refinement), mus);
                REQUIRE(f.size() == mus.size());
                for (std::size_t i = 0; i < f.size(); ++i)
                    worst[k] = std::max(worst[k], std::abs(f[i] / exact[i] - 1.0));
            }
        INFO("refinement " << refinement << ": " << worst[0] << ", " << worst[1] << ", " << worst[2]);
        const double bound = refinement == 1.0 ? 0.04 : 0.02;
        CHECK(worst[0] < bound);
        CHECK(worst[1] < bound / 4.0);
        CHECK(worst[2] < bound / 12.0);
    }
}
