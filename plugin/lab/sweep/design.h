#pragma once
// Inverse design: from the results of a sweep over two parameters to the pairs that give a target value.

#include "plugin/lab/sweep/run_table.h"
#include "supercircle/support/result.h"

#include <string>
#include <vector>

namespace supercircle::sweep {

/// Response surface: statistics of one quantity over the grid of two parameters, interpolated in between. Linear in x;
/// in y linear in its logarithm where all values are positive (friction coefficients span a decade), else linear.
class ResponseSurface {
public:
    std::string xName, yName;
    std::vector<double> x, y;                ///< ascending
    std::vector<std::vector<double>> mean;   ///< [y][x]
    std::vector<std::vector<double>> error;  ///< standard error of the mean
    std::vector<std::vector<double>> spread; ///< of single runs, 1.4826 MAD

    struct Value {
        double mean = 0.0, error = 0.0, spread = 0.0;
    };
    /// Interpolated inside the grid; the value at the border outside.
    [[nodiscard]] Value at(double px, double py) const;
    /// Position of py between two rows of the grid: 0 at the lower, 1 at the upper.
    [[nodiscard]] double fraction(std::size_t row, double py) const;
};

/// The sweep must vary one or two parameters over a full grid with runs in every set. `x` is the sweep's abscissa.
[[nodiscard]] Result<ResponseSurface> responseSurface(const SweepDefinition& sweep, const RunTable& table,
                                                      const std::string& quantity);

/// A pair of parameters that gives the target value.
struct DesignPoint {
    double x = 0.0, y = 0.0;
    double xError = 0.0; ///< standard error of the mean, propagated to x
    double slope = 0.0;  ///< d mean / dx at this point
    ResponseSurface::Value value;
};

/// All pairs with mean = target on the line y = py, ascending in x.
[[nodiscard]] std::vector<DesignPoint> solveFor(const ResponseSurface& surface, double target, double py);

/// Spread of single stacks of `shells` shells, from that of stacks of `measuredAt`, by 1/sqrt(N) (paper, Methods). This
/// is a lower bound: stacks of 10 to 100 shells at one force scatter by N^-0.3 (H0, dissipation ratio) and N^0
/// (Delta_max), docs/results/paper.md.
[[nodiscard]] double scaledSpread(double spread, double measuredAt, double shells);

} // namespace supercircle::sweep
