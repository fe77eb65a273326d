#pragma once
// The one door to the contact solvers: the method cascade, its settings, and what it reports back.

#include "supercircle/coulomb/problem.h"
#include "supercircle/support/parallel.h"

#include <memory>
#include <string>
#include <string_view>

namespace supercircle::coulomb {

enum class Method : std::uint8_t {
    Cascade,     ///< path following from the warm start's pieces, in regions where large, and nets: the default
    GaussSeidel, ///< velocity-form block Gauss-Seidel, exact local law
    Accelerated, ///< Gauss-Seidel with nonlinear-CG acceleration
    Path,        ///< piecewise-linear path following on a working set
    Newton,      ///< proximal active-set (semismooth) Newton, the net for the hard ones
    None         ///< no sweep: judge the warm start only
};
std::string_view name(Method m);

struct SolverOptions {
    Method method = Method::Cascade;
    double tolerance = 1e-8;        ///< target of the solver-neutral residual eta, 1
    double absoluteImpulse = 1e-13; ///< N s; a problem whose natural-map error is below this everywhere counts as
                                    ///< solved even if eta's denominator vanishes
    int maxSweeps = 1000;           ///< cap of one Gauss-Seidel run
    int firstSweeps = 40;           ///< Gauss-Seidel sweeps before the path where the warm start did not do
    int maxPivots = 600; ///< cap of one path; more in proportion above 250 unknowns; all paths of a solve: 5 times this
};

/// What happened; every field is filled for every method.
struct SolveReport {
    bool converged = false;
    double eta = 0.0;              ///< judge's residual of the returned impulses, 1
    double penetrationSpeed = 0.0; ///< max(-u_n), of bilateral contacts |u_n| (and |u_t| if locked), m/s
    double impulseError = 0.0;     ///< largest |F_c|, N s
    Method finishedBy = Method::None;
    int sweeps = 0;
    int pivots = 0;
    int factorisations = 0;
    int loaded = 0;    ///< contacts with r_n > 0, and all bilateral ones
    std::string error; ///< why the problem was refused (r = 0, v = vFree, eta infinite); empty as a rule
};

/// A solver keeps its work space between calls (allocation-free once warm) but no other memory: the answer depends on
/// (problem, options) only. Not thread-safe; use one per thread, or hand in a loop.
class Solver {
public:
    Solver();
    ~Solver();
    Solver(Solver&&) noexcept;
    Solver& operator=(Solver&&) noexcept;

    /// Solves `problem`; `r` (2 per contact) receives the best iterate found, always finite; `v` (one vector per body)
    /// the bodies' velocities for it. `loop` runs what is independent on several threads, with the same digits.
    SolveReport solve(const Problem& problem, const SolverOptions& options, Eigen::VectorXd& r,
                      std::vector<Eigen::VectorXd>& v, const parallel::For& loop = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::coulomb
