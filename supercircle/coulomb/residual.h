#pragma once
// The independent residual evaluation: how far impulses are from solving a contact problem, whatever method computed
// them.

#include "supercircle/coulomb/problem.h"

#include <algorithm>
#include <cmath>

namespace supercircle::coulomb {

/// The residual of one set of impulses.
struct Residual {
    double contactResidual = 0.0;  ///< solver-neutral relative residual, 1 (definition in residual.cpp)
    double penetrationSpeed = 0.0; ///< max(-u_n, 0), of a bilateral contact |u_n| (and |u_t| if locked), m/s
    double impulseError = 0.0;     ///< largest natural-map error |F_c|, N s
    double speedError = 0.0;       ///< largest d_c |F_c|, m/s
    double scale = 0.0;            ///< denominator of the squared contact residual, J
};

/// Projects (rn, rt) in place on the friction cone |rt| <= mu rn (Euclidean norm).
inline void projectOnCone(double mu, double& rn, double& rt) {
    const double size = std::abs(rt);
    if (size <= mu * rn)
        return;
    if (rn <= -mu * size) {
        rn = 0.0;
        rt = 0.0;
        return;
    }
    const double n = (rn + mu * size) / (1.0 + mu * mu);
    rt = rt < 0.0 ? -mu * n : mu * n;
    rn = n;
}

/// Accumulates the residual contact by contact, in a fixed order.
class ResidualSum {
public:
    /// u: velocity, q: velocity without any impulse (m/s), r: impulse (N s); scale d = tr(W_cc)/2 (1/kg).
    void add(double un, double ut, double qn, double qt, double rn, double rt, double mu, double d);
    /// The same for a bilateral contact; `locked`: u_t = 0, else r_t = 0.
    void addBilateral(double un, double ut, double qn, double qt, double rn, double rt, bool locked, double d);
    Residual result() const;
    /// Sum of d |F|^2 so far, J.
    double error() const { return error_; }

private:
    void addHeld(double square, double d) {
        held_ += d * square;
        impulseSquares_ += square;
        speedSquares_ += d * d * square;
    }

    double error_ = 0.0;
    double closing_ = 0.0;
    double held_ = 0.0;
    double impulseSquares_ = 0.0, speedSquares_ = 0.0; ///< of the impulses
    double penetration_ = 0.0;
    double impulse_ = 0.0;
    double speed_ = 0.0;
};

inline void ResidualSum::add(double un, double ut, double qn, double qt, double rn, double rt, double mu, double d) {
    double pn = rn - (un + mu * std::abs(ut)) / d;
    double pt = rt - ut / d;
    projectOnCone(mu, pn, pt);
    const double square = (rn - pn) * (rn - pn) + (rt - pt) * (rt - pt);
    error_ += d * square;
    impulse_ = std::max(impulse_, square);
    speed_ = std::max(speed_, d * d * square);
    penetration_ = std::max(penetration_, -un);
    addHeld(rn * rn + rt * rt, d);
    if (qn < 0.0)
        closing_ += (qn * qn + qt * qt) / d;
}

inline void ResidualSum::addBilateral(double un, double ut, double qn, double qt, double rn, double rt, bool locked,
                                      double d) {
    const double n = un / d;
    const double t = locked ? ut / d : rt;
    const double square = n * n + t * t;
    error_ += d * square;
    impulse_ = std::max(impulse_, square);
    speed_ = std::max(speed_, d * d * square);
    penetration_ = std::max({penetration_, std::abs(un), locked ? std::abs(ut) : 0.0});
    addHeld(rn * rn + rt * rt, d);
    closing_ += (qn * qn + (locked ? qt * qt : 0.0)) / d;
}

/// Residual of impulses `r` (2 per contact, N s) from the problem data; it shares no code with the kernels of the
/// solvers. The problem must be valid (see `validate`) and r must have the right size. Non-finite r has an infinite
/// residual.
Residual evaluateResidual(const Problem& problem, const Eigen::VectorXd& r);

/// Velocities v_b = vFree_b + A_b^-1 sum H^T r, one vector a body, m/s-like.
std::vector<Eigen::VectorXd> bodyVelocities(const Problem& problem, const Eigen::VectorXd& r);

} // namespace supercircle::coulomb
