// The rod against solved references (elastica by shooting or elliptic integrals, to 1e-5 or better). Units of the
// references: B = 1 and R = 1 or L = 1. The remaining error is that of N elements of uniform curvature, of second
// order.

#include "reference.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/equilibrium.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/support/dense.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <cmath>
#include <iomanip>

using namespace supercircle::rod;

namespace {

RodModel unitRod(int elements, double length, double naturalCurvature, bool closed = false) {
    RodDefinition d;
    d.length = length;
    d.thickness = 1e-3 * length;
    d.linearMass = 1.0;
    d.bendingModulus = 1.0;
    d.closed = closed;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), naturalCurvature);
    return RodModel(d);
}

Vec2 pointOfReference(const RodModel& model, const Eigen::VectorXd& q, double s) {
    Kinematics kin;
    kin.evaluate(model, q);
    return kin.point(locate(model, s));
}

double angleOf(const RodModel& model, const Eigen::VectorXd& q, double s) {
    Kinematics kin;
    kin.evaluate(model, q);
    return kin.angle(locate(model, s));
}

/// Natural shape moved so that the section at s sits at the origin with the given angle.
Eigen::VectorXd naturalFrom(const RodModel& model, double s, double angle) {
    Eigen::VectorXd q = naturalShape(model);
    q = naturalShape(model, Vec2::Zero(), angle - angleOf(model, q, s));
    return naturalShape(model, -pointOfReference(model, q, s), q[model.dofTheta()]);
}

struct CantileverError {
    double tip = 0.0;       ///< distance to the reference tip over L
    double component = 0.0; ///< the worse of x and drop, each relative to itself
    double angle = 0.0;     ///< rad
};

/// Solves row after row of the table, each started from the row before. Returns the errors of each row.
std::vector<CantileverError> cantilever(const std::string& file, int elements, double largestGamma) {
    std::vector<CantileverError> errors;
    const auto rows = reference::read(file);
    const RodModel model = unitRod(elements, 1.0, -rows[0].at("c_kappa0L"));
    Eigen::VectorXd q = naturalFrom(model, 0.0, 0.0);
    for (const auto& row : rows) {
        if (row.at("Gamma") > largestGamma * 1.001)
            break;
        EquilibriumProblem problem;
        problem.gravity = Vec2(0.0, -row.at("Gamma"));
        problem.supports = {clamp(0.0, Vec2::Zero(), 0.0)};
        const Equilibrium e = solveEquilibrium(model, problem, q);
        INFO(file << ", Gamma " << row.at("Gamma") << ": " << e.failure);
        REQUIRE(e.converged());
        CHECK(e.reactions[0].force.y() == Approx(row.at("Gamma")).epsilon(1e-9)); // the clamp carries the weight
        q = e.q;
        const Vec2 tip = pointOfReference(model, q, 1.0);
        const Vec2 exact(row.at("x_tip_over_L"), -row.at("drop_tip_over_L"));
        const Vec2 relative = (tip - exact).cwiseQuotient(exact).cwiseAbs();
        const double angle = angleOf(model, q, 1.0) + row.at("tip_angle_deg") * M_PI / 180.0;
        errors.push_back({(tip - exact).norm(), relative.maxCoeff(), std::abs(angle)});
    }
    return errors;
}

/// Frequencies of small vibrations about the natural shape, with optional clamping of the first tip; rigid motions
/// first.
Eigen::VectorXd frequencies(const RodModel& model, bool clamped) {
    const Eigen::VectorXd q = naturalShape(model);
    Kinematics kin;
    kin.evaluate(model, q);
    GaussField field;
    evaluateGauss(model, kin, field);
    Eigen::MatrixXd M;
    massMatrix(model, kin, field, M);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs()); // no stress, no geometric stiffness
    addBendingStiffness(model, 1.0, K);
    Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(model.dofs(), model.dofs());
    if (clamped) {
        Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
        Eigen::RowVectorXd angle(model.dofs());
        kin.pointRows(model, locate(model, 0.0), Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
        kin.angleRow(model, locate(model, 0.0), angle);
        Eigen::MatrixXd G(3, model.dofs());
        G << rows, angle;
        Z = supercircle::dense::nullSpaceBasis(G);
    }
    const Eigen::LLT<Eigen::MatrixXd> mass(Z.transpose() * M * Z);
    const Eigen::MatrixXd scale = mass.matrixL().solve(Z.transpose()).transpose(); // scale' M scale = 1
    return supercircle::dense::symmetricEigenvalues(scale.transpose() * K * scale).cwiseMax(0.0).cwiseSqrt();
}

/// A stress-free arch of unit radius, its crown pushed down by `drop`; symmetric by the supports on the crown.
struct Arch {
    RodModel model;
    bool clamped;
    double half;

