// One contact in the plane. Where q_n < 0 the contact must close. Then u_n = 0 is a line in the (r_n, r_t) plane, along
// which u_t grows strictly with r_t (slope det W / W_nn). The cone cuts an interval [lower, upper] out of the line. If
// u_t = 0 lies inside, the contact sticks. Otherwise it slips at the nearer end. There is exactly one solution for
// every symmetric positive definite W and every mu >= 0. If W_nn - mu |W_nt| <= 0, the line stays inside the cone on
// one side; that end is infinite and cannot slip.
//
// Where q_n >= 0, r = 0 is a solution, and the only one if W_nn > mu |W_nt|. Otherwise (the Painleve regime) jammed
// solutions with r_n > 0 exist, too. r = 0 is chosen, so that the result does not depend on history.
//
// Singular W: the sticking impulse is computed with a floor on det W and clamped to the cone. Bilateral rows have no
// cone; there 1e-12 of the trace is added to the diagonal, which keeps the impulse at the size of the load.

#include "supercircle/coulomb/law.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <limits>

namespace supercircle::coulomb {

namespace {
constexpr double kSingular = 1e-15; // det W below this fraction of (tr W)^2 is round-off
constexpr double kBilateralSingular =
    1e-12; // the same for bilateral rows, and the fraction of tr W then added to the diagonal
} // namespace

LocalLaw::LocalLaw(double wnn, double wnt, double wtt, double mu, BilateralRows bilateralRows)
    : bilateralRows_(bilateralRows) {
    SC_ASSERT(!(wnn < 0.0) && !(wtt < 0.0), "the diagonal of a Delassus block is not negative");
    SC_ASSERT(!(mu < 0.0), "a friction coefficient is not negative");
    if (bilateralRows == BilateralRows::Both) {
        const double size = wnn + wtt;
        const double extra = wnn * wtt - wnt * wnt > kBilateralSingular * size * size ? 0.0 : kBilateralSingular * size;
        const double det = (wnn + extra) * (wtt + extra) - wnt * wnt;
        if (!(size > 0.0) || !(det > 0.0))
            return;
        inverseWnn_ = 1.0 / (wnn + extra);
        wnt_ = wnt;
        stickN_ = wnt / det;
        stickT_ = (wnn + extra) / det;
        return;
    }
    if (!(wnn > 0.0))
        return;
    if (bilateralRows == BilateralRows::Normal) {
        inverseWnn_ = 1.0 / wnn;
        return;
    }
    const double trace = wnn + wtt;
    const double det = std::max(wnn * wtt - wnt * wnt, kSingular * trace * trace);
    inverseWnn_ = 1.0 / wnn;
    wnt_ = wnt;
    stickN_ = wnt / det;
    stickT_ = wnn / det;
    // r_n = (1 - W_nt r_t) / W_nn on the line for q_n = -1; r_t = +-mu r_n at the edges of the cone.
    const double up = wnn + mu * wnt;
    const double down = wnn - mu * wnt;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    upper_ = up > 0.0 ? mu / up : infinity;
    lower_ = down > 0.0 ? -mu / down : -infinity;
    SC_ASSERT_EXPENSIVE(!(lower_ > 0.0) && !(upper_ < 0.0), "r_t = 0 lies inside the cone");
    SC_ASSERT_EXPENSIVE(!(stickT_ < 0.0), "a tangential impulse acts against the slip");
}

LocalImpulse LocalLaw::solveBilateral(double qn, double qt) const {
    const double rt = bilateralRows_ == BilateralRows::Both ? stickN_ * qn - stickT_ * qt : 0.0;
    return {-(qn + wnt_ * rt) * inverseWnn_, rt,
            bilateralRows_ == BilateralRows::Both ? ContactStatus::Stick : ContactStatus::SlipPlus};
}

} // namespace supercircle::coulomb
