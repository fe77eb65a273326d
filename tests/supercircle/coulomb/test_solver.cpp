// Every method against the independent residual evaluation, on generated problems with a known solution.

#include "supercircle/coulomb/residual.h"
#include "supercircle/coulomb/solver.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::coulomb;

namespace {

struct Solution {
    SolveReport report;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
};

Solution solve(Solver& solver, const Problem& problem, SolverOptions options = {}) {
    Solution solution;
    solution.report = solver.solve(problem, options, solution.r, solution.v);
    return solution;
}

/// A report must agree with the independent evaluation, whatever the method: the contact residual to 1 % or to
/// round-off (1e-11: mass ratio 1e5 times 1e-16).
void checkReport(const Problem& problem, const Solution& solution) {
    const Residual independent = evaluateResidual(problem, solution.r);
    CHECK(solution.r.allFinite());
    CHECK(std::abs(independent.contactResidual - solution.report.contactResidual) <=
          0.01 * independent.contactResidual + 1e-11);
    CHECK(std::abs(independent.penetrationSpeed - solution.report.penetrationSpeed) <=
          0.01 * independent.penetrationSpeed + 1e-11);
    const auto v = bodyVelocities(problem, solution.r);
    double worst = 0.0, size = 1.0;
    for (std::size_t b = 0; b < v.size(); ++b) {
        worst = std::max(worst, (v[b] - solution.v[b]).cwiseAbs().maxCoeff());
        size = std::max(size, v[b].cwiseAbs().maxCoeff());
    }
    CHECK(worst <= 1e-9 * size); // condition of A up to 1e6 times round-off
}

/// Feasible problems of every kind the generator knows, small to middling.
std::vector<Problem> variety(std::uint64_t seed) {
    generator::Random random(seed);
    std::vector<Problem> all;
    for (const double mu : {0.0, 0.1, 0.35, 1.0}) {
        for (const int contacts : {1, 2, 5, 20, 60})
            all.push_back(generator::cloud({.bodies = 1 + contacts / 3, .contacts = contacts, .mu = mu}, random));
        all.push_back(
            generator::cloud({.bodies = 6, .contacts = 40, .mu = mu, .duplicates = 0.4, .self = 0.2}, random));
        all.push_back(generator::cloud({.bodies = 8, .contacts = 24, .massRatio = 1e5, .mu = mu}, random));
        all.push_back(
            generator::cloud({.bodies = 5, .contacts = 30, .freedoms = 18, .condition = 1e4, .mu = mu}, random));
        all.push_back(generator::tower(2, mu, 1.0, 1e-2, random));
        all.push_back(generator::tower(10, mu, 1.0, 1e-2, random));
        all.push_back(generator::tower(6, mu, 1e5, 1e-2, random));
        all.push_back(generator::nest({.shells = 2, .perPair = 25, .mu = mu}, random));
        all.push_back(generator::nest({.shells = 6, .perPair = 12, .mu = mu, .dt = 1e-4, .side = 2}, random));
        all.push_back(generator::nest({.shells = 5, .perPair = 25, .mu = mu, .dt = 4e-3, .force = 5.0}, random));
    }
    return all;
}

} // namespace

TEST_CASE("the strategy solves every feasible problem from a cold start") {
    Solver solver;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const auto problems = variety(seed);
        for (std::size_t i = 0; i < problems.size(); ++i) {
            CAPTURE(seed, i, problems[i].contacts.size(), problems[i].contacts[0].mu);
            const Solution solution = solve(solver, problems[i]);
            CHECK(solution.report.converged);
            CHECK(solution.report.error.empty());
            // converged by the contact residual, or by the absolute impulse if the problem is at round-off
            CHECK((solution.report.contactResidual <= 1e-8 || solution.report.impulseError <= 1e-13));
            checkReport(problems[i], solution);
        }
    }
}

