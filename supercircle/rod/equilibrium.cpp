// Newton's method on the Karush-Kuhn-Tucker system, damped on the residual (decision 0121). The matrix is symmetric and
// indefinite. LU with full pivoting is cheap at this size (n about 20) and reveals the rank: consistent redundant
// supports are harmless, contradicting ones are reported.

#include "supercircle/rod/equilibrium.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/geometric_stiffness.h"
#include "supercircle/support/dense.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supercircle::rod {

namespace {

/// One scalar equation: a component of the position of a point, or an angle, or the difference of two of either.
struct Equation {
    enum class Component { x, y, angle };
    Component kind = Component::x;
    MaterialPoint point;
    Vec2 section = Vec2::Zero();
    bool joined = false; ///< minus the same quantity at `other`
    MaterialPoint other;
    double target = 0.0;
    double initial = 0.0; ///< value at the start of the ramp
};

Vec2 offsetOf(const Kinematics& kin, const MaterialPoint& at, const Vec2& section) {
    if (section.isZero())
        return Vec2::Zero();
    const double a = kin.angle(at);
    const Vec2 t(math::cos(a), math::sin(a));
    return section.x() * t + section.y() * perp(t);
}

Vec2 axis(Equation::Component kind) {
    return kind == Equation::Component::x ? Vec2(1.0, 0.0) : Vec2(0.0, 1.0);
}

class System {
public:
    System(const RodModel& model, const EquilibriumProblem& problem) : model_(model), problem_(problem) {
        const double L = model.definition().length;
        const double B = model.definition().bendingModulus;
        forceUnit_ = B / (L * L);
        scale_ = Eigen::VectorXd::Constant(model.dofs(), 1.0 / L);
        scale_[model.dofX()] = scale_[model.dofY()] = L;
        scale_[model.dofTheta()] = 1.0;
        listEquations();
        equationScale_.resize(count());
        for (int i = 0; i < count(); ++i)
            equationScale_[i] = equations_[static_cast<std::size_t>(i)].kind == Equation::Component::angle ? 1.0 : L;
    }

    [[nodiscard]] int count() const { return static_cast<int>(equations_.size()); }
    [[nodiscard]] int unknowns() const { return model_.dofs() + count(); }

    void begin(const Eigen::VectorXd& q) {
        kin_.evaluate(model_, q);
        for (Equation& e : equations_)
            e.initial = value(e);
    }

    /// Dimensionless residual [total generalised force; equations] at load fraction t, and the Jacobian G (scaled).
    Eigen::VectorXd residual(const Eigen::VectorXd& q, const Eigen::VectorXd& multipliers, double t) {
        const int n = model_.dofs();
        kin_.evaluate(model_, q);
        evaluateGauss(model_, kin_, field_);
        Eigen::VectorXd force;
        uniformForce(model_, kin_, field_, t * problem_.gravity, force);
        addBendingForce(model_, q, force);
        Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, n);
        for (const PointLoad& f : problem_.pointLoads) {
            const MaterialPoint at = locate(model_, f.s);
            kin_.pointRows(model_, at, offsetOf(kin_, at, f.section), t * f.force, Vec2::Zero(), rows);
            force += rows.row(0).transpose();
        }
        jacobian_.resize(count(), n);
        Eigen::VectorXd r(unknowns());
        for (int i = 0; i < count(); ++i) {
            const Equation& e = equations_[static_cast<std::size_t>(i)];
            jacobian_.row(i) = row(e).cwiseProduct(scale_.transpose()) / equationScale_[i];
            r[n + i] = (value(e) - (1.0 - t) * e.initial - t * e.target) / equationScale_[i];
        }
        free_ = force.cwiseProduct(scale_) / (forceUnit_ * length());
        r.head(n) = free_ + jacobian_.transpose() * multipliers;
        return r;
    }

    /// Multipliers that balance the forces of the last residual() in the least-squares sense.
    [[nodiscard]] Eigen::VectorXd balancingMultipliers() const {
        if (count() == 0)
            return {};
        return -dense::leastSquaresOfTransposed(jacobian_, free_);
    }

    /// Dimensionless tangent stiffness at the configuration of the last residual().
    Eigen::MatrixXd stiffness(const Eigen::VectorXd& multipliers, double t) {
        const int n = model_.dofs();
        Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
        addBendingStiffness(model_, 1.0, K);
        if (!problem_.gravity.isZero())
            addUniformStiffness(model_, kin_, field_, t * problem_.gravity, K);
        for (const PointLoad& f : problem_.pointLoads) {
            const MaterialPoint at = locate(model_, f.s);
            addPointForceStiffness(model_, kin_, at, offsetOf(kin_, at, f.section), t * f.force, K);
        }
        for (int i = 0; i < count(); ++i) {
            const Equation& e = equations_[static_cast<std::size_t>(i)];
            if (e.kind == Equation::Component::angle)
                continue; // linear in q
            const Vec2 f = multipliers[i] * forceUnit_ * axis(e.kind);
            addPointForceStiffness(model_, kin_, e.point, offsetOf(kin_, e.point, e.section), f, K);
            if (e.joined)
                addPointForceStiffness(model_, kin_, e.other, Vec2::Zero(), -f, K);
        }
        return scale_.asDiagonal() * K * scale_.asDiagonal() / (forceUnit_ * length());
    }

