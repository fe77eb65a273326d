// Stage Assemble: one Coulomb problem of contacts, joints and bodies of the host, with its warm start.

#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::step {

namespace {

/// Whether sizes and indices of a contact fit the bodies of the problem.
bool fits(const coulomb::Contact& c, const std::vector<coulomb::Body>& bodies) {
    const auto side = [&](std::int32_t body, const Eigen::Matrix<double, 2, Eigen::Dynamic>& H) {
        return body == -1 || (invariants::inRange(body, bodies.size()) &&
                              H.cols() == bodies[static_cast<std::size_t>(body)].vFree.size());
    };
    return side(c.a, c.Ha) && side(c.b, c.Hb);
}

[[maybe_unused]] bool isSymmetric(const Eigen::MatrixXd& A) {
    for (Eigen::Index j = 0; j < A.cols(); ++j)
        for (Eigen::Index i = j + 1; i < A.rows(); ++i)
            if (std::abs(A(i, j) - A(j, i)) > 1e-9 * std::sqrt(std::abs(A(i, i) * A(j, j))))
                return false;
    return true;
}

/// What the solver is promised. Numbers are its own business: it reports those that are not finite.
void assertComplete(const TrialStep& t) {
    const ContactStage& stage = t.stage;
    const coulomb::Problem& p = stage.problem;
    SC_ASSERT(p.dt == t.dt && p.dt > 0.0, "the problem is that of the step");
    SC_ASSERT(p.contacts.size() ==
                  stage.candidates.size() + stage.links.count + stage.host.entries.size() + stage.pushes.count,
              "contacts of candidates, links, the host and pushes");
    SC_ASSERT(p.r0.size() == 2 * static_cast<Eigen::Index>(p.contacts.size()),
              "the warm start has two numbers a contact");
    SC_ASSERT(stage.work.size() == stage.candidates.size(), "one work space a candidate");
    SC_ASSERT(stage.host.firstBlock <= p.bodies.size(), "blocks of the host stand behind the rods");
    for (const coulomb::Body& b : p.bodies)
        SC_ASSERT(b.A.rows() == b.vFree.size() && b.A.cols() == b.vFree.size(),
                  "A is square, one row for each degree of freedom");
    for (const coulomb::Contact& c : p.contacts)
        SC_ASSERT(fits(c, p.bodies), "rows fit the bodies they belong to");
    SC_ASSERT_EXPENSIVE(invariants::forAll(p.bodies.size(), [&](std::size_t b) { return isSymmetric(p.bodies[b].A); }),
                        "A is symmetric");
}

} // namespace

void assemble(const World& world, TrialStep& t) {
    t.enter(Stage::Assemble, Stage::Predict);
    couple(world, t.rods, t.dt, t.impulses, !t.first(), t.stage);
    for (const RodWork& w : t.rods)
        if (w.solved()) {
            t.result.work.rods += 1.0;
            t.result.work.freedoms += static_cast<double>(w.vFree.size() * w.vFree.size());
        }
    t.result.work.contacts += static_cast<double>(t.stage.problem.contacts.size());
    applyFrictionState(world, t.rods, t.dt, !t.first(), t.stage);
    assertComplete(t);
}

} // namespace supercircle::step
