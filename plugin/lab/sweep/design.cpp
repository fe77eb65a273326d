#include "plugin/lab/sweep/design.h"

#include "plugin/lab/sweep/statistics.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>

namespace supercircle::sweep {

namespace {

std::vector<double> axisOf(const SweepDefinition& sweep, std::size_t name) {
    std::vector<double> values;
    for (const std::vector<double>& set : sweep.sets)
        values.push_back(set[name]);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

/// Index of the interval of `axis` that holds `value`, and the relative position in it.
std::pair<std::size_t, double> intervalOf(const std::vector<double>& axis, double value) {
    if (axis.size() < 2)
        return {0, 0.0};
    const auto above = std::upper_bound(axis.begin(), axis.end(), value);
    const std::size_t i =
        std::clamp<std::size_t>(static_cast<std::size_t>(above - axis.begin()), 1, axis.size() - 1) - 1;
    return {i, std::clamp((value - axis[i]) / (axis[i + 1] - axis[i]), 0.0, 1.0)};
}

std::size_t indexOf(const std::vector<double>& axis, double value) {
    return static_cast<std::size_t>(std::find(axis.begin(), axis.end(), value) - axis.begin());
}

} // namespace

Result<ResponseSurface> responseSurface(const SweepDefinition& sweep, const RunTable& table,
                                        const std::string& quantity) {
    using Out = Result<ResponseSurface>;
    const std::size_t column = table.column(quantity);
    if (column == table.columns.size())
        return Out::failure("the runs have no quantity \"" + quantity + "\"" + didYouMean(quantity, table.columns));
    if (sweep.names.empty() || sweep.names.size() > 2)
        return Out::failure("the sweep must vary one or two parameters, this one varies " +
                            std::to_string(sweep.names.size()));
    const std::size_t xAt = sweep.names[0] == sweep.x ? 0 : 1, yAt = 1 - xAt;
    const bool two = sweep.names.size() == 2;
    ResponseSurface s;
    s.xName = sweep.names[xAt];
    s.yName = two ? sweep.names[yAt] : "";
    s.x = axisOf(sweep, xAt);
    s.y = two ? axisOf(sweep, yAt) : std::vector<double>{0.0};
    if (s.x.size() * s.y.size() != sweep.sets.size())
        return Out::failure("the parameter sets of the sweep do not form a full grid");
    s.mean.assign(s.y.size(), std::vector<double>(s.x.size(), 0.0));
    s.error = s.spread = s.mean;
    for (std::size_t set = 0; set < sweep.sets.size(); ++set) {
        const Statistics stat = statisticsOf(valuesOf(table, set, column));
        if (stat.n < 2)
            return Out::failure("too few runs with " + keyOf(sweep.parameterValues(set)) + ": " +
                                std::to_string(stat.n));
        const std::size_t i = two ? indexOf(s.y, sweep.sets[set][yAt]) : 0, k = indexOf(s.x, sweep.sets[set][xAt]);
        s.mean[i][k] = stat.mean;
        s.error[i][k] = stat.standardError;
        s.spread[i][k] = stat.madSigma;
    }
    return s;
}

double ResponseSurface::fraction(std::size_t row, double py) const {
    if (row + 1 >= y.size())
        return 0.0;
    const double lo = y[row], hi = y[row + 1];
    const bool logarithmic = y.front() > 0.0 && py > 0.0;
    const double s = logarithmic ? math::log(py / lo) / math::log(hi / lo) : (py - lo) / (hi - lo);
    return std::clamp(s, 0.0, 1.0);
}

ResponseSurface::Value ResponseSurface::at(double px, double py) const {
    const auto [k, sx] = intervalOf(x, px);
    const std::size_t row = intervalOf(y, py).first;
    const double sy = fraction(row, py);
    const std::size_t k1 = std::min(k + 1, x.size() - 1), row1 = std::min(row + 1, y.size() - 1);
    const double wx = sx; // structured bindings are not captured
    const auto mix = [&, k = k](const std::vector<std::vector<double>>& v) {
        return (1.0 - sy) * ((1.0 - wx) * v[row][k] + wx * v[row][k1]) +
               sy * ((1.0 - wx) * v[row1][k] + wx * v[row1][k1]);
    };
    return {mix(mean), mix(error), mix(spread)};
}

std::vector<DesignPoint> solveFor(const ResponseSurface& surface, double target, double py) {
    std::vector<DesignPoint> all;
    for (std::size_t k = 0; k + 1 < surface.x.size(); ++k) {
        const double x0 = surface.x[k], x1 = surface.x[k + 1];
        const double f0 = surface.at(x0, py).mean, f1 = surface.at(x1, py).mean;
        const bool last = k + 2 == surface.x.size();
        const bool crosses = (f0 <= target && target < f1) || (f0 >= target && target > f1) || (last && f1 == target);
        if (!crosses || f0 == f1)
            continue;
        DesignPoint s;
        s.slope = (f1 - f0) / (x1 - x0);
        s.x = x0 + (target - f0) / s.slope;
        s.y = py;
        s.value = surface.at(s.x, py);
        s.xError = s.value.error / std::abs(s.slope);
        all.push_back(s);
    }
    return all;
}

double scaledSpread(double spread, double measuredAt, double shells) {
    return spread * std::sqrt(measuredAt / shells);
}

} // namespace supercircle::sweep