TEST_CASE("every method agrees with the residual evaluation, and two that converge agree on the motion") {
    Solver solver;
    const auto problems = variety(11);
    for (std::size_t i = 0; i < problems.size(); ++i) {
        CAPTURE(i, problems[i].contacts.size(), problems[i].contacts[0].mu);
        SolverOptions options;
        options.maxGaussSeidelIterations = 300;
        for (const Method method :
             {Method::None, Method::GaussSeidel, Method::Accelerated, Method::Path, Method::Newton}) {
            options.method = method;
            const Solution solution = solve(solver, problems[i], options);
            checkReport(problems[i], solution);
        }
        if (problems[i].contacts[0].mu > 0.0)
            continue;
        // Without friction the problem is a convex quadratic program in v: the motion is unique, to tolerance.
        options.method = Method::GaussSeidel;
        options.maxGaussSeidelIterations = 20000;
        options.tolerance = 1e-10;
        const Solution slow = solve(solver, problems[i], options);
        options.method = Method::Strategy;
        const Solution fast = solve(solver, problems[i], options);
        if (!slow.report.converged)
            continue;
        for (std::size_t b = 0; b < fast.v.size(); ++b)
            CHECK((fast.v[b] - slow.v[b]).cwiseAbs().maxCoeff() <= 1e-5 * (1e-2 + slow.v[b].cwiseAbs().maxCoeff()));
    }
}

TEST_CASE("the tight tolerance is reached as well") {
    Solver solver;
    SolverOptions options;
    options.tolerance = 1e-12;
    for (const Problem& problem : variety(21)) {
        const Solution solution = solve(solver, problem, options);
        CAPTURE(problem.contacts.size(), problem.contacts[0].mu, solution.report.contactResidual,
                solution.report.impulseError);
        CHECK(solution.report.contactResidual <= 1e-8);
        if (solution.report.converged)
            checkReport(problem, solution);
    }
}

TEST_CASE("a solution used as warm start needs no further pivots") {
    Solver solver;
    for (Problem problem : variety(31)) {
        const Solution first = solve(solver, problem);
        problem.r0 = first.r;
        const Solution again = solve(solver, problem);
        CHECK(again.report.converged);
        CHECK(again.report.gaussSeidelIterations <= 3);
        CHECK(again.report.pivots == 0);
    }
}

TEST_CASE("the best solution is never worse than the warm start") {
    generator::Random random(41);
    Solver solver;
    for (Problem problem : variety(41)) {
        problem.r0.resize(2 * static_cast<Eigen::Index>(problem.contacts.size()));
        for (Eigen::Index i = 0; i < problem.r0.size(); ++i)
            problem.r0[i] = random.uniform(-1e-3, 1e-3);
        SolverOptions options;
        options.method = Method::None;
        const double before = solve(solver, problem, options).report.contactResidual;
        for (const Method method : {Method::GaussSeidel, Method::Accelerated, Method::Path, Method::Newton}) {
            options.method = method;
            options.maxGaussSeidelIterations = 5;
            options.initialGaussSeidelIterations = 2;
            CHECK(solve(solver, problem, options).report.contactResidual <= before);
        }
    }
}

TEST_CASE("the solution depends on problem and options only") {
    const auto problems = variety(51);
    Solver shared;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const Solution first = solve(shared, problems[i]);
        const Solution other = solve(shared, problems[(i + 7) % problems.size()]);
        const Solution second = solve(shared, problems[i]);
        Solver fresh;
        const Solution third = solve(fresh, problems[i]);
        CHECK(first.r == second.r); // bit for bit
        CHECK(first.r == third.r);
        for (std::size_t b = 0; b < first.v.size(); ++b)
            CHECK((first.v[b] == second.v[b] && first.v[b] == third.v[b]));
        CHECK((first.report.gaussSeidelIterations == third.report.gaussSeidelIterations &&
               first.report.pivots == third.report.pivots));
    }
}

TEST_CASE("contradictory constraints give the best solution and no convergence") {
    Problem problem; // one body between two walls that close in
    problem.dt = 1e-3;
    problem.bodies.push_back({Eigen::MatrixXd::Identity(3, 3), Eigen::VectorXd::Zero(3)});
    for (const double side : {1.0, -1.0}) {
        Contact contact;
        contact.a = 0;
        contact.mu = 0.35;
        contact.Ha.resize(2, 3);
        contact.Ha << side, 0.0, 0.0, 0.0, 1.0, side;
        contact.w = {-0.1, 0.0};
        problem.contacts.push_back(contact);
    }
    Solver solver;
    const Solution solution = solve(solver, problem);
    CHECK_FALSE(solution.report.converged);
    CHECK(solution.report.error.empty());
    CHECK(solution.r.allFinite());
    CHECK(solution.report.penetrationSpeed >= 0.1 - 1e-12); // at least one wall closes at its own speed
    checkReport(problem, solution);

    Contact stuck; // moves nothing and closes: no impulse can stop it, and the report must say so
    stuck.a = -1;
    stuck.w = {-1.0, 0.0};
    problem.contacts = {stuck};
    const Solution hopeless = solve(solver, problem);
    CHECK_FALSE(hopeless.report.converged);
    CHECK(hopeless.report.penetrationSpeed == 1.0);
}

