#include "plugin/lab/sweep/statistics.h"

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/text.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace supercircle::sweep {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Of sorted values, at least one. Published statistics have the mean of the two middle ones, not upperMedian().
double medianOf(const std::vector<double>& sorted) {
    const std::size_t n = sorted.size();
    return n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

double meanOf(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values)
        sum += v;
    return sum / static_cast<double>(values.size());
}

/// Sum of (v - mean)^power.
double momentOf(const std::vector<double>& values, double mean, int power) {
    double sum = 0.0;
    for (const double v : values)
        sum += math::pow(v - mean, power);
    return sum;
}

} // namespace

double normalityTest(std::vector<double> values) {
    const std::size_t n = values.size();
    if (n < 8)
        return kNaN;
    std::sort(values.begin(), values.end());
    const double mean = meanOf(values);
    const double deviation = std::sqrt(momentOf(values, mean, 2) / static_cast<double>(n - 1));
    if (!(deviation > 1e-14 * std::max(std::abs(values.front()), std::abs(values.back()))))
        return kNaN;
    const boost::math::normal gauss;
    const auto below = [&](std::size_t i) { return boost::math::cdf(gauss, (values[i] - mean) / deviation); };
    const auto above = [&](std::size_t i) {
        return boost::math::cdf(boost::math::complement(gauss, (values[i] - mean) / deviation));
    };
    const double count = static_cast<double>(n);
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i)
        sum += (2.0 * static_cast<double>(i) + 1.0) *
               (math::log(std::max(below(i), 1e-300)) + math::log(std::max(above(n - 1 - i), 1e-300)));
    const double a = (-count - sum / count) * (1.0 + 0.75 / count + 2.25 / (count * count));
    if (a < 0.2)
        return 1.0 - math::exp(-13.436 + 101.14 * a - 223.73 * a * a);
    if (a < 0.34)
        return 1.0 - math::exp(-8.318 + 42.796 * a - 59.938 * a * a);
    if (a < 0.6)
        return math::exp(0.9177 - 4.279 * a - 1.38 * a * a);
    return a > 13.0 ? 0.0 : math::exp(1.2937 - 5.709 * a + 0.0186 * a * a);
}

Statistics statisticsOf(std::vector<double> values) {
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    Statistics s;
    s.n = values.size();
    s.mean = s.median = s.mad = s.madSigma = s.deviation = s.standardError = kNaN;
    s.low = s.high = s.skewness = s.kurtosis = s.normality = kNaN;
    if (values.empty())
        return s;
    std::sort(values.begin(), values.end());
    const double n = static_cast<double>(s.n);
    s.mean = meanOf(values);
    s.median = medianOf(values);
    std::vector<double> distances;
    for (const double v : values)
        distances.push_back(std::abs(v - s.median));
    std::sort(distances.begin(), distances.end());
    s.mad = medianOf(distances);
    s.madSigma = 1.482602218505602 * s.mad; // 1 / quantile(3/4) of the Gaussian
    if (s.n < 2)
        return s;
    const double second = momentOf(values, s.mean, 2);
    s.deviation = std::sqrt(second / (n - 1.0));
    s.standardError = s.deviation / std::sqrt(n);
    const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
    s.low = s.mean - t * s.standardError;
    s.high = s.mean + t * s.standardError;
    if (second > 0.0) {
        const double variance = second / n;
        s.skewness = momentOf(values, s.mean, 3) / n / math::pow(variance, 1.5);
        s.kurtosis = momentOf(values, s.mean, 4) / n / (variance * variance) - 3.0;
    }
    s.normality = normalityTest(values);
    return s;
}

std::vector<double> valuesOf(const RunTable& table, std::size_t set, std::size_t column) {
    std::vector<double> values;
    for (const Row& row : table.rows)
        if (row.set == set && row.status == "done" && std::isfinite(row.number(column)))
            values.push_back(row.number(column));
    return values;
}

std::string statisticsCsv(const SweepDefinition& sweep, const RunTable& table) {
    std::string out;
    for (const ParameterValue& s : sweep.fixed)
        out += record::csvCell(s.first) + ",";
    for (const std::string& name : sweep.names)
        out += record::csvCell(name) + ",";
    out += "quantity,n,mean,median,mad,sigma_mad,std,standard_error,ci95_low,ci95_high,skewness,excess_kurtosis,"
           "normality_p\n";
    for (std::size_t set = 0; set < sweep.sets.size(); ++set) {
        std::string head;
        for (const ParameterValue& s : sweep.parameterValues(set)) {
            record::appendNumber(head, s.second);
            head += ',';
        }
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            const Statistics s = statisticsOf(valuesOf(table, set, c));
            if (s.n == 0)
                continue;
            out += head + record::csvCell(table.columns[c]) + "," + std::to_string(s.n);
            for (const double v : {s.mean, s.median, s.mad, s.madSigma, s.deviation, s.standardError, s.low, s.high,
                                   s.skewness, s.kurtosis, s.normality}) {
                out += ',';
                if (std::isfinite(v))
                    record::appendNumber(out, v);
            }
            out += '\n';
        }
    }
    return out;
}

} // namespace supercircle::sweep
