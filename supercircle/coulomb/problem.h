#pragma once
// One frictional contact problem as plain data: input of the solver and of the residual evaluation, content of an FCP2D
// file. It knows no rods, no geometry, and of time stepping only `dt`.

#include "supercircle/support/parallel.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::coulomb {

/// One body: its (generalised) velocity obeys  A v = A v_free + sum of H^T r  over its contacts.
struct Body {
    Eigen::MatrixXd A;     ///< n x n, symmetric positive definite (generalised mass, kg-like)
    Eigen::VectorXd vFree; ///< n, velocity without contact impulses (m/s-like)
};

/// The law of a contact.
enum class ContactKind : std::uint8_t {
    Unilateral, ///< Signorini-Coulomb: compression only, friction with mu
    Bilateral   ///< a joint point: u_n = 0 with r_n of either sign; tangent locked (mu infinite) or free (mu = 0)
};

/// One contact between body `a` and body `b` (or a fixed or driven surface, b = -1).
/// Relative velocity u = Ha v_a + Hb v_b + w, row 0 normal (positive opens), row 1 tangent.
struct Contact {
    std::int32_t a = -1;
    std::int32_t b = -1;
    double mu = 0.0;                             ///< friction coefficient, 1; bilateral: 0 or infinity only
    Eigen::Vector2d w = Eigen::Vector2d::Zero(); ///< m/s; w_n carries gap/dt
    Eigen::Matrix<double, 2, Eigen::Dynamic> Ha; ///< 2 x n_a
    Eigen::Matrix<double, 2, Eigen::Dynamic> Hb; ///< 2 x n_b (its sign included); empty when b = -1
    std::uint64_t id = 0;                        ///< stable feature id, 0 if unknown; not stored in FCP2D files
    ContactKind kind = ContactKind::Unilateral;

    bool bilateral() const { return kind == ContactKind::Bilateral; }
    bool locked() const { return bilateral() && mu > 0.0; } ///< u_t = 0 as well, whatever r_t
};

/// Find impulses r (2 per contact, N s) with  0 <= u_n  perp  r_n >= 0,  |r_t| <= mu r_n,
/// and r_t = -mu r_n sign(u_t) where the contact slips (Signorini-Coulomb). Bilateral contacts: u_n = u_t = 0 with any
/// r if mu is infinite; u_n = 0 and r_t = 0 if mu = 0.
struct Problem {
    double dt = 0.0; ///< s
    std::vector<Body> bodies;
    std::vector<Contact> contacts;
    Eigen::VectorXd r0; ///< warm start, 2 per contact (n, t), or empty
};

/// Empty if sizes, indices, signs and numbers are valid, else one sentence that names the invalid body or contact. The
/// solver reports an A that is not positive definite, because only the factorisation shows it.
[[nodiscard]] std::string validate(const Problem& problem, const parallel::For& loop = {});

} // namespace supercircle::coulomb
