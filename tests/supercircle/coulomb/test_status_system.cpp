// The bordered factorisation against a new one, and both against the equations.

#include "supercircle/coulomb/pivoting/status_system.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using namespace supercircle::coulomb;

namespace {

ContactStatus anyStatus(generator::Random& random) {
    return static_cast<ContactStatus>(random.index(4));
}

/// Largest violation of the equations of a StatusSystem, relative to the right-hand side.
double violation(const MassNormalisedProblem& problem, const std::vector<ContactStatus>& status, double eps,
                 const std::vector<double>& rhs, const std::vector<double>& dr) {
    std::vector<double> w(problem.freeVelocity().size(), 0.0);
    double size = 1e-300;
    for (std::size_t c = 0; c < status.size(); ++c)
        problem.apply(problem.contact(c), dr[2 * c], dr[2 * c + 1], w.data());
    double worst = 0.0;
    for (std::size_t c = 0; c < status.size(); ++c) {
        const auto& contact = problem.contact(c);
        const auto u = problem.product(contact, w.data());
        const double un = u.n + eps * contact.d * dr[2 * c] - rhs[2 * c];
        const double ut = u.t + eps * contact.d * dr[2 * c + 1] - rhs[2 * c + 1];
        size = std::max({size, std::abs(rhs[2 * c]), std::abs(rhs[2 * c + 1])});
        if (status[c] == ContactStatus::Open)
            worst = std::max(worst, std::abs(dr[2 * c]) + std::abs(dr[2 * c + 1]));
        else
            worst = std::max(worst, std::abs(un));
        if (status[c] == ContactStatus::Stick)
            worst = std::max(worst, std::abs(ut));
        else
            worst = std::max(worst, std::abs(dr[2 * c + 1] + slipSign(status[c]) * contact.mu * dr[2 * c]));
    }
    return worst / size;
}

void compare(const Problem& source, generator::Random& random, int flips) {
    MassNormalisedProblem problem;
    REQUIRE(problem.build(source).empty());
    const std::size_t count = problem.contactCount();
    std::vector<std::int32_t> contacts(count);
    std::iota(contacts.begin(), contacts.end(), 0);
    std::vector<ContactStatus> status(count);
    for (ContactStatus& p : status)
        p = anyStatus(random);
    std::vector<double> rhs(2 * count), dr(2 * count);
    for (double& x : rhs)
        x = random.uniform(-1.0, 1.0);
    const double eps = 1e-2; // keeps random blocks far from singular: 1e-9 is round-off times the condition
    StatusSystem system;
    REQUIRE(system.factor(problem, contacts, status, eps));
    system.setRightHandSide(rhs);
    REQUIRE(system.solve(dr));
    CHECK(violation(problem, status, eps, rhs, dr) < 1e-9);
    for (int k = 0; k < flips; ++k) {
        const std::size_t c = static_cast<std::size_t>(random.index(static_cast<int>(count)));
        status[c] = anyStatus(random);
        system.setStatus(problem, c, status[c]);
        CHECK(system.status(c) == status[c]);
    }
    REQUIRE(system.solve(dr));
    CHECK(violation(problem, status, eps, rhs, dr) < 1e-9);
}

} // namespace

TEST_CASE("a bordered factorisation solves the equations of the new statuses") {
    generator::Random random(17);
    for (int k = 0; k < 40; ++k)
        compare(generator::cloud({.bodies = 6, .contacts = 12, .mu = 0.3, .duplicates = 0.2, .self = 0.2}, random),
                random, 20);
    compare(generator::nest({.shells = 4, .perPair = 12}, random), random, 30);
}

TEST_CASE("so does the sparse factorisation") {
    generator::Random random(18);
    const Problem large = generator::cloud({.bodies = 150, .contacts = 500, .mu = 0.3}, random);
    compare(large, random, 30);
}
