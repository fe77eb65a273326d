// Timing of the methods; hidden, run with  test_coulomb "[.bench]". With SUPERCIRCLE_FCP set to a folder, its recorded
// problems (*.fcp) are used instead of generated ones. Nothing is asserted about time.

#include "generator.h"
#include "supercircle/coulomb/solver.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>

using namespace supercircle::coulomb;

namespace {

std::vector<Problem> generated() {
    std::vector<Problem> problems;
    generator::Random random(7);
    for (const double force : {0.5, 1.0, 2.0, 5.0})
        for (const double dt : {1e-4, 1e-3, 4e-3})
            for (int k = 0; k < 3; ++k)
                problems.push_back(
                    generator::nest({.shells = 10, .perPair = 10, .dt = dt, .force = force, .side = 3}, random));
    return problems;
}

void warm(std::vector<Problem>& problems) {
    Solver solver;
    for (Problem& problem : problems) {
        SolverOptions options;
        options.method = Method::GaussSeidel;
        options.maxSweeps = 100;
        std::vector<Eigen::VectorXd> v;
        Eigen::VectorXd r;
        solver.solve(problem, options, r, v);
        problem.r0 = r;
    }
}

void table(const std::vector<Problem>& problems, Method method, double tolerance) {
    Solver solver;
    std::vector<double> times;
    std::vector<double> etas;
    int reached = 0;
    double sweeps = 0.0, pivots = 0.0, factorisations = 0.0, loaded = 0.0, candidates = 0.0;
    for (const Problem& problem : problems) {
        SolverOptions options;
        options.method = method;
        options.tolerance = tolerance;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        const auto start = std::chrono::steady_clock::now();
        const SolveReport report = solver.solve(problem, options, r, v);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        times.push_back(time.count());
        etas.push_back(report.eta);
        reached += report.converged ? 1 : 0;
        sweeps += report.sweeps;
        pivots += report.pivots;
        factorisations += report.factorisations;
        loaded += report.loaded;
        candidates += static_cast<double>(problem.contacts.size());
        if (std::getenv("SUPERCIRCLE_VERBOSE"))
            std::printf("   nc %zu loaded %d eta %.2e sweeps %d pivots %d fact %d %.2f ms by %s\n",
                        problem.contacts.size(), report.loaded, report.eta, report.sweeps, report.pivots,
                        report.factorisations, time.count(), std::string(name(report.finishedBy)).c_str());
    }
    std::sort(times.begin(), times.end());
    std::sort(etas.begin(), etas.end());
    const auto at = [](const std::vector<double>& x, double p) {
        return x[static_cast<std::size_t>(p * static_cast<double>(x.size() - 1))];
    };
    const double n = static_cast<double>(problems.size());
    std::printf("%-13s tol %.0e reached %3d/%3zu  ms %7.2f /%7.2f /%7.2f  eta %.1e /%.1e  nc %.0f loaded %.0f sweeps "
                "%.0f pivots %.1f fact %.2f\n",
                std::string(name(method)).c_str(), tolerance, reached, problems.size(), at(times, 0.5), at(times, 0.95),
                times.back(), at(etas, 0.5), etas.back(), candidates / n, loaded / n, sweeps / n, pivots / n,
                factorisations / n);
}

} // namespace

TEST_CASE("timing of every method", "[.bench]") {
    std::vector<Problem> problems = generated();
    for (const bool isWarm : {false, true}) {
        if (isWarm)
            warm(problems);
        std::printf("%s\n", isWarm ? "warm" : "cold");
        table(problems, Method::GaussSeidel, 1e-8);
        table(problems, Method::Accelerated, 1e-8);
        for (const Method method : {Method::Newton, Method::Path, Method::Cascade})
            table(problems, method, 1e-8);
        table(problems, Method::Cascade, 1e-12);
    }
}
