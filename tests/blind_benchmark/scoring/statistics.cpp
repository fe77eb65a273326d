#include "tests/blind_benchmark/scoring/statistics.h"

#include "tests/blind_benchmark/synthetic_cases/random.h"

#include <algorithm>
#include <cmath>

namespace supercircle::blind_benchmark {

namespace {

constexpr double kZ90 = 1.6448536269514722;

double wilson(const Proportion& s, double sign) {
    if (s.of == 0)
        return sign < 0.0 ? 0.0 : 1.0;
    const double n = s.of, p = s.value(), z2 = kZ90 * kZ90;
    const double centre = p + z2 / (2.0 * n), half = kZ90 * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
    return std::clamp((centre + sign * half) / (1.0 + z2 / n), 0.0, 1.0);
}

double medianOf(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    const std::size_t n = v.size();
    return n % 2 == 1 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

double meanOf(const std::vector<double>& v) {
    double sum = 0.0;
    for (const double x : v)
        sum += x;
    return sum / static_cast<double>(v.size());
}

template <class Statistic>
Estimate withInterval(const std::vector<double>& v, Statistic&& statistic) {
    Estimate m;
    m.of = v.size();
    if (v.empty())
        return m;
    m.value = statistic(v);
    Random draw(12345);
    std::vector<double> all;
    for (int b = 0; b < 1000; ++b) {
        std::vector<double> again;
        for (std::size_t i = 0; i < v.size(); ++i)
            again.push_back(v[static_cast<std::size_t>(draw.integer(static_cast<int>(v.size())))]);
        all.push_back(statistic(again));
    }
    std::sort(all.begin(), all.end());
    m.low = all[50];
    m.high = all[949];
    return m;
}

} // namespace

double Proportion::low() const {
    return wilson(*this, -1.0);
}

double Proportion::high() const {
    return wilson(*this, 1.0);
}

Estimate median(std::vector<double> values) {
    return withInterval(values, medianOf);
}

Estimate mean(const std::vector<double>& values) {
    return withInterval(values, meanOf);
}

} // namespace supercircle::blind_benchmark