    [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return jacobian_; }
    [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }

    void storeReactions(const Eigen::VectorXd& multipliers, Equilibrium& result) const {
        result.reactions.assign(problem_.supports.size(), {});
        for (int i = 0; i < count(); ++i) {
            const Equation& e = equations_[static_cast<std::size_t>(i)];
            Reaction& r = e.joined ? result.closureReaction : result.reactions[owner_[static_cast<std::size_t>(i)]];
            if (e.kind == Equation::Component::angle)
                r.moment = multipliers[i] * forceUnit_ * length();
            else
                r.force += multipliers[i] * forceUnit_ * axis(e.kind);
        }
    }

private:
    [[nodiscard]] double length() const { return model_.definition().length; }

    void listEquations() {
        for (std::size_t h = 0; h < problem_.supports.size(); ++h) {
            const Support& support = problem_.supports[h];
            const MaterialPoint at = locate(model_, support.s);
            const auto add = [&](bool fixed, Equation::Component kind, double target) {
                if (!fixed)
                    return;
                equations_.push_back({kind, at, support.section, false, {}, target, 0.0});
                owner_.push_back(h);
            };
            add(support.fixX, Equation::Component::x, support.position.x());
            add(support.fixY, Equation::Component::y, support.position.y());
            add(support.fixAngle, Equation::Component::angle, support.angle);
        }
        if (!model_.definition().closed)
            return;
        const MaterialPoint last = locate(model_, model_.elements() - 1, length());
        const MaterialPoint first = locate(model_, 0, 0.0);
        for (const auto kind : {Equation::Component::x, Equation::Component::y, Equation::Component::angle}) {
            const double target = kind == Equation::Component::angle ? problem_.closureAngle : 0.0;
            equations_.push_back({kind, last, Vec2::Zero(), true, first, target, 0.0});
            owner_.push_back(0);
        }
    }

    [[nodiscard]] double value(const Equation& e, const MaterialPoint& at, const Vec2& section) const {
        if (e.kind == Equation::Component::angle)
            return kin_.angle(at);
        return axis(e.kind).dot(kin_.point(at) + offsetOf(kin_, at, section));
    }
    [[nodiscard]] double value(const Equation& e) const {
        return value(e, e.point, e.section) - (e.joined ? value(e, e.other, Vec2::Zero()) : 0.0);
    }

    [[nodiscard]] Eigen::RowVectorXd row(const Equation& e, const MaterialPoint& at, const Vec2& section) const {
        Eigen::RowVectorXd result(model_.dofs());
        if (e.kind == Equation::Component::angle) {
            kin_.angleRow(model_, at, result);
            return result;
        }
        Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model_.dofs());
        kin_.pointRows(model_, at, offsetOf(kin_, at, section), axis(e.kind), Vec2::Zero(), rows);
        return rows.row(0);
    }
    [[nodiscard]] Eigen::RowVectorXd row(const Equation& e) const {
        Eigen::RowVectorXd result = row(e, e.point, e.section);
        if (e.joined)
            result -= row(e, e.other, Vec2::Zero());
        return result;
    }

    const RodModel& model_;
    const EquilibriumProblem& problem_;
    double forceUnit_ = 1.0;
    Eigen::VectorXd scale_;         // coordinate = scale * dimensionless coordinate
    Eigen::VectorXd equationScale_; // m or 1
    std::vector<Equation> equations_;
    std::vector<std::size_t> owner_;
    Kinematics kin_;
    GaussField field_;
    Eigen::MatrixXd jacobian_;
    Eigen::VectorXd free_;
};

/// Largest rotation of any section in a dimensionless step, rad.
double largestRotation(const RodModel& model, const Eigen::VectorXd& step) {
    double worst = std::abs(step[model.dofTheta()]);
    for (int side = 0; side < 2; ++side) {
        double turn = step[model.dofTheta()];
        for (const Segment& seg : model.side(side)) {
            turn += step[seg.dof] * seg.signedLength / model.definition().length;
            worst = std::max(worst, std::abs(turn));
        }
    }
    return worst;
}

