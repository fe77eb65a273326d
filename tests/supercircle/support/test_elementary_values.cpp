// Exact results, special values, signs of zero, symmetry and monotony of the elementary functions.

#include "supercircle/support/elementary.h"
#include "ulps.h"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

using namespace supercircle;
using test::Numbers;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Equal numbers with equal signs, or both NaN.
bool same(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}

} // namespace

TEST_CASE("special values of functions of one number are those of the C standard", "[elementary]") {
    // The C library is exact at these places.
    for (const double x : {0.0, -0.0, 1.0, -1.0, 2.0, -2.0, kInf, -kInf, kNan}) {
        INFO(x);
        if (x == 0.0 || !std::isfinite(x)) {
            CHECK(same(math::sin(x), std::sin(x)));
            CHECK(same(math::cos(x), std::cos(x)));
            CHECK(same(math::tan(x), std::tan(x)));
            CHECK(same(math::atan(x), std::atan(x)));
            CHECK(same(math::exp(x), std::exp(x)));
            CHECK(same(math::expm1(x), std::expm1(x)));
            CHECK(same(math::sinh(x), std::sinh(x)));
            CHECK(same(math::cosh(x), std::cosh(x)));
            CHECK(same(math::tanh(x), std::tanh(x)));
            CHECK(same(math::erfc(x), std::erfc(x)));
        }
        if (x != 2.0) {
            CHECK(same(math::log(x), std::log(x)));
            CHECK(same(math::log10(x), std::log10(x)));
            CHECK(same(math::asin(x), std::asin(x)));
            CHECK(same(math::acos(x), std::acos(x)));
        }
        if (x != 2.0 && x != 1.0)
            CHECK(same(math::log1p(x), std::log1p(x)));
        if (std::abs(x) != 2.0)
            CHECK(same(math::cbrt(x), std::cbrt(x)));
        CHECK(same(math::log2(x), std::log2(x)));
    }
    for (const double x : {5e-324, -5e-324, 1e-310, 1e-20})
        for (const auto f : {+[](double v) { return math::sin(v); }, &math::tan, &math::asin, &math::atan, &math::expm1,
                             &math::log1p, &math::sinh, &math::tanh})
            CHECK(f(x) == x);
    CHECK(math::exp(709.78271289338397) == Approx(1.79769313486228e308).epsilon(1e-14));
    CHECK(math::exp(709.79) == kInf);
    CHECK(math::exp(-745.14) == 0.0);
    CHECK(math::exp(-745.13) == 5e-324);
}

TEST_CASE("special values of functions of two numbers are those of the C standard", "[elementary]") {
    const double places[] = {0.0,  -0.0, 1.0,  -1.0,   kInf,    -kInf, kNan,   0.5,  -0.5,   2.0,
                             -2.0, 3.0,  -3.0, 5e-324, -5e-324, 1e308, -1e308, 1e17, 0x1p53, 9007199254740991.0};
    for (const double x : places)
        for (const double y : places) {
            INFO(x << " " << y);
            const bool exactAngle =
                x == 0.0 || y == 0.0 || !std::isfinite(x) || !std::isfinite(y) || std::abs(x) == std::abs(y);
            if (exactAngle)
                CHECK(same(math::atan2(y, x), std::atan2(y, x)));
            else
                CHECK(test::ulps(math::atan2(y, x),
                                 std::atan2(static_cast<long double>(y), static_cast<long double>(x))) < 1.0);
            CHECK(test::ulps(math::hypot(x, y), std::hypot(static_cast<long double>(x), static_cast<long double>(y))) <
                  1.0);
            CHECK(std::signbit(math::hypot(x, y)) == std::signbit(std::hypot(x, y)));
            const double power = std::pow(x, y);
            if (power == 0.0 || std::abs(power) == 1.0 || !std::isfinite(power))
                CHECK(same(math::pow(x, y), power));
            else
                CHECK(test::ulps(math::pow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y))) <
                      1.0);
        }
}

TEST_CASE("results that a double can hold are exact", "[elementary]") {
    int wrong = 0;
    const auto expect = [&](double a, double b) { wrong += a == b ? 0 : 1; };
    for (int n = -1074; n < 1024; ++n) {
        expect(math::pow(2.0, n), std::ldexp(1.0, n));
        expect(math::log2(std::ldexp(1.0, n)), n);
        if (n > -1024)
            expect(math::pow(0.5, n), std::ldexp(1.0, -n));
    }
    for (int base = 2; base < 200; ++base) {
        double power = base;
        for (int n = 2; power * base < 9e15; ++n) {
            power *= base;
            expect(math::pow(base, n), power);
            expect(math::pow(-base, n), n % 2 == 0 ? power : -power);
        }
    }
    double ten = 1.0;
    for (int n = 0; n <= 22; ++n, ten *= 10.0) { // 10^22 is the last that a double holds
        expect(math::log10(ten), n);
        expect(math::pow(10.0, n), ten);
    }
    for (int n = 1; n < 2000; ++n) {
        expect(math::cbrt(static_cast<double>(n) * n * n), n);
        expect(math::hypot(3.0 * n, 4.0 * n), 5.0 * n);
        expect(math::hypot(-5.0 * n, 12.0 * n), 13.0 * n);
        expect(math::pow(n * n, 0.5), n);
    }
    expect(math::acos(1.0), 0.0);
    expect(math::acos(-1.0), M_PI);
    expect(math::asin(1.0), M_PI_2);
    expect(math::atan(1.0), M_PI_4);
    expect(math::exp(0.0), 1.0);
    expect(math::log(1.0), 0.0);
    expect(math::log1p(0.0), 0.0);
    CHECK(wrong == 0);
}

