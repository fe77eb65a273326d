#pragma once
// One contact alone: Signorini-Coulomb with a 2 x 2 Delassus block, solved in closed form.

#include <cstdint>

namespace supercircle::coulomb {

/// The four linear pieces of the planar law. SlipPlus: u_t >= 0, r_t = -mu r_n. SlipMinus: u_t <= 0, r_t = +mu r_n.
enum class Piece : std::uint8_t { Open, Stick, SlipPlus, SlipMinus };

/// Sign of the sliding velocity of a slipping piece: +1, -1, and 0 for the others.
constexpr double slipSign(Piece piece) {
    return piece == Piece::SlipPlus ? 1.0 : piece == Piece::SlipMinus ? -1.0 : 0.0;
}

/// Impulse of one contact (N s) and the piece of the law it lies on.
struct LocalImpulse {
    double n = 0.0;
    double t = 0.0;
    Piece piece = Piece::Open;
};

/// Which rows of a contact are held at zero velocity whatever their impulse: none (Signorini-Coulomb), the normal one
/// (tangent free), both.
enum class Tie : std::uint8_t { None, Normal, Both };

/// Solves  u = W r + q  with  0 <= u_n perp r_n >= 0,  |r_t| <= mu r_n,  r_t = -mu r_n sign(u_t) where it slips.
/// Tied rows instead:  u_n = 0, r_t = 0 (Normal) or u = 0 (Both).
/// W (1/kg, symmetric positive definite) and mu >= 0 are fixed at construction, q (m/s) varies.
class LocalLaw {
public:
    LocalLaw() = default;
    LocalLaw(double wnn, double wnt, double wtt, double mu, Tie tie = Tie::None);

    /// The solution; see law.cpp for when it is the only one. A block with W_nn = 0 stays open: no impulse can help it.
    LocalImpulse solve(double qn, double qt) const {
        if (tie_ != Tie::None)
            return solveTied(qn, qt);
        if (qn >= 0.0 || inverseWnn_ <= 0.0)
            return {};
        double rt = stickN_ * qn - stickT_ * qt; // the impulse that would stop the tangential motion
        Piece piece = Piece::Stick;
        if (rt > -qn * upper_) {
            rt = -qn * upper_;
            piece = Piece::SlipMinus;
        } else if (rt < -qn * lower_) {
            rt = -qn * lower_;
            piece = Piece::SlipPlus;
        }
        const double rn = -(qn + wnt_ * rt) * inverseWnn_;
        return {rn > 0.0 ? rn : 0.0, rt, piece};
    }

private:
    LocalImpulse solveTied(double qn, double qt) const;

    double inverseWnn_ = 0.0;
    double wnt_ = 0.0;
    double stickN_ = 0.0; ///< W_nt / det W
    double stickT_ = 0.0; ///< W_nn / det W
    double upper_ =
        0.0; ///< largest r_t on the line u_n = 0 inside the cone, for q_n = -1; infinite if the line never leaves
    double lower_ = 0.0; ///< smallest one
    Tie tie_ = Tie::None;
};

} // namespace supercircle::coulomb
