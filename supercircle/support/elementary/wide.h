#pragma once
// Numbers in two words, hi + lo with |lo| at most half a unit in the last place of hi: about 106 bits. Sums: D. E.
// Knuth, The Art of Computer Programming 2, section 4.2.2. Products: T. J. Dekker, Numer. Math. 18 (1971) 224; they
// need factors below 2^996 and products above 2^-960.

#include <limits>

namespace supercircle::math {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Wide {
    double hi = 0.0;
    double lo = 0.0;
};

/// a + b without error for |a| >= |b| or a = 0.
inline Wide sumOfOrdered(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}

/// a + b without error.
inline Wide sum(double a, double b) {
    const double s = a + b, other = s - a;
    return {s, (a - (s - other)) + (b - other)};
}

/// The upper 26 bits of a, and the others.
inline Wide halves(double a) {
    const double shifted = 0x1.0000002p27 * a; // 2^27 + 1
    const double upper = shifted - (shifted - a);
    return {upper, a - upper};
}

/// a b without error.
inline Wide product(double a, double b) {
    const double p = a * b;
    const Wide x = halves(a), y = halves(b);
    return {p, ((x.hi * y.hi - p) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo};
}

inline Wide operator+(const Wide& a, const Wide& b) {
    const Wide s = sum(a.hi, b.hi);
    return sumOfOrdered(s.hi, s.lo + (a.lo + b.lo));
}

inline Wide operator*(const Wide& a, const Wide& b) {
    const Wide p = product(a.hi, b.hi);
    return sumOfOrdered(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

inline Wide operator/(const Wide& a, const Wide& b) {
    const double q = a.hi / b.hi;
    const Wide p = product(q, b.hi);
    return sumOfOrdered(q, (((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo)) / b.hi);
}

} // namespace supercircle::math
