#pragma once
// From the results of a sweep over two parameters to the pairs that give a wanted number.

#include "plugin/lab/sweep/table.h"
#include "plugin/recording/table/result.h"

#include <string>
#include <vector>

namespace supercircle::sweep {

/// Statistics of one number over the grid of two parameters, interpolated in between: linearly in x; in y linearly in
/// its logarithm where all values are positive (friction coefficients spread over a decade), else linearly.
class Surface {
public:
    std::string xName, yName;
    std::vector<double> x, y;                ///< ascending
    std::vector<std::vector<double>> mean;   ///< [y][x]
    std::vector<std::vector<double>> error;  ///< standard error of the mean
    std::vector<std::vector<double>> spread; ///< of single runs, 1.4826 MAD

    struct Value {
        double mean = 0.0, error = 0.0, spread = 0.0;
    };
    /// Inside the grid; at its border beyond.
    [[nodiscard]] Value at(double px, double py) const;
    /// Where between two rows of the grid py lies: 0 at the lower, 1 at the upper.
    [[nodiscard]] double share(std::size_t row, double py) const;
};

/// The sweep must vary one or two parameters over a full grid with runs in every set. `x` is the sweep's abscissa.
[[nodiscard]] record::Result<Surface> surfaceOf(const Definition& sweep, const Table& table,
                                                const std::string& quantity);

/// A pair that gives the wanted value.
struct Solution {
    double x = 0.0, y = 0.0;
    double xError = 0.0; ///< what the standard error of the mean makes of x (as far as the surface is not flat)
    double slope = 0.0;  ///< d mean / dx there
    Surface::Value value;
};

/// All pairs with mean = wanted on the line y = py, ascending in x.
[[nodiscard]] std::vector<Solution> solve(const Surface& surface, double wanted, double py);

/// Spread of single stacks of `shells` shells, from that of stacks of `measuredAt`: 1/sqrt(N) (paper, Methods), at
/// best: stacks of 10 to 100 shells at one force scatter by N^-0.3 (H0, eta) and N^0 (Delta_max), docs/paper.md.
[[nodiscard]] double spreadAt(double spread, double measuredAt, double shells);

} // namespace supercircle::sweep