    Arch(int elements, double halfAngle, bool clampedFeet)
        : model(unitRod(elements, 2.0 * halfAngle, -1.0)), clamped(clampedFeet), half(halfAngle) {}

    [[nodiscard]] Eigen::VectorXd start() const { return naturalShape(model, Vec2(0.0, 1.0), 0.0); }
    [[nodiscard]] Equilibrium solve(double drop, const Eigen::VectorXd& from, bool symmetric) const {
        EquilibriumProblem problem;
        const Vec2 right(std::sin(half), std::cos(half)), left(-right.x(), right.y());
        problem.supports = {
            pin(0.0, left), pin(2.0 * half, right), {half, symmetric, true, symmetric, {0.0, 1.0 - drop}}};
        if (clamped) {
            problem.supports[0] = clamp(0.0, left, half);
            problem.supports[1] = clamp(2.0 * half, right, -half);
        }
        Equilibrium e = solveEquilibrium(model, problem, from);
        INFO("drop " << drop << ": " << e.failure);
        REQUIRE(e.converged());
        return e;
    }
};

} // namespace

TEST_CASE("gravity sag: heavy cantilevers, straight and naturally curved, at 15 elements", "[reference]") {
    // The clamp's boundary layer is Gamma^(-1/2) L thick: 1.5 elements at Gamma = 100, where the error slightly exceeds
    // 0.2 % of L.
    for (const char* file :
         {"T4_cantilever_straight_coarse.csv", "T4_cantilever_c+1.000.csv", "T4_cantilever_c-1.000.csv"})
        for (const double gamma : {50.0, 100.0}) {
            double tip = 0.0, angle = 0.0;
            for (const CantileverError& e : cantilever(file, 15, gamma)) {
                tip = std::max(tip, e.tip);
                angle = std::max(angle, e.angle);
            }
            INFO(file << " up to Gamma = " << gamma << ": tip " << tip << " L, angle " << angle << " rad");
            CHECK(tip < (gamma > 50.0 ? 0.003 : 0.002));
            CHECK(angle < 0.002);
        }
}

TEST_CASE("gravity sag: a very heavy cantilever, Gamma = 1000", "[reference]") {
    // The boundary layer, Gamma^(-1/2) L = 0.03 L, is half an element at N = 15: the tip is accurate to one per cent of
    // L.
    const auto coarse = cantilever("T4_cantilever_straight_coarse.csv", 15, 1000.0);
    const auto fine = cantilever("T4_cantilever_straight_coarse.csv", 60, 1000.0);
    CHECK(coarse.back().tip < 0.01);
    CHECK(fine.back().tip < 0.001);
}

TEST_CASE("gravity sag: the tip converges with second order or faster in the number of elements", "[reference]") {
    for (const char* file : {"T4_cantilever_straight_coarse.csv", "T4_cantilever_c+1.000.csv"}) {
        std::vector<double> error;
        for (const int n : {8, 16, 32, 64})
            error.push_back(cantilever(file, n, 10.0).back().tip);
        for (std::size_t i = 0; i + 1 < error.size(); ++i) {
            const double slope = std::log2(error[i] / error[i + 1]);
            INFO(file << ": errors " << error[i] << " -> " << error[i + 1]);
            CHECK(slope > 1.8); // 3 in the end: what is left comes from the clamped end
        }
        CHECK(error[1] < 5e-5); // 16 elements; 4e-4 without what neighbours take from each other
    }
}

TEST_CASE("gravity sag: frequencies of free and clamped arcs", "[reference]") {
    // A tenth of a per cent with 15 elements for two modes, a fifth for the third (11 rad of wave on 15 elements), and
    // a fourth of that at least with twice as many: free ends converge with fourth order, clamped ones with third.
    for (const auto& row : reference::read("T4_frequencies_arc_share.csv")) {
        const bool clamped = row.at("bc(0 free-free,1 clamped-free)") == 1.0;
        const double phi = row.at("Phi_over_2pi");
        const int rigid = clamped ? 0 : 3;
        const Eigen::VectorXd omega = frequencies(unitRod(15, 2.0 * M_PI * phi, 1.0), clamped);
        const Eigen::VectorXd finer = frequencies(unitRod(30, 2.0 * M_PI * phi, 1.0), clamped);
        if (!clamped)
            CHECK(omega[2] < 1e-4 * omega[3]);
        for (int mode = 0; mode < 3; ++mode) {
            const double exact = row.at("omega" + std::to_string(mode + 1) + "_R2_sqrt(lambda/B)");
            const double error = omega[rigid + mode] / exact - 1.0;
            INFO("Phi_bar " << phi << (clamped ? " clamped-free" : " free-free") << ", mode " << mode + 1 << ": "
                            << omega[rigid + mode] << " against " << exact);
            const double bound = mode < 2 ? 0.001 : 0.002;
            CHECK(std::abs(error) < bound);
            CHECK(std::abs(finer[rigid + mode] / exact - 1.0) < 0.25 * bound);
        }
    }
}

