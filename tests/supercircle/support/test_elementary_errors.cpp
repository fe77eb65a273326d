// Errors of the elementary functions against long double. Bounds are those of the header; nothing here was fitted: each
// function is tried where its reduction changes, over its whole range and over random arguments.

#include "supercircle/support/elementary.h"
#include "ulps.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace supercircle;
using test::Numbers;
using test::ulps;

namespace {

struct Range {
    double from = 0.0;
    double to = 0.0;
    bool exponents = false; ///< uniform exponent
};

/// Largest error in units in the last place over the ranges: dense, and random.
double worst(double (*own)(double), long double (*exact)(long double), const std::vector<Range>& ranges) {
    Numbers numbers;
    double largest = 0.0;
    for (const Range& r : ranges) {
        constexpr int kDense = 30000;
        for (int i = 0; i <= kDense && !r.exponents; ++i) {
            const double x = r.from + (r.to - r.from) * i / kDense;
            largest = std::max(largest, ulps(own(x), exact(x)));
        }
        for (int i = 0; i < 60000; ++i) {
            const double x = r.exponents ? numbers.exponents(r.from, r.to) : numbers.uniform(r.from, r.to);
            largest = std::max(largest, ulps(own(x), exact(x)));
        }
    }
    return largest;
}

#define WORST(FUNCTION, ...)                                                                                           \
    worst([](double x) { return math::FUNCTION(x); }, [](long double x) -> long double { return std::FUNCTION(x); },   \
          {__VA_ARGS__})

template <class X, class Y>
double worstOfTwo(double (*own)(double, double), long double (*exact)(long double, long double), X x, Y y) {
    double largest = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double a = x(), b = y();
        largest = std::max(largest, ulps(own(a, b), exact(a, b)));
    }
    return largest;
}

double power(double x, double y) {
    return math::pow(x, y);
}
long double exactPower(long double x, long double y) {
    return std::pow(x, y);
}

constexpr double kLeast = 5e-324, kMost = 1.7e308; // subnormal numbers included

} // namespace

TEST_CASE("trigonometric functions err by less than one unit in the last place at any angle", "[elementary]") {
    const std::vector<Range> ranges = {
        {-0.8, 0.8}, {-100.0, 100.0}, {-1e5, 1e5}, {kLeast, 1.0, true}, {1.0, kMost, true}};
    CHECK(worst(
              math::sin, [](long double x) -> long double { return std::sin(x); }, ranges) < 1.0);
    CHECK(worst(
              math::cos, [](long double x) -> long double { return std::cos(x); }, ranges) < 1.0);
    CHECK(worst(
              math::tan, [](long double x) -> long double { return std::tan(x); }, ranges) < 1.0);
}

TEST_CASE("trigonometric functions err by less than one unit beside the multiples of pi/2", "[elementary]") {
    double largest = 0.0;
    for (int i = -70000; i<70000; i += i> - 400 && i < 400 ? 1 : 173) {
        double x = i * M_PI_2;
        for (int step = 0; step < 3; ++step, x = std::nextafter(x, 1e300)) {
            const long double exact = x;
            largest = std::max({largest, ulps(math::sin(x), std::sin(exact)), ulps(math::cos(x), std::cos(exact)),
                                ulps(math::tan(x), std::tan(exact))});
        }
    }
    CHECK(largest < 1.0);
    // The double that is nearest to a multiple of pi/2 (W. Kahan, 1983); its cosine has 61 leading zeros.
    const double nearest = std::ldexp(6381956970095103.0, 797);
    CHECK(math::cos(nearest) == -4.6871659242546277e-19);
    CHECK(math::sin(nearest) == 1.0);
}

