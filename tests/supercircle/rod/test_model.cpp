#include "shapes.h"
#include "supercircle/rod/elasticity.h"

#include <catch2/catch.hpp>
#include <limits>
#include <set>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

TEST_CASE("validate accepts a valid definition and names what is wrong with an invalid one", "[model]") {
    RodDefinition good;
    good.naturalCurvature.assign(15, 52.0);
    CHECK(validate(good).empty());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    const auto message = [&](auto change) {
        RodDefinition d = good;
        change(d);
        return validate(d);
    };
    CHECK_THAT(message([](RodDefinition& d) { d.naturalCurvature.clear(); }), Catch::Contains("element"));
    for (const double bad : {0.0, -1.0, nan, infinite}) {
        INFO(bad);
        CHECK_THAT(message([&](RodDefinition& d) { d.length = bad; }), Catch::Contains("length"));
        CHECK_THAT(message([&](RodDefinition& d) { d.thickness = bad; }), Catch::Contains("thickness"));
        CHECK_THAT(message([&](RodDefinition& d) { d.linearMass = bad; }), Catch::Contains("mass"));
        CHECK_THAT(message([&](RodDefinition& d) { d.bendingModulus = bad; }), Catch::Contains("modulus"));
    }
    CHECK_THAT(message([&](RodDefinition& d) { d.thickness = d.length; }), Catch::Contains("thickness"));
    CHECK_THAT(message([&](RodDefinition& d) { d.naturalCurvature[3] = nan; }), Catch::Contains("curvature"));
    CHECK_THAT(message([&](RodDefinition& d) { d.naturalCurvature[14] = -infinite; }), Catch::Contains("curvature"));
    CHECK(message([](RodDefinition& d) { d.naturalCurvature.assign(1, 0.0); }).empty());
}

TEST_CASE("the coordinates are a permutation and the sides cover the rod", "[model]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        INFO("N = " << n);
        CHECK(model.dofs() == n + 3);
        std::set<int> used{model.dofX(), model.dofY(), model.dofTheta()};
        for (int i = 0; i < n; ++i)
            used.insert(model.dofOfElement(i));
        CHECK(static_cast<int>(used.size()) == n + 3);
        CHECK(*used.begin() == 0);
        CHECK(*used.rbegin() == n + 2);
        for (int side = 0; side < 2; ++side) {
            double s = model.midS();
            for (const Segment& seg : model.side(side)) {
                CHECK(seg.innerS == Approx(s).margin(1e-15));
                CHECK(seg.dof == model.dofOfElement(seg.element));
                CHECK((side == 0 ? seg.signedLength > 0.0 : seg.signedLength < 0.0));
                s += seg.signedLength;
            }
            CHECK(s == Approx(side == 0 ? model.definition().length : 0.0).margin(1e-14));
        }
    }
}

TEST_CASE("bending energy is zero at the natural shape, exact for arcs, and the force is its gradient", "[model]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        INFO("N = " << n);
        const double length = model.definition().length, B = model.definition().bendingModulus;
        Eigen::VectorXd q = Eigen::VectorXd::Constant(model.dofs(), 0.6);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(model.dofs());
        CHECK(bendingEnergy(model, q) == 0.0);
        addBendingForce(model, q, force);
        CHECK(force.norm() == 0.0);
        // Unrolled to uniform curvature k: 1/2 B L (k - k0)^2, whatever N and wherever the rod is.
        q.setConstant(2.6);
        CHECK(bendingEnergy(model, q) == Approx(0.5 * B * length * 4.0).epsilon(1e-14));
        q = shapesOf(model)[3].q;
        force.setConstant(0.25); // "adds"
        addBendingForce(model, q, force);
        for (int j = 0; j < model.dofs(); ++j) {
            const Eigen::VectorXd d = 1e-3 * Eigen::VectorXd::Unit(model.dofs(), j); // quadratic: no truncation error
            const double slope = (bendingEnergy(model, q + d) - bendingEnergy(model, q - d)) / 2e-3;
            CHECK(force[j] - 0.25 == Approx(-slope).margin(1e-11));
        }
    }
}
