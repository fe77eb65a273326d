// Subdomains of a large island, paths inside them, and the large problems that need them.

#include "supercircle/coulomb/pivoting/path_follower.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/subdomains.h"
#include "tests/supercircle/coulomb/generator.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

using namespace supercircle::coulomb;

namespace {

/// A solved nest a little later: forces and gaps have changed, the solution is the warm start.
Problem warmNest(int shells, std::uint64_t seed) {
    generator::Random random(seed);
    Problem problem = generator::nest({.shells = shells, .perPair = 10, .force = 2.0, .side = 2}, random);
    Solver solver;
    std::vector<Eigen::VectorXd> v;
    REQUIRE(solver.solve(problem, {}, problem.r0, v).converged);
    for (Body& body : problem.bodies)
        body.vFree *= random.uniform(0.95, 1.05);
    for (Contact& contact : problem.contacts)
        contact.w[0] = std::max(0.0, contact.w[0] + 5e-8 / problem.dt * random.uniform(-1.0, 1.0));
    return problem;
}

} // namespace

TEST_CASE("a subdomain holds all contacts of its bodies, inside or outside") {
    generator::Random random(3);
    MassNormalisedProblem problem;
    REQUIRE(problem.build(generator::cloud({.bodies = 80, .contacts = 400, .self = 0.1}, random)).empty());
    Subdomains subdomains;
    subdomains.prepare(problem);
    for (const std::int32_t seed : {0, 17, 399, 200, 17}) {
        const Subdomain subdomain = *subdomains.grow(problem, seed, 40);
        CHECK(std::is_sorted(subdomain.contacts.begin(), subdomain.contacts.end()));
        CHECK(std::binary_search(subdomain.contacts.begin(), subdomain.contacts.end(), seed));
        CHECK(std::find(subdomain.core.begin(), subdomain.core.end(), seed) != subdomain.core.end());
        std::set<std::int32_t> bodies;
        for (const std::int32_t c : subdomain.contacts)
            for (std::int32_t s = 0; s < problem.contact(c).sides; ++s)
                bodies.insert(problem.contact(c).side[s].body);
        CHECK(bodies.size() < problem.bodyCount());
        std::set<std::int32_t> inside(subdomain.contacts.begin(), subdomain.contacts.end());
        std::set<std::int32_t> outside(subdomain.outside.begin(), subdomain.outside.end());
        CHECK(inside.size() == subdomain.contacts.size());
        CHECK(outside.size() == subdomain.outside.size());
        for (std::size_t c = 0; c < problem.contactCount(); ++c) {
            bool touches = false;
            for (std::int32_t s = 0; s < problem.contact(c).sides; ++s)
                touches = touches || bodies.count(problem.contact(c).side[s].body) > 0;
            const auto index = static_cast<std::int32_t>(c);
            CHECK(inside.count(index) * outside.count(index) == 0);
            if (touches)
                CHECK(inside.count(index) + outside.count(index) == 1);
        }
    }
}

TEST_CASE("a subdomain does not grow into a busy body") {
    generator::Random random(13);
    const Problem source = generator::nest({.shells = 12, .perPair = 10}, random);
    MassNormalisedProblem problem;
    REQUIRE(problem.build(source).empty());
    Subdomains subdomains;
    subdomains.prepare(problem);
    const std::vector<std::int32_t> inside = subdomains.grow(problem, 0, 40)->contacts;
    std::vector<std::uint8_t> busy(source.bodies.size(), 1);
    for (const std::int32_t c : inside)
        for (const std::int32_t body : {source.contacts[c].a, source.contacts[c].b})
            if (body >= 0)
                busy[body] = 0;
    REQUIRE(std::count(busy.begin(), busy.end(), 1) > 0);
    REQUIRE(subdomains.grow(problem, 0, 40, busy) != nullptr); // its own bodies are not busy
    CHECK(subdomains.grow(problem, 0, 40, busy)->contacts == inside);
    CHECK(subdomains.grow(problem, 0, 400, busy) == nullptr);
    busy[source.contacts[0].a] = 1;
    CHECK(subdomains.grow(problem, 0, 40, busy) == nullptr);
    CHECK(subdomains.grow(problem, 0, 40)->contacts == inside); // a failed attempt leaves no trace
}

TEST_CASE("a path in a subdomain solves it and changes nothing else") {
    const Problem source = warmNest(6, 4);
    MassNormalisedProblem problem;
    REQUIRE(problem.build(source).empty());
    SolverState x;
    x.start(problem, source.r0);
    const SolverState before = x;
    Subdomains subdomains;
    subdomains.prepare(problem);
    const Subdomain subdomain = *subdomains.grow(problem, 0, problem.contactCount() / 3);
    REQUIRE_FALSE(subdomain.outside.empty());
    PathFollower path;
    PathCounts counts;
    const double allowed = 1e-20; // J, far below the error at the start
    const PathFollower::Termination termination =
        path.run(problem, subdomain.contacts, subdomain.outside, {1e-6, 0.3, 0, 600, 20}, allowed, x, counts);
    CHECK(termination == PathFollower::Termination::Solved);
    std::set<std::int32_t> inside(subdomain.contacts.begin(), subdomain.contacts.end());
    for (std::size_t c = 0; c < problem.contactCount(); ++c)
        if (inside.count(static_cast<std::int32_t>(c)) == 0) {
            CHECK(x.r[2 * c] == before.r[2 * c]);
            CHECK(x.r[2 * c + 1] == before.r[2 * c + 1]);
        }
    std::vector<double> w;
    problem.assemble(x.r, w);
    double size = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) {
        size = std::max(size, std::abs(w[i]));
        difference = std::max(difference, std::abs(w[i] - x.w[i]));
    }
    CHECK(difference <= 1e-12 * size); // round-off of sums in another order
    ResidualSum sum;
    for (const std::int32_t c : subdomain.contacts) {
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, w.data());
        sum.add(u.n, u.t, contact.qn, contact.qt, x.r[2 * c], x.r[2 * c + 1], contact.mu, contact.d);
    }
    CHECK(sum.error() <= 2.0 * allowed);
}

TEST_CASE("a large warm island is solved without Gauss-Seidel iterations, twice with the same result") {
    const Problem problem = warmNest(40, 5);
    Solver solver;
    Eigen::VectorXd r, again;
    std::vector<Eigen::VectorXd> v;
    const SolveReport report = solver.solve(problem, {}, r, v);
    CHECK(report.activeContacts > 200); // otherwise the island is not large
    CHECK(report.converged);
    CHECK(report.gaussSeidelIterations == 0);
    CHECK(evaluateResidual(problem, r).contactResidual <= 1.01e-8);
    Solver other; // another work space at other addresses
    other.solve(problem, {}, again, v);
    CHECK((r.array() == again.array()).all());
}

TEST_CASE("the statuses of a warm start survive a change of the time step") {
    generator::Random random(9);
    Problem problem = generator::nest({.shells = 5, .perPair = 10, .force = 2.0}, random);
    Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
    REQUIRE(solver.solve(problem, {}, r, v).converged);
    MassNormalisedProblem normalised;
    REQUIRE(normalised.build(problem).empty());
    SolverState x, scaled;
    x.start(normalised, r);
    scaled.start(normalised, (r / 3e-4) * 1e-4); // as a simulation passes it on
    CHECK(std::count(x.status.begin(), x.status.end(), ContactStatus::Stick) > 0);
    CHECK(x.status == scaled.status);
}