/// Newton at one load fraction; q and multipliers are overwritten. True if converged.
bool newton(const RodModel& model, System& system, double t, const EquilibriumOptions& options, Eigen::VectorXd& q,
            Eigen::VectorXd& multipliers, Equilibrium& result) {
    const int n = model.dofs(), m = system.count();
    Eigen::VectorXd r = system.residual(q, multipliers, t);
    for (int i = 0; i < options.iterationsPerStep; ++i) {
        if (!r.allFinite())
            return false;
        if (r.cwiseAbs().maxCoeff() <= options.tolerance) {
            result.residual = r.cwiseAbs().maxCoeff();
            return true;
        }
        ++result.iterations;
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + m, n + m);
        A.topLeftCorner(n, n) = system.stiffness(multipliers, t);
        A.topRightCorner(n, m) = -system.jacobian().transpose();
        A.bottomLeftCorner(m, n) = -system.jacobian();
        const Eigen::VectorXd step = dense::solveFullPivLu(A, r);
        if (!step.allFinite())
            return false;
        const double turn = largestRotation(model, step.head(n));
        double factor = turn > options.maxRotationPerIteration ? options.maxRotationPerIteration / turn : 1.0;
        const double before = r.norm();
        Eigen::VectorXd bestQ, bestMultipliers;
        double best = INFINITY;
        // Shorten the step while the residual does not fall. If it never falls, the best of the four is still taken:
        // the residual of an inextensible rod often has to rise once before Newton converges.
        for (int k = 0; k < 4; ++k, factor *= 0.5) {
            const Eigen::VectorXd q1 = q + factor * system.scale().cwiseProduct(step.head(n));
            const Eigen::VectorXd l1 = multipliers + factor * step.tail(m);
            const double after = system.residual(q1, l1, t).norm();
            if (after < best) {
                best = after;
                bestQ = q1;
                bestMultipliers = l1;
            }
            if (best < (1.0 - 1e-3 * factor) * before)
                break;
        }
        if (!std::isfinite(best))
            return false;
        q = bestQ;
        multipliers = bestMultipliers;
        r = system.residual(q, multipliers, t);
    }
    return false;
}

/// Smallest eigenvalue of K on the null space of G.
double smallestStiffness(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) {
    const int n = static_cast<int>(K.rows());
    Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n);
    if (G.rows() > 0) {
        Z = dense::nullSpaceBasis(G);
        if (Z.cols() == 0)
            return INFINITY;
    }
    const Eigen::MatrixXd reduced = Z.transpose() * K * Z;
    return dense::symmetricEigenvalues(reduced)[0];
}

std::string check(const RodModel& model, const EquilibriumProblem& problem, const Eigen::VectorXd& start) {
    if (start.size() != model.dofs())
        return "start has " + std::to_string(start.size()) + " entries, the rod has " + std::to_string(model.dofs());
    if (!start.allFinite())
        return "start contains a number that is not finite";
    const double length = model.definition().length;
    const auto onRod = [&](double s) { return s >= 0.0 && s <= length; }; // false for NaN
    for (const PointLoad& f : problem.pointLoads)
        if (!onRod(f.s) || !f.force.allFinite() || !f.section.allFinite())
            return "a point load is not finite or not on the rod (s = " + std::to_string(f.s) + " m)";
    for (const Support& h : problem.supports)
        if (!onRod(h.s) || !h.position.allFinite() || !std::isfinite(h.angle) || !h.section.allFinite())
            return "a support is not finite or not on the rod (s = " + std::to_string(h.s) + " m)";
    if (!problem.gravity.allFinite() || !std::isfinite(problem.closureAngle))
        return "gravity or the closure angle is not finite";
    return {};
}

} // namespace

Eigen::VectorXd naturalShape(const RodModel& model, const Vec2& middle, double theta) {
    Eigen::VectorXd q(model.dofs());
    for (int i = 0; i < model.elements(); ++i)
        q[model.dofOfElement(i)] = model.definition().naturalCurvature[static_cast<std::size_t>(i)];
    q[model.dofX()] = middle.x();
    q[model.dofY()] = middle.y();
    q[model.dofTheta()] = theta;
    return q;
}

Equilibrium solveEquilibrium(const RodModel& model, const EquilibriumProblem& problem, const Eigen::VectorXd& start,
                             const EquilibriumOptions& options) {
    Equilibrium result;
    result.q = start;
    result.failure = check(model, problem, start);
    if (!result.failure.empty())
        return result;
    System system(model, problem);
    system.begin(start);
    double step = 1.0 / std::max(1, options.loadSteps);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(system.count());
    system.residual(start, multipliers, step);
    multipliers = system.balancingMultipliers();
    while (result.loadFraction < 1.0) {
        const double t = std::min(1.0, result.loadFraction + step);
        Eigen::VectorXd q = result.q, trial = multipliers;
        const int before = result.iterations;
        if (newton(model, system, t, options, q, trial, result)) {
            result.q = std::move(q);
            multipliers = std::move(trial);
            result.loadFraction = t > 1.0 - 1e-12 ? 1.0 : t;
            ++result.loadSteps;
            if (result.iterations - before <= 8)
                step *= 1.5;
        } else {
            step *= 0.5;
            if (step < options.minLoadStep) {
                result.failure =
                    "no equilibrium found beyond " + std::to_string(result.loadFraction) +
                    " of the load: the rod may be free to move (too few supports), the supports may contradict "
                    "each other, or a limit point was met (prescribe the displacement instead)";
                break;
            }
        }
    }
    result.residual = system.residual(result.q, multipliers, result.loadFraction).cwiseAbs().maxCoeff();
    result.smallestStiffness = smallestStiffness(system.stiffness(multipliers, result.loadFraction), system.jacobian());
    system.storeReactions(multipliers, result);
    return result;
}

} // namespace supercircle::rod