TEST_CASE("invalid input is refused with a sentence") {
    generator::Random random(61);
    const Problem good = generator::cloud({.bodies = 3, .contacts = 4}, random);
    Solver solver;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Problem> bad(8, good);
    bad[0].bodies[1].A(0, 0) = -1.0;
    bad[1].bodies[1].vFree[0] = nan;
    bad[2].contacts[3].a = 17;
    bad[3].contacts[3].mu = -0.1;
    bad[4].contacts[3].Ha(0, 1) = nan;
    bad[5].contacts[3].Ha.resize(2, 2);
    bad[6].r0 = Eigen::VectorXd::Zero(3);
    bad[7].contacts[3].w[0] = std::numeric_limits<double>::infinity();
    const char* expected[] = {"body 1",    "body 1",    "contact 3",  "contact 3",
                              "contact 3", "contact 3", "warm start", "contact 3"};
    for (std::size_t i = 0; i < bad.size(); ++i) {
        const Solution solution = solve(solver, bad[i]);
        CAPTURE(i, solution.report.error);
        CHECK(solution.report.error.find(expected[i]) != std::string::npos);
        CHECK_FALSE(solution.report.converged);
        CHECK(solution.r == Eigen::VectorXd::Zero(8));
    }
    CHECK(solve(solver, good).report.converged); // and the solver remains usable
    const Solution nothing = solve(solver, Problem{});
    CHECK(nothing.report.converged);
    CHECK(nothing.r.size() == 0);
}

TEST_CASE("islands are solved separately and together") {
    generator::Random random(71);
    Problem all;
    std::vector<Problem> parts;
    for (int k = 0; k < 5; ++k) {
        parts.push_back(generator::nest({.shells = 3, .perPair = 10}, random));
        const auto shift = static_cast<std::int32_t>(all.bodies.size());
        all.bodies.insert(all.bodies.end(), parts.back().bodies.begin(), parts.back().bodies.end());
        for (Contact contact : parts.back().contacts) {
            contact.a += contact.a >= 0 ? shift : 0;
            contact.b += contact.b >= 0 ? shift : 0;
            all.contacts.push_back(contact);
        }
    }
    Solver solver;
    const Solution solution = solve(solver, all);
    CHECK(solution.report.converged);
    checkReport(all, solution);
}

TEST_CASE("three thousand contacts", "[slow]") {
    generator::Random random(81);
    Solver solver;
    const Solution nest =
        solve(solver, generator::nest({.shells = 30, .perPair = 30, .force = 2.0, .side = 3}, random));
    CHECK(nest.report.converged);
    const Problem cloud = generator::cloud({.bodies = 500, .contacts = 3000, .duplicates = 0.1}, random);
    CHECK(solve(solver, cloud).report.converged);
}

TEST_CASE("a solver that gives up early stays within its pivots and its work", "[coulomb]") {
    generator::Random random(11);
    Solver solver;
    SolverOptions early;
    early.giveUpEarly = true;
    for (const Problem& p : variety(5)) { // what is solved within the limit is solved alike
        const Solution full = solve(solver, p), some = solve(solver, p, early);
        checkReport(p, some);
        CHECK(some.report.pivots <= 300 + 4 * static_cast<int>(p.contacts.size()));
        if (some.report.converged && full.report.pivots == some.report.pivots)
            CHECK(some.r == full.r);
        CHECK(full.report.effort.units() > 0.0);
    }
    // A problem without solution: boxes pressed between a floor and a ceiling that approach each other.
    for (Problem p : {generator::tower(8, 0.35, 1.0, 1e-2, random), generator::nest({.shells = 6}, random)}) {
        for (Contact& c : p.contacts)
            if (c.b < 0)
                c.w.x() -= 1.0;
        const Solution some = solve(solver, p, early);
        checkReport(p, some);
        CHECK(some.report.pivots <= 300 + 4 * static_cast<int>(p.contacts.size()));
        SolverOptions little;
        little.maxWork = 500.0;
        const Solution cut = solve(solver, p, little);
        checkReport(p, cut);
        // Beyond the limit: the iterations of a cold start, and one factorisation.
        CHECK(cut.report.effort.units() <=
              500.0 + 80.0 * static_cast<double>(p.contacts.size()) + 0.03 * 2.0 * cut.report.effort.factors);
    }
}
