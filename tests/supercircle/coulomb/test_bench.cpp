// Timing of the methods; hidden, run with  test_coulomb "[.bench]". With SUPERCIRCLE_FCP set to a folder, its recorded
// problems (*.fcp) are used instead of generated ones. Nothing is asserted about time.

#include "supercircle/coulomb/dump.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/support/order_statistics.h"
#include "tests/supercircle/coulomb/generator.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

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

std::vector<Problem> recorded(const std::string& folder) {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".fcp")
            paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    std::vector<Problem> problems;
    for (const std::string& path : paths) {
        Problem problem;
        const std::string error = readDump(path, problem);
        if (error.empty())
            problems.push_back(std::move(problem));
        else
            std::printf("%s\n", error.c_str());
    }
    return problems;
}

/// The next step of a simulation, roughly: forces and gaps a little different, the last solution as warm start.
void warm(std::vector<Problem>& problems) {
    Solver solver;
    generator::Random random(8);
    for (Problem& problem : problems) {
        std::vector<Eigen::VectorXd> v;
        solver.solve(problem, {}, problem.r0, v);
        for (Body& body : problem.bodies)
            body.vFree *= random.uniform(0.95, 1.05);
        for (Contact& contact : problem.contacts)
            contact.w[0] = std::max(0.0, contact.w[0] + 5e-8 / problem.dt * random.uniform(-1.0, 1.0));
    }
}

void table(const std::vector<Problem>& problems, Method method, double tolerance) {
    Solver solver;
    std::vector<double> times;
    std::vector<double> residuals;
    int reached = 0;
    double iterations = 0.0, pivots = 0.0, factorisations = 0.0, activeContacts = 0.0, candidates = 0.0;
    for (const Problem& problem : problems) {
        SolverOptions options;
        options.method = method;
        options.tolerance = tolerance;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        const std::clock_t start = std::clock(); // CPU time: the machine may be shared
        const SolveReport report = solver.solve(problem, options, r, v);
        const double time = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        times.push_back(time);
        residuals.push_back(report.contactResidual);
        reached += report.converged ? 1 : 0;
        iterations += report.gaussSeidelIterations;
        pivots += report.pivots;
        factorisations += report.factorisations;
        activeContacts += report.activeContacts;
        candidates += static_cast<double>(problem.contacts.size());
        if (std::getenv("SUPERCIRCLE_VERBOSE"))
            std::printf("   contacts %zu, active %d, residual %.2e, iterations %d, pivots %d, factorisations %d, %.2f "
                        "ms by %s\n",
                        problem.contacts.size(), report.activeContacts, report.contactResidual,
                        report.gaussSeidelIterations, report.pivots, report.factorisations, time,
                        std::string(name(report.finishedBy)).c_str());
    }
    const double n = static_cast<double>(problems.size());
    std::printf("%-13s tol %.0e reached %3d/%3zu  ms %7.2f /%7.2f /%7.2f  residual %.1e /%.1e  contacts %.0f active "
                "%.0f iterations "
                "%.0f pivots %.1f factorisations %.2f\n",
                std::string(name(method)).c_str(), tolerance, reached, problems.size(),
                supercircle::lowerQuantile(times, 0.5), supercircle::lowerQuantile(times, 0.95),
                supercircle::lowerQuantile(times, 1.0), supercircle::lowerQuantile(residuals, 0.5),
                supercircle::lowerQuantile(residuals, 1.0), candidates / n, activeContacts / n, iterations / n,
                pivots / n, factorisations / n);
}

} // namespace

TEST_CASE("timing of every method", "[.bench]") {
    const char* folder = std::getenv("SUPERCIRCLE_FCP");
    std::vector<Problem> problems = folder ? recorded(folder) : generated();
    REQUIRE_FALSE(problems.empty());
    for (const bool isWarm : {false, true}) {
        if (isWarm && !folder)
            warm(problems);
        else if (isWarm)
            for (Problem& problem : problems)
                problem.r0.resize(0);
        std::printf("%s\n", isWarm == (folder == nullptr) ? "warm" : "cold");
        for (const Method method :
             {Method::GaussSeidel, Method::Accelerated, Method::Newton, Method::Path, Method::Strategy})
            table(problems, method, 1e-8);
        table(problems, Method::Strategy, 1e-10);
        table(problems, Method::Strategy, 1e-12);
    }
}
