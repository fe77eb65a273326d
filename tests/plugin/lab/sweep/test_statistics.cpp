// Statistics against closed forms, and the distribution of the p values of the normality test.

#include "plugin/lab/sweep/statistics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

using namespace supercircle::sweep;

namespace {

/// Fraction of samples of n values with a p value below 0.05.
template <typename Draw>
double rejectedFraction(std::size_t n, int samples, const Draw& draw) {
    int rejected = 0;
    for (int i = 0; i < samples; ++i) {
        std::vector<double> values;
        for (std::size_t k = 0; k < n; ++k)
            values.push_back(draw());
        rejected += normalityTest(values) < 0.05 ? 1 : 0;
    }
    return static_cast<double>(rejected) / samples;
}

} // namespace

TEST_CASE("mean, median, deviations and interval of four numbers, worked out by hand") {
    const Statistics s = statisticsOf({4.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 2.0, 9.0});
    CHECK(s.n == 4); // NaN does not count
    CHECK(s.mean == Approx(4.0));
    CHECK(s.median == Approx(3.0));
    CHECK(s.mad == Approx(1.5)); // distances 2, 1, 1, 6
    CHECK(s.madSigma == Approx(1.4826 * 1.5).epsilon(1e-5));
    CHECK(s.deviation == Approx(std::sqrt(38.0 / 3.0)));
    CHECK(s.standardError == Approx(std::sqrt(38.0 / 3.0) / 2.0));
    CHECK(s.high - s.mean == Approx(3.182446 * s.standardError).epsilon(1e-6)); // Student, 3 degrees of freedom
    CHECK(s.mean - s.low == Approx(s.high - s.mean));
    CHECK(s.skewness == Approx((-27.0 - 8.0 + 0.0 + 125.0) / 4.0 / std::pow(38.0 / 4.0, 1.5)));
}

TEST_CASE("statistics of no, one and equal numbers: undefined ones are NaN") {
    CHECK(statisticsOf({}).n == 0);
    CHECK(std::isnan(statisticsOf({}).mean));
    const Statistics one = statisticsOf({2.0});
    CHECK(one.mean == 2.0);
    CHECK(one.mad == 0.0);
    CHECK(std::isnan(one.deviation));
    const Statistics equal = statisticsOf(std::vector<double>(20, 0.1));
    CHECK(equal.deviation == Approx(0.0).margin(1e-15));
    CHECK(std::isnan(equal.normality));
}

TEST_CASE("the MAD estimates a Gaussian's standard deviation and is robust against outliers") {
    std::mt19937_64 engine(1); // NOLINT: the same numbers every time
    std::normal_distribution<double> gauss(3.0, 0.5);
    std::vector<double> values;
    for (int i = 0; i < 20'000; ++i)
        values.push_back(gauss(engine));
    CHECK(statisticsOf(values).madSigma == Approx(0.5).epsilon(0.03)); // its own deviation is 0.8 %
    for (int i = 0; i < 200; ++i)
        values.push_back(1e6);
    CHECK(statisticsOf(values).madSigma == Approx(0.5).epsilon(0.05));
}

TEST_CASE("the normality test rejects one Gaussian sample in twenty, and most others") {
    std::mt19937_64 engine(7);
    std::normal_distribution<double> gauss(-4.0, 1e-3);
    std::exponential_distribution<double> exponential(2.0);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const std::size_t n : {8U, 20U, 100U}) // binomial standard deviation of the fraction: 0.0049
        CHECK(rejectedFraction(n, 2000, [&] { return gauss(engine); }) == Approx(0.05).margin(0.017));
    CHECK(rejectedFraction(50, 200, [&] { return exponential(engine); }) > 0.95);
    CHECK(rejectedFraction(100, 200, [&] { return uniform(engine); }) > 0.9);
    CHECK(std::isnan(normalityTest({1, 2, 3, 4, 5, 6, 7})));
}

TEST_CASE("the normality test does not depend on unit and origin") {
    std::mt19937_64 engine(3);
    std::exponential_distribution<double> draw(1.0);
    std::vector<double> values, scaled;
    for (int i = 0; i < 25; ++i) {
        values.push_back(draw(engine));
        scaled.push_back(1e-3 * values.back() - 2.0);
    }
    CHECK(normalityTest(values) == Approx(normalityTest(scaled)).epsilon(1e-8));
}
