#include "plugin/bench/bench.h"
#include "plugin/bench/bench_scene_run.h"
#include "plugin/cli/subcommands.h"

#include "supercircle/coulomb/residual.h"

#include <cstdio>

namespace supercircle::cli {

namespace {

constexpr std::size_t kProblems = 150;
constexpr std::size_t kFewest = 10; ///< contacts: smaller problems take no measurable time

struct SolverCase {
    std::string name;
    coulomb::Method method;
    double tolerance;
};

std::vector<SolverCase> settings() {
    std::vector<SolverCase> all;
    for (const auto& [tolerance, text] : {std::pair{1e-6, "1e-6"}, std::pair{1e-8, "1e-8"}})
        for (const coulomb::Method method : {coulomb::Method::GaussSeidel, coulomb::Method::Strategy})
            all.push_back({"contact/" + std::string(coulomb::name(method)) + "/" + text, method, tolerance});
    return all;
}

/// Problems of a small stack under load, evenly sampled, with the warm starts of the simulation. When the list is full,
/// every other problem is dropped and the stride doubles.
std::string recordProblems(std::vector<coulomb::Problem>& problems) {
    std::size_t stride = 1, seen = 0;
    lab::RunOptions options;
    options.onSolve = [&](const coulomb::Problem& problem, const coulomb::SolveReport&) {
        if (problem.contacts.size() < kFewest || seen++ % stride != 0)
            return;
        problems.push_back(problem);
        if (problems.size() < 2 * kProblems)
            return;
        for (std::size_t i = 0; 2 * i < problems.size(); ++i)
            std::swap(problems[i], problems[2 * i]);
        problems.resize(kProblems);
        stride *= 2;
    };
    lab::RunResult out;
    return runBenchmarkScene("stack30", {"shells=6"}, options, out);
}

Measurement measure(const SolverCase& setting, const std::vector<coulomb::Problem>& problems) {
    coulomb::SolverOptions options;
    options.method = setting.method;
    options.tolerance = setting.tolerance;
    options.maxGaussSeidelIterations = 1000;
    coulomb::Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
    std::vector<double> samples;
    double reached = 0.0, iterations = 0.0, pivots = 0.0, contacts = 0.0;
    solver.solve(problems.front(), options, r, v); // work space
    for (const coulomb::Problem& problem : problems) {
        if (interrupted)
            break;
        coulomb::SolveReport report;
        samples.push_back(timed([&] { report = solver.solve(problem, options, r, v); }));
        reached +=
            coulomb::evaluateResidual(problem, r).contactResidual <= setting.tolerance || report.converged ? 1.0 : 0.0;
        iterations += report.gaussSeidelIterations;
        pivots += report.pivots;
        contacts += static_cast<double>(problem.contacts.size());
    }
    const double n = std::max(1.0, static_cast<double>(samples.size()));
    Measurement m = summarise(setting.name, std::move(samples));
    m.more = {{"reached", reached / n},
              {"gauss_seidel_iterations_mean", iterations / n},
              {"pivots_mean", pivots / n},
              {"contacts_mean", contacts / n}};
    return m;
}

} // namespace

void addContactBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    for (const SolverCase& s : settings())
        b.names.push_back(s.name);
    b.measure = [](const auto& wanted, const auto& done) {
        std::vector<coulomb::Problem> problems;
        if (const std::string error = recordProblems(problems); !error.empty())
            return error;
        if (problems.empty())
            return std::string(interrupted ? "" : "the small stack has no contact problems");
        for (const SolverCase& s : settings())
            if (wanted(s.name))
                done(measure(s, problems));
        return std::string();
    };
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
