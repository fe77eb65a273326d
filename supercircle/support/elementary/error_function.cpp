// The complementary error function by the rational functions of fdlibm (Sun Microsystems 1993, s_erf.c; truncation
// below 2^-57).

#include "supercircle/support/elementary.h"
#include "supercircle/support/elementary/exponential.h"
#include "supercircle/support/elementary/wide.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace supercircle::math {

namespace {

template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
    double sum = 0.0;
    for (std::size_t i = N; i-- > 0;)
        sum = sum * x + c[i];
    return sum;
}

/// erf(x)/x - 1 for z = x^2, |x| < 0.84375.
double nearZero(double z) {
    static constexpr std::array kAbove = {1.28379167095512558561e-01, -3.25042107247001499370e-01,
                                          -2.84817495755985104766e-02, -5.77027029648944159157e-03,
                                          -2.37630166566501626084e-05};
    static constexpr std::array kBelow = {1.0,
                                          3.97917223959155352819e-01,
                                          6.50222499887672944485e-02,
                                          5.08130628187576562776e-03,
                                          1.32494738004321644526e-04,
                                          -3.96022827877536812320e-06};
    return polynomial(kAbove, z) / polynomial(kBelow, z);
}

constexpr double kAtOne = 8.45062911510467529297e-01; ///< about erf(1)

/// erf(1 + s) - kAtOne for |x| = 1 + s from 0.84375 to 1.25.
double nearOne(double s) {
    static constexpr std::array kAbove = {-2.36211856075265944077e-03, 4.14856118683748331666e-01,
                                          -3.72207876035701323847e-01, 3.18346619901161753674e-01,
                                          -1.10894694282396677476e-01, 3.54783043256182359371e-02,
                                          -2.16637559486879084300e-03};
    static constexpr std::array kBelow = {1.0,
                                          1.06420880400844228286e-01,
                                          5.40397917702171048937e-01,
                                          7.18286544141962662868e-02,
                                          1.26171219808761642112e-01,
                                          1.36370839120290507362e-02,
                                          1.19844998467991074170e-02};
    return polynomial(kAbove, s) / polynomial(kBelow, s);
}

/// log(x erfc(x)) + x^2 + 0.5625 for z = 1/x^2, x from 1.25 to 1/0.35.
double middle(double z) {
    static constexpr std::array kAbove = {-9.86494403484714822705e-03, -6.93858572707181764372e-01,
                                          -1.05586262253232909814e+01, -6.23753324503260060396e+01,
                                          -1.62396669462573470355e+02, -1.84605092906711035994e+02,
                                          -8.12874355063065934246e+01, -9.81432934416914548592e+00};
    static constexpr std::array kBelow = {1.0,
                                          1.96512716674392571292e+01,
                                          1.37657754143519042600e+02,
                                          4.34565877475229228821e+02,
                                          6.45387271733267880336e+02,
                                          4.29008140027567833386e+02,
                                          1.08635005541779435134e+02,
                                          6.57024977031928170135e+00,
                                          -6.04244152148580987438e-02};
    return polynomial(kAbove, z) / polynomial(kBelow, z);
}

/// The same for x above 1/0.35.
double far(double z) {
    static constexpr std::array kAbove = {-9.86494292470009928597e-03, -7.99283237680523006574e-01,
                                          -1.77579549177547519889e+01, -1.60636384855821916062e+02,
                                          -6.37566443368389627722e+02, -1.02509513161107724954e+03,
                                          -4.83519191608651397019e+02};
    static constexpr std::array kBelow = {1.0,
                                          3.03380607434824582924e+01,
                                          3.25792512996573918826e+02,
                                          1.53672958608443695994e+03,
                                          3.19985821950859553908e+03,
                                          2.55305040643316442583e+03,
                                          4.74528541206955367215e+02,
                                          -2.24409524465858183362e+01};
    return polynomial(kAbove, z) / polynomial(kBelow, z);
}

} // namespace

double erfc(double x) {
    if (std::isnan(x))
        return x;
    const double size = std::abs(x);
    if (size > 27.3)
        return x > 0.0 ? 0.0 : 2.0;
    if (size < 0x1p-56)
        return 1.0;
    if (size < 0.84375) {
        const Wide head = sum(1.0, -x);
        return head.hi + (head.lo - x * nearZero(x * x));
    }
    if (size < 1.25) {
        const double part = nearOne(size - 1.0);
        return x > 0.0 ? (1.0 - kAtOne) - part : 1.0 + (kAtOne + part);
    }
    const double z = 1.0 / (x * x);
    const Wide square = product(x, x);
    const Wide exponent = Wide{-square.hi, -square.lo} + sum(-0.5625, size < 1.0 / 0.35 ? middle(z) : far(z));
    const double tail = exponential(exponent) / size;
    return x > 0.0 ? tail : 2.0 - tail;
}

} // namespace supercircle::math
