#pragma once
// One contact alone: Signorini-Coulomb with a 2 x 2 Delassus block, solved in closed form.

#include <cstdint>

namespace supercircle::coulomb {

/// Contact status: on which of the four linear pieces of the planar law the contact lies. SlipPlus: u_t >= 0, r_t = -mu
/// r_n. SlipMinus: u_t <= 0, r_t = +mu r_n.
enum class ContactStatus : std::uint8_t { Open, Stick, SlipPlus, SlipMinus };

/// Sign of the sliding velocity: +1 or -1 for a slipping contact, 0 otherwise.
constexpr double slipSign(ContactStatus status) {
    return status == ContactStatus::SlipPlus ? 1.0 : status == ContactStatus::SlipMinus ? -1.0 : 0.0;
}

/// Impulse of one contact (N s) and its status.
struct LocalImpulse {
    double n = 0.0;
    double t = 0.0;
    ContactStatus status = ContactStatus::Open;
};

/// Rows of a contact with prescribed zero velocity and an impulse of either sign: none (Signorini-Coulomb), the normal
/// row (tangent free), or both.
enum class BilateralRows : std::uint8_t { None, Normal, Both };

/// Solves  u = W r + q  with  0 <= u_n perp r_n >= 0,  |r_t| <= mu r_n,  r_t = -mu r_n sign(u_t) where it slips.
/// Bilateral rows instead:  u_n = 0, r_t = 0 (Normal) or u = 0 (Both).
/// W (1/kg, symmetric positive definite) and mu >= 0 are fixed at construction, q (m/s) varies.
class LocalLaw {
public:
    LocalLaw() = default;
    LocalLaw(double wnn, double wnt, double wtt, double mu, BilateralRows bilateralRows = BilateralRows::None);

    /// The solution; law.cpp says when it is unique. A block with W_nn = 0 stays open, because no impulse can move it.
    LocalImpulse solve(double qn, double qt) const {
        if (bilateralRows_ != BilateralRows::None)
            return solveBilateral(qn, qt);
        if (qn >= 0.0 || inverseWnn_ <= 0.0)
            return {};
        double rt = stickN_ * qn - stickT_ * qt; // the impulse that stops the tangential motion
        ContactStatus status = ContactStatus::Stick;
        if (rt > -qn * upper_) {
            rt = -qn * upper_;
            status = ContactStatus::SlipMinus;
        } else if (rt < -qn * lower_) {
            rt = -qn * lower_;
            status = ContactStatus::SlipPlus;
        }
        const double rn = -(qn + wnt_ * rt) * inverseWnn_;
        return {rn > 0.0 ? rn : 0.0, rt, status};
    }

private:
    LocalImpulse solveBilateral(double qn, double qt) const;

    double inverseWnn_ = 0.0;
    double wnt_ = 0.0;
    double stickN_ = 0.0; ///< W_nt / det W
    double stickT_ = 0.0; ///< W_nn / det W
    double upper_ =
        0.0; ///< largest r_t on the line u_n = 0 inside the cone, for q_n = -1; infinite if the line stays inside
    double lower_ = 0.0; ///< smallest one
    BilateralRows bilateralRows_ = BilateralRows::None;
};

} // namespace supercircle::coulomb