TEST_CASE("inverse trigonometric functions err by less than one unit in the last place", "[elementary]") {
    CHECK(WORST(asin, {-1.0, 1.0}, {0.49, 0.51}, {0.999, 1.0}, {kLeast, 1.0, true}) < 1.0);
    CHECK(WORST(acos, {-1.0, 1.0}, {0.49, 0.51}, {0.999, 1.0}, {-1.0, -0.999}, {kLeast, 1.0, true}) < 1.0);
    CHECK(WORST(atan, {-4.0, 4.0}, {0.4, 0.8}, {1.0, 2.6}, {kLeast, kMost, true}) < 1.0);
    Numbers n;
    const auto atan2 = [](double y, double x) { return math::atan2(y, x); };
    const auto exact = [](long double y, long double x) -> long double { return std::atan2(y, x); };
    const auto sign = [&] { return n.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0; };
    const auto unit = [&] { return n.uniform(-1.0, 1.0); };
    const auto any = [&] { return sign() * n.exponents(kLeast, kMost); };
    const auto near = [&] { return sign() * n.exponents(1e-3, 1e3); };
    CHECK(worstOfTwo(atan2, exact, unit, unit) < 1.0);
    CHECK(worstOfTwo(atan2, exact, any, any) < 1.0);
    CHECK(worstOfTwo(atan2, exact, near, unit) < 1.0);
    CHECK(worstOfTwo(
              atan2, exact, [&] { return n.exponents(1e301, kMost); }, [&] { return n.exponents(1e301, kMost); }) <
          1.0);
    CHECK(worstOfTwo(
              atan2, exact, [&] { return n.exponents(1e-320, 1e-305); }, [&] { return n.exponents(1e-320, 1e-305); }) <
          1.0);
}

TEST_CASE("exponentials err by less than one unit in the last place", "[elementary]") {
    CHECK(WORST(exp, {-1.0, 1.0}, {-746.0, 709.78}, {-745.2, -708.0}, {kLeast, 1.0, true}) < 0.76);
    CHECK(WORST(expm1, {-1.0, 1.0}, {-2.0, 2.0}, {-40.0, 709.78}, {33.0, 42.0}, {kLeast, 1.0, true}) < 1.0);
    CHECK(WORST(sinh, {-2.0, 2.0}, {-30.0, 30.0}, {-710.4, 710.4}, {kLeast, 1.0, true}) < 2.5);
    CHECK(WORST(cosh, {-2.0, 2.0}, {-30.0, 30.0}, {-710.4, 710.4}, {kLeast, 1.0, true}) < 1.0);
    CHECK(WORST(tanh, {-2.0, 2.0}, {-30.0, 30.0}, {kLeast, 1.0, true}) < 2.5);
    CHECK(WORST(erfc, {-6.0, 27.2}, {-1.3, 1.3}, {1.2, 3.0}, {3.0, 26.5}) < 2.5);
}

TEST_CASE("logarithms err by less than one unit in the last place", "[elementary]") {
    CHECK(WORST(log, {0.5, 2.0}, {0.99, 1.01}, {kLeast, kMost, true}) < 1.0);
    CHECK(WORST(log10, {0.5, 2.0}, {0.99, 1.01}, {kLeast, kMost, true}) < 0.51);
    CHECK(WORST(log2, {0.5, 2.0}, {0.99, 1.01}, {kLeast, kMost, true}) < 0.51);
    CHECK(WORST(log1p, {-1.0, 1.0}, {-0.3, -0.29}, {0.41, 0.42}, {-0.9999999, -0.9}, {kLeast, kMost, true}) < 1.0);
}

TEST_CASE("powers and roots err by less than one unit in the last place", "[elementary]") {
    CHECK(WORST(cbrt, {-10.0, 10.0}, {0.9, 1.1}, {kLeast, kMost, true}) < 0.67);
    Numbers n;
    const auto any = [&] { return n.exponents(kLeast, kMost); };
    const auto middle = [&] { return n.exponents(1e-4, 1e4); };
    const auto hypot = [](double x, double y) { return math::hypot(x, y); };
    const auto exact = [](long double x, long double y) -> long double { return std::hypot(x, y); };
    CHECK(worstOfTwo(hypot, exact, any, any) < 1.0);
    CHECK(worstOfTwo(hypot, exact, middle, middle) < 1.0);
    CHECK(worstOfTwo(power, exactPower, middle, [&] { return n.uniform(-70.0, 70.0); }) < 0.62);
    CHECK(worstOfTwo(power, exactPower, any, [&] { return n.uniform(-2.0, 2.0); }) < 0.76);
    CHECK(worstOfTwo(
              power, exactPower, [&] { return n.uniform(0.9995, 1.0005); }, [&] { return n.uniform(-5e5, 5e5); }) <
          0.62);
    CHECK(worstOfTwo(
              power, exactPower, [&] { return n.uniform(0.5, 2.0); }, [&] { return n.uniform(-700.0, 700.0); }) < 0.62);
}
