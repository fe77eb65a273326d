#pragma once
// Statistics of one number over the runs of a parameter set.

#include "plugin/lab/sweep/run_table.h"

#include <string>
#include <vector>

namespace supercircle::sweep {

struct Statistics {
    std::size_t n = 0;
    double mean = 0.0, median = 0.0;
    double mad = 0.0;       ///< median absolute deviation from the median, as it is (not scaled)
    double madSigma = 0.0;  ///< 1.4826 mad: estimates the standard deviation of a Gaussian (Huber, Robust Statistics)
    double deviation = 0.0; ///< standard deviation, n - 1; NaN below two values
    double standardError = 0.0;            ///< of the mean
    double low = 0.0, high = 0.0;          ///< 95 % confidence interval of the mean (Student)
    double skewness = 0.0, kurtosis = 0.0; ///< the latter in excess of a Gaussian's; NaN without spread
    double normality = 0.0;                ///< p value of normalityTest()
};

/// Of the finite ones among `values`; statistics that are not defined are NaN.
[[nodiscard]] Statistics statisticsOf(std::vector<double> values);

/// p value of the hypothesis that `values` come from a Gaussian of unknown mean and variance: Anderson-Darling
/// (R. B. D'Agostino, M. A. Stephens, Goodness-of-Fit Techniques, 1986, table 4.9). NaN below eight values or without
/// spread.
[[nodiscard]] double normalityTest(std::vector<double> values);

/// The finite values of a column over the completed runs of a set, in the order of seeds.
[[nodiscard]] std::vector<double> valuesOf(const RunTable& table, std::size_t set, std::size_t column);

/// One row per set and number: n, mean, median, mad and so on.
[[nodiscard]] std::string statisticsCsv(const SweepDefinition& sweep, const RunTable& table);

} // namespace supercircle::sweep