TEST_CASE("statics: Euler post-buckling of a pinned strip", "[reference]") {
    for (const int elements : {15, 30}) {
        const RodModel model = unitRod(elements, 1.0, 0.0);
        Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dofs()); // flat; bent a little to choose the side
        q.head(elements).setConstant(-0.1);
        for (const auto& row : reference::read("T6_euler_pinned.csv")) {
            const double shortening = row.at("end_shortening_over_L");
            EquilibriumProblem problem;
            problem.supports = {pin(0.0, Vec2::Zero()), pin(1.0, Vec2(1.0 - shortening, 0.0))};
            const Equilibrium e = solveEquilibrium(model, problem, q);
            INFO("N = " << elements << ", slope " << row.at("tip_slope_deg") << " deg: " << e.failure);
            REQUIRE(e.converged());
            q = e.q;
            // At 165 degrees the loop's crown has a radius of 1.4 elements of 15: 1.5 %.
            const double bound = elements == 15 && row.at("tip_slope_deg") > 160.0 ? 0.02 : 0.01;
            const double load = row.at("P_over_Pcr") * M_PI * M_PI;
            CHECK(std::abs(-e.reactions[1].force.x() / load - 1.0) < bound);
            CHECK(std::abs(q[model.dofY()] / row.at("mid_deflection_over_L") - 1.0) < bound);
            // The shape is stable until the pins meet (shortening = L, 130.7 degrees), where the loop can rotate freely
            // about them. Beyond that it is unstable.
            CHECK((e.smallestStiffness > 0.0) == (shortening < 1.0));
        }
    }
}

TEST_CASE("statics: clamped and pinned arches, symmetric branch under prescribed crown drop", "[reference]") {
    // Piecewise constant curvatures are too stiff, by 3 % (pinned) to 7 % (clamped) of the load with 16 elements,
    // because the moment is steep under the point load. The error is of second order. Required: 1 % with 64 elements,
    // 0.1 % after extrapolation from 32 and 64.
    for (const int degrees : {30, 90})
        for (const bool clamped : {false, true}) {
            const std::string name =
                std::string(clamped ? "clamped" : "pinned") + "_half" + std::to_string(degrees) + ".0deg";
            const auto rows = reference::read("T6_arch_" + name + ".csv");
            const Arch arches[] = {{16, degrees * M_PI / 180.0, clamped},
                                   {32, degrees * M_PI / 180.0, clamped},
                                   {64, degrees * M_PI / 180.0, clamped}};
            Eigen::VectorXd q[] = {arches[0].start(), arches[1].start(), arches[2].start()};
            double end = 0.0; // the drop stops being a parameter of the branch where it turns back
            for (const auto& row : rows)
                end = std::max(end, row.at("crown_drop_over_R"));
            double scale = 0.0, coarse = 0.0, fine = 0.0, extrapolated = 0.0;
            for (std::size_t i = 0; i < rows.size() && rows[i].at("crown_drop_over_R") < 0.97 * end; i += 12) {
                const double exact = rows[i].at("P_R2_over_B");
                double load[3] = {};
                for (int k = 0; k < 3; ++k) {
                    const Equilibrium e = arches[k].solve(rows[i].at("crown_drop_over_R"), q[k], true);
                    q[k] = e.q;
                    load[k] = -e.reactions[2].force.y();
                }
                scale = std::max(scale, std::abs(exact));
                coarse = std::max(coarse, std::abs(load[0] - exact));
                fine = std::max(fine, std::abs(load[2] - exact));
                extrapolated = std::max(extrapolated, std::abs((4.0 * load[2] - load[1]) / 3.0 - exact));
            }
            INFO(name << ", largest load " << scale);
            CHECK(coarse / scale < 0.15);
            CHECK(fine / scale < 0.01);
            CHECK(extrapolated / scale < 0.001);
        }
}