TEST_CASE("odd and even functions are so to the last bit", "[elementary]") {
    Numbers n;
    int wrong = 0;
    const auto odd = [&](double (*f)(double), double x) { wrong += f(-x) == -f(x) ? 0 : 1; };
    const auto even = [&](double (*f)(double), double x) { wrong += f(-x) == f(x) ? 0 : 1; };
    for (int i = 0; i < 100000; ++i) {
        const double x = i % 2 == 0 ? n.exponents(1e-300, 1e300) : n.uniform(0.0, 20.0), y = n.uniform(0.0, 1.0);
        odd(math::sin, x);
        even(math::cos, x);
        even(math::sinc, x);
        odd(math::tan, x);
        odd(math::atan, x);
        odd(math::asin, y);
        odd(math::cbrt, x);
        odd(math::sinh, x);
        even(math::cosh, x);
        odd(math::tanh, x);
        wrong += math::atan2(-x, y) == -math::atan2(x, y) ? 0 : 1;
        wrong += math::hypot(x, y) == math::hypot(y, -x) ? 0 : 1;
        wrong += math::pow(-x, 3.0) == -math::pow(x, 3.0) ? 0 : 1;
    }
    CHECK(wrong == 0);
}

TEST_CASE("functions rise across the places where their formulas change", "[elementary]") {
    const auto rises = [](double (*f)(double), double at) {
        double x = at;
        for (int i = 0; i < 2000; ++i)
            x = std::nextafter(x, -kInf);
        int falls = 0;
        for (int i = 0; i < 4000; ++i) {
            const double next = std::nextafter(x, kInf);
            falls += f(next) < f(x) ? 1 : 0;
            x = next;
        }
        return falls == 0;
    };
    for (const double at : {7.0 / 16.0, 11.0 / 16.0, 19.0 / 16.0, 39.0 / 16.0, 0x1p-28, 0x1p60})
        CHECK(rises(math::atan, at));
    for (const double at : {0.5, -0.5, 0x1p-27})
        CHECK(rises(math::asin, at));
    for (const double at : {0.5 * M_LN2, 1.5 * M_LN2, -0.5 * M_LN2, 36.5 * M_LN2}) {
        CHECK(rises(math::exp, at));
        CHECK(rises(math::expm1, at));
    }
    for (const double at : {M_SQRT1_2, M_SQRT2, 1.0, 1024.0})
        CHECK(rises(math::log, at));
    for (const double at : {M_SQRT2 - 1.0, M_SQRT1_2 - 1.0, -0.2928, 0.4142})
        CHECK(rises(math::log1p, at));
    for (const double at : {1.0, 2.0, 4.0, 8.0})
        CHECK(rises(math::cbrt, at));
    for (const double at : {0.785, -0.785, 0.6744, 2.0 * M_PI})
        CHECK(rises(math::sin, at));
    for (const double at : {0.785, -0.785, 0.6744, 2.0 * M_PI, 1e5})
        CHECK(rises(math::tan, at));
}

TEST_CASE("results are those of every machine", "[elementary]") {
    // The sum was written by g++ on x86-64 and has no other meaning: it differs where a compiler contracts, reorders or
    // calls a library.
    std::mt19937_64 engine(5);
    std::uint64_t hash = 14695981039346656037U; // FNV-1a
    const auto add = [&](double v) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(std::isnan(v) ? 0.0 : v)) * 1099511628211U;
    };
    for (int i = 0; i < 20000; ++i) {
        const double any = std::bit_cast<double>(engine()), x = std::isnan(any) ? 1.0 : any,
                     y = static_cast<double>(engine() >> 11U) * 0x1p-50 - 4.0;
        for (const double v : {x, y})
            for (const auto f :
                 {+[](double a) { return math::sin(a); }, +[](double a) { return math::cos(a); },
                  +[](double a) { return math::sinc(a); }, +[](double a) { return math::tan(a); },
                  +[](double a) { return math::asin(0.25 * a); }, +[](double a) { return math::acos(0.25 * a); },
                  +[](double a) { return math::atan(a); }, +[](double a) { return math::exp(a); },
                  +[](double a) { return math::expm1(a); }, +[](double a) { return math::sinh(a); },
                  +[](double a) { return math::cosh(a); }, +[](double a) { return math::tanh(a); },
                  +[](double a) { return math::log(a); }, +[](double a) { return math::log1p(a); },
                  +[](double a) { return math::log10(a); }, +[](double a) { return math::log2(a); },
                  +[](double a) { return math::cbrt(a); }, +[](double a) { return math::erfc(a); }})
                add(f(v));
        add(math::atan2(x, y));
        add(math::atan2(y, x));
        add(math::hypot(x, y));
        add(math::pow(std::abs(x), y));
        add(math::pow(std::abs(y), 10.0 * y));
    }
    CHECK(hash == 0x4ee5fbec29ad9610U);
}
