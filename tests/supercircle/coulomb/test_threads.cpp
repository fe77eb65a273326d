// Islands and subdomains on several threads: bitwise the same results as one after the other.

#include "supercircle/coulomb/solver.h"
#include "tests/supercircle/coulomb/generator.h"
#include "tests/support/loops.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace supercircle::coulomb;

namespace {

void append(Problem& all, const Problem& part) {
    const auto shift = static_cast<std::int32_t>(all.bodies.size());
    all.bodies.insert(all.bodies.end(), part.bodies.begin(), part.bodies.end());
    for (Contact contact : part.contacts) {
        contact.a += contact.a >= 0 ? shift : 0;
        contact.b += contact.b >= 0 ? shift : 0;
        all.contacts.push_back(contact);
    }
}

struct ThreadSolution {
    SolveReport report;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
};

ThreadSolution solve(const Problem& problem, const SolverOptions& options, const parallel::For& loop) {
    Solver solver;
    ThreadSolution solution;
    solution.report = solver.solve(problem, options, solution.r, solution.v, loop);
    return solution;
}

void checkSame(const Problem& problem, const SolverOptions& options = {}) {
    const ThreadSolution plain = solve(problem, options, {});
    for (const parallel::For& loop : {test::backwards(), test::threads(2), test::threads(5)}) {
        const ThreadSolution other = solve(problem, options, loop);
        CHECK(other.r == plain.r); // bit for bit
        for (std::size_t b = 0; b < plain.v.size(); ++b)
            CHECK(other.v[b] == plain.v[b]);
        CHECK((other.report.pivots == plain.report.pivots &&
               other.report.gaussSeidelIterations == plain.report.gaussSeidelIterations));
        CHECK((other.report.contactResidual == plain.report.contactResidual &&
               other.report.finishedBy == plain.report.finishedBy));
    }
}

} // namespace

TEST_CASE("islands on several threads give bitwise identical results") {
    generator::Random random(3);
    Problem problem;
    for (int k = 0; k < 9; ++k)
        append(problem, generator::nest({.shells = 2 + k % 3, .perPair = 12, .mu = k % 2 == 0 ? 0.35 : 0.1}, random));
    checkSame(problem);
    for (const int pivots : {2, 8, 30}) // the budget runs out between two islands
        checkSame(problem, {.maxGaussSeidelIterations = 30, .maxPivots = pivots});
}

TEST_CASE("subdomains on several threads give bitwise identical results") {
    generator::Random random(5);
    Problem problem = generator::nest({.shells = 20, .perPair = 25, .mu = 0.35, .side = 2}, random);
    append(problem, generator::nest({.shells = 3, .perPair = 12}, random));
    const ThreadSolution cold = solve(problem, {}, {});
    CHECK(cold.report.converged);
    CHECK(cold.report.activeContacts > 280); // otherwise there are no subdomains: they begin at 200 in one island
    checkSame(problem);
    problem.r0 = cold.r;
    for (Body& body : problem.bodies)
        body.vFree *= 1.02;
    checkSame(problem);
}

TEST_CASE("of several errors the first is reported on any number of threads") {
    generator::Random random(7);
    Problem problem = generator::cloud({.bodies = 300, .contacts = 900}, random);
    problem.contacts[700].mu = -1.0;
    problem.contacts[300].w[1] = std::numeric_limits<double>::quiet_NaN();
    const std::string expected = solve(problem, {}, {}).report.error;
    CHECK(expected.find("contact 300") != std::string::npos);
    problem.bodies[200].A(0, 0) = problem.bodies[90].A(0, 0) = -1.0;
    for (const parallel::For& loop : {test::backwards(), test::threads(3)}) {
        CHECK(solve(problem, {}, loop).report.error == expected);
        problem.contacts[300].w[1] = 0.0;
        problem.contacts[700].mu = 0.0;
        CHECK(solve(problem, {}, loop).report.error == "body 90: A is not positive definite");
        problem.contacts[300].w[1] = std::numeric_limits<double>::quiet_NaN();
    }
}
