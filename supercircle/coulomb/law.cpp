// One contact in the plane. Where q_n < 0 the contact must close: u_n = 0 is a line in the (r_n, r_t) plane, and along
// it u_t grows strictly with r_t (slope det W / W_nn). The cone cuts an interval [lower, upper] out of the line. Either
// u_t = 0 falls inside (stick), or the nearer end is the answer and u_t has the sign friction asks for (slip). So:
//
//   q_n < 0   exactly one solution for every symmetric positive definite W and every mu >= 0. Where
//             W_nn - mu |W_nt| <= 0 the line never leaves the cone on one side: that end is infinite and cannot slip.
//   q_n >= 0  r = 0 is a solution. It is the only one as long as W_nn > mu |W_nt|; beyond (the Painleve regime: steep
//             coupling, large mu) jammed solutions with r_n > 0 exist as well. We take r = 0, which is what makes the
//             answer free of history. Neighbouring q_n < 0 may then give a finite impulse: the law itself jumps there.
//
// A singular W (a body with one freedom, a contact that cannot slide) is treated by a floor on det W: the sticking
// impulse becomes huge and is clamped to the cone, which is the limit of the law for a W slightly above singular.
//
// Tied rows have no cone to clamp to. There a singular W (two welds on a body with one freedom) gets a term on its
// diagonal, 1e-12 of its trace: the velocity is met to that accuracy and the impulse stays of the size of the load.

#include "supercircle/coulomb/law.h"

#include <algorithm>
#include <limits>

namespace supercircle::coulomb {

namespace {
constexpr double kSingular = 1e-15; // det W below this share of (tr W)^2 is round-off
constexpr double kTied = 1e-12;     // the same for tied rows, and the share of tr W then added to the diagonal
} // namespace

LocalLaw::LocalLaw(double wnn, double wnt, double wtt, double mu, Tie tie) : tie_(tie) {
    if (tie == Tie::Both) {
        const double size = wnn + wtt;
        const double extra = wnn * wtt - wnt * wnt > kTied * size * size ? 0.0 : kTied * size;
        const double tied = (wnn + extra) * (wtt + extra) - wnt * wnt;
        if (!(size > 0.0) || !(tied > 0.0))
            return;
        inverseWnn_ = 1.0 / (wnn + extra);
        wnt_ = wnt;
        stickN_ = wnt / tied;
        stickT_ = (wnn + extra) / tied;
        return;
    }
    if (!(wnn > 0.0))
        return;
    if (tie == Tie::Normal) {
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
}

LocalImpulse LocalLaw::solveTied(double qn, double qt) const {
    const double rt = tie_ == Tie::Both ? stickN_ * qn - stickT_ * qt : 0.0;
    return {-(qn + wnt_ * rt) * inverseWnn_, rt, tie_ == Tie::Both ? Piece::Stick : Piece::SlipPlus};
}

} // namespace supercircle::coulomb
