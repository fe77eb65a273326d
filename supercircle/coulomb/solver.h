#pragma once
// The interface of the contact solvers: methods, options and report.

#include "supercircle/coulomb/problem.h"
#include "supercircle/support/parallel.h"

#include <memory>
#include <string>
#include <string_view>

namespace supercircle::coulomb {

enum class Method : std::uint8_t {
    Strategy,    ///< path following from the warm start, in subdomains if large, with fallbacks: the default
    GaussSeidel, ///< velocity-form block Gauss-Seidel, exact local law
    Accelerated, ///< Gauss-Seidel with nonlinear-CG acceleration
    Path,        ///< piecewise-linear path following on a working set
    Newton,      ///< proximal active-set (semismooth) Newton, the fallback for hard problems
    None         ///< no iteration: evaluates the warm start only
};
std::string_view name(Method m);

struct SolverOptions {
    Method method = Method::Strategy;
    double tolerance = 1e-8;             ///< target of the contact residual, 1
    double absoluteImpulse = 1e-13;      ///< N s; if the natural-map error is below this at every contact, the problem
                                         ///< counts as solved with a residual up to 1e-3
    int maxGaussSeidelIterations = 1000; ///< limit of one Gauss-Seidel run
    int initialGaussSeidelIterations = 40; ///< before the path, if the warm start did not suffice
    int maxPivots = 600;      ///< limit of one path, scaled up above 250 unknowns; all paths together: 5 times
    bool giveUpEarly = false; ///< end after 300 + 4 pivots an active contact, without the slow last resorts: for
                              ///< callers that can ask for a smaller step instead
    double maxWork = 0.0; ///< limit of SolveEffort::units(), 0: none. The iterations of a cold start run all the same
};

/// What a solve took, in counts that grow as its time does.
struct SolveEffort {
    double visits = 0.0;  ///< contacts looked at by iterations, evaluations and assembly
    double pivots = 0.0;  ///< sum over pivots of contacts and closed unknowns
    double factors = 0.0; ///< multiply-adds of factorisations

    void add(const SolveEffort& other) {
        visits += other.visits;
        pivots += other.pivots;
        factors += other.factors;
    }
    /// In visits of a contact by an iteration, about 35 ns each. Weights: work_count.h of step/.
    [[nodiscard]] double units() const { return visits + 0.85 * pivots + 0.03 * factors; }
};

/// Result of one solve. Every field is set for every method.
struct SolveReport {
    bool converged = false;
    bool byAbsoluteFloor = false;  ///< converged by SolverOptions::absoluteImpulse, the residual above the tolerance
    double contactResidual = 0.0;  ///< of the returned impulses, 1; at most the tolerance where only round-off is left
    double penetrationSpeed = 0.0; ///< max(-u_n), of bilateral contacts |u_n| (and |u_t| if locked), m/s
    double impulseError = 0.0;     ///< largest |F_c|, N s
    Method finishedBy = Method::None;
    int gaussSeidelIterations = 0;
    int pivots = 0;
    int factorisations = 0;
    SolveEffort effort;
    int activeContacts = 0; ///< contacts with r_n > 0, and all bilateral ones
    std::string error; ///< why the problem is invalid (then r = 0, v = vFree, infinite residual); empty if it is valid
};

/// Keeps its workspace between calls, so that it stops allocating, but no other history: the result depends on
/// (problem, options) only. Not thread-safe: use one solver per thread, or pass a loop.
class Solver {
public:
    Solver();
    ~Solver();
    Solver(Solver&&) noexcept;
    Solver& operator=(Solver&&) noexcept;

    /// Solves `problem`; `r` (2 per contact) receives the best impulses found (N s), always finite; `v`
    /// (one vector per body) the velocities for them. `loop` may use several threads; results are bitwise identical.
    SolveReport solve(const Problem& problem, const SolverOptions& options, Eigen::VectorXd& r,
                      std::vector<Eigen::VectorXd>& v, const parallel::For& loop = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::coulomb