TEST_CASE("statics: arches lose symmetry at the reference's bifurcation", "[reference]") {
    for (const auto& row : reference::read("T6_arch_summary_share.csv")) {
        if (!std::isfinite(row.at("P_bif_asym")))
            continue;
        const Arch arch(64, row.at("half_angle_deg") * M_PI / 180.0, row.at("bc(0 pinned,1 clamped)") == 1.0);
        // Walk along the symmetric branch; the asymmetric mode leaves the crown's height alone, so with only that held
        // the smallest stiffness changes sign.
        double below = 0.0, above = 0.0;
        Eigen::VectorXd q = arch.start();
        const double target = row.at("d_bif");
        for (double drop = 0.1 * target; drop < 2.0 * target && above == 0.0; drop += 0.1 * target) {
            const Equilibrium e = arch.solve(drop, q, true);
            const Equilibrium released = arch.solve(drop, e.q, false);
            (released.smallestStiffness > 0.0 ? below : above) = drop;
            q = e.q;
        }
        REQUIRE(above > 0.0);
        for (int i = 0; i < 25; ++i) {
            const double drop = 0.5 * (below + above);
            const Equilibrium e = arch.solve(drop, q, true);
            (arch.solve(drop, e.q, false).smallestStiffness > 0.0 ? below : above) = drop;
        }
        const Equilibrium e = arch.solve(below, q, true);
        INFO("half angle " << row.at("half_angle_deg") << ", bc " << row.at("bc(0 pinned,1 clamped)") << ": drop "
                           << below << " against " << target);
        CHECK(std::abs(-e.reactions[2].force.y() / row.at("P_bif_asym") - 1.0) < 0.01);
    }
}

TEST_CASE("plates: C-shape between plates", "[reference]") {
    // Beyond the tangent contact at s_c the rod is unstressed and nothing but f acts: a rod cut at s_c with f on its
    // tips.
    for (const auto& row : reference::read("T5B_C_shape.csv")) {
        const double sc = row.at("s_contact_over_R"), f = row.at("fR2_over_B");
        const RodModel model = unitRod(16, 2.0 * sc, 1.0);
        EquilibriumProblem problem;
        problem.supports = {clamp(sc, Vec2::Zero(), 0.5 * M_PI)};
        problem.pointLoads = {{0.0, Vec2(0.0, f)}, {2.0 * sc, Vec2(0.0, -f)}};
        const Equilibrium e = solveEquilibrium(model, problem, naturalShape(model, Vec2::Zero(), 0.5 * M_PI));
        INFO("f = " << f << ": " << e.failure);
        REQUIRE(e.converged());
        const double height = pointOfReference(model, e.q, 2.0 * sc).y() - pointOfReference(model, e.q, 0.0).y();
        CHECK(std::abs(height / row.at("H_over_R") - 1.0) < 0.01);
        CHECK(std::abs(angleOf(model, e.q, 2.0 * sc) - M_PI) < 0.02); // the contact is tangent
        CHECK(e.reactions[0].force.norm() < 1e-9 * (1.0 + f));        // the crown carries nothing
    }
}

TEST_CASE("plates: closed ring squeezed between plates", "[reference]") {
    // Two point loads and a moment between -0.64 and 0.36 f/2. The relative error of the stiffness is about
    // h^2/12 (integral of M'^2) / (integral of M^2) = 0.43 h^2 R^-2 = 0.4 % with 64 elements, 7.6 % with 15.
    const int elements = 64;
    const RodModel ring = unitRod(elements, 2.0 * M_PI, 1.0, true);
    Eigen::VectorXd q = naturalShape(ring, Vec2::Zero(), M_PI); // the top; the joint is at the bottom
    for (const auto& row : reference::read("T5C_closed_ring.csv")) {
        const double height = row.at("H_over_R"), f = row.at("fR2_over_B"), flat = row.at("flat_half_length_over_R");
        if (flat == 0.0) { // point contacts
            EquilibriumProblem problem;
            problem.supports = {{0.0, true, true, true, Vec2::Zero(), 0.0},
                                {M_PI, true, true, false, Vec2(0.0, height)}};
            const Equilibrium e = solveEquilibrium(ring, problem, q);
            INFO("H = " << height << ": " << e.failure);
            REQUIRE(e.converged());
            q = e.q;
            CHECK(std::abs(-e.reactions[1].force.y() - f) < 0.01 * std::max(f, 0.1));
        } else {
            // Flats: a quarter, from the edge of the flat to the equator. Not the whole flank: where the curvature at
            // both edges is zero an asymmetric solution branches off, and its discrete counterpart appears first.
            const double length = 0.5 * M_PI - flat;
            const RodModel quarter = unitRod(elements / 4, length, 1.0);
            EquilibriumProblem problem;
            problem.supports = {clamp(0.0, Vec2::Zero(), 0.0),
                                {length, false, true, true, {0.0, 0.5 * height}, 0.5 * M_PI}};
            const Equilibrium e = solveEquilibrium(quarter, problem, naturalFrom(quarter, 0.0, 0.0));
            INFO("H = " << height << ": " << e.failure);
            REQUIRE(e.converged());
            CHECK(std::abs(-2.0 * e.reactions[1].force.y() / f - 1.0) < 0.01);
            // No moment step at the edge of the flat, where it is that of a straightened rod: B/R.
            CHECK(std::abs(e.reactions[0].moment - 1.0) < 0.01 * std::sqrt(f));
        }
    }
}
