// Problems of small stacks are recorded from a simulation. Large sets are rows of recorded stacks whose shells touch
// their neighbours, because a stack of thousands of shells takes hours to drop. Each stack keeps its loads, gaps and
// warm starts; the links make one island. Measured is the CPU time of a whole solve by a solver that is warmed up.

#include "plugin/bench/bench_solver.h"

#include "plugin/bench/bench_scene_run.h"
#include "plugin/cli/subcommands.h"
#include "plugin/recording/table/files.h"
#include "supercircle/coulomb/residual.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <map>

namespace supercircle::cli {

namespace {

using coulomb::Problem;

constexpr std::array kStacks{3, 10, 30};     ///< shells, simulated
constexpr std::array kCopies{3, 10, 23, 45}; ///< of the largest
constexpr std::size_t kProblems = 16;        ///< of a simulated set
constexpr int kLinks = 20;                   ///< contacts between two neighbouring stacks of a row
constexpr double kNestForce = 3.0;           ///< N, a nest carries more than this
constexpr std::size_t kWarmUpLimit = 3000;   ///< contacts up to which a set is solved once before it is timed
constexpr std::array kTolerances{1e-6, 1e-12};

/// A column of the table.
struct SolverColumn {
    const char* name;
    coulomb::Method method;
    int iterations;       ///< at most
    std::size_t contacts; ///< on sets of at most so many
};
// Plain Gauss-Seidel stops after 1000 iterations (Daviet, Bertails-Descoubes & Boissieux 2011), and after many more for
// comparison.
constexpr std::array kColumns{SolverColumn{"strategy", coulomb::Method::Strategy, 1000, SIZE_MAX},
                              SolverColumn{"path", coulomb::Method::Path, 1000, SIZE_MAX},
                              SolverColumn{"accelerated", coulomb::Method::Accelerated, 1000, SIZE_MAX},
                              SolverColumn{"newton", coulomb::Method::Newton, 1000, SIZE_MAX},
                              SolverColumn{"plain", coulomb::Method::GaussSeidel, 1000, SIZE_MAX},
                              SolverColumn{"plain_50000", coulomb::Method::GaussSeidel, 50000, 1500}};

/// Keeps a few of many problems, evenly spaced; the choice depends on their number only.
class Sample {
public:
    explicit Sample(std::vector<Problem>& kept) : kept_(kept) {}
    void offer(const Problem& problem) {
        if (seen_++ % stride_ != 0)
            return;
        kept_.push_back(problem);
        if (kept_.size() < 2 * kProblems)
            return;
        for (std::size_t i = 0; 2 * i < kept_.size(); ++i)
            std::swap(kept_[i], kept_[2 * i]);
        kept_.resize(kProblems);
        stride_ *= 2;
    }

private:
    std::vector<Problem>& kept_;
    std::size_t seen_ = 0, stride_ = 1;
};

/// Simulates a stack until it has been squeezed; problems of the pile are those before.
std::string recordStack(int shells, SolverSet& pile, SolverSet& nest) {
    pile = {"pile", shells, {}};
    nest = {"nest", shells, {}};
    Sample piles(pile.problems), nests(nest.problems);
    lab::RunProgress now;
    std::atomic<bool> enough = false;
    lab::RunOptions options;
    options.interrupt = &enough;
    options.progress = [&](const lab::RunProgress& p) { now = p; };
    options.onSolve = [&](const Problem& problem, const coulomb::SolveReport&) {
        enough = interrupted || now.phase.rfind("unload", 0) == 0;
        if (now.phase == "drop " + std::to_string(shells))
            piles.offer(problem);
        else if (now.phase.rfind("load", 0) == 0 && now.force > kNestForce)
            nests.offer(problem);
    };
    lab::RunResult out;
    return runBenchmarkScene("stack30", {"shells=" + std::to_string(shells)}, options, out);
}

/// The problems with the most frequent time step (the smallest of several).
std::vector<Problem> sameStep(const std::vector<Problem>& problems) {
    std::map<double, std::size_t> count;
    for (const Problem& p : problems)
        ++count[p.dt];
    double best = 0.0;
    for (const auto& [dt, n] : count)
        if (best == 0.0 || n > count[best])
            best = dt;
    std::vector<Problem> same;
    for (const Problem& p : problems)
        if (p.dt == best)
            same.push_back(p);
    return same;
}

/// The sets that are wanted. A row needs its stacks simulated.
std::string collectSets(const std::function<bool(int shells)>& wanted, std::vector<SolverSet>& sets) {
    std::vector<SolverSet> piles, nests;
    const bool rows = std::any_of(kCopies.begin(), kCopies.end(), [&](int n) { return wanted(n * kStacks.back()); });
    for (const int shells : kStacks) {
        if (!wanted(shells) && !(rows && shells == kStacks.back()))
            continue;
        std::fprintf(stderr, "simulating a stack of %d shells for its contact problems ...\n", shells);
        SolverSet pile, nest;
        if (std::string error = recordStack(shells, pile, nest); !error.empty())
            return error;
        if (interrupted)
            return {};
        if (pile.problems.empty() || nest.problems.empty())
            return "the stack of " + std::to_string(shells) + " shells has no contact problems";
        piles.push_back(std::move(pile));
        nests.push_back(std::move(nest));
    }
    for (std::vector<SolverSet>* kind : {&nests, &piles}) {
        const std::vector<Problem> stacks = rows ? sameStep(kind->back().problems) : std::vector<Problem>();
        for (const int copies : kCopies) {
            if (!wanted(copies * kStacks.back()))
                continue;
            SolverSet row{kind->front().kind, copies * kStacks.back(), {}};
            for (std::uint64_t seed = 1; seed <= 2; ++seed)
                row.problems.push_back(rowOfStacks(stacks, copies, kLinks, seed));
            kind->push_back(std::move(row));
        }
        for (SolverSet& set : *kind)
            sets.push_back(std::move(set));
    }
    return {};
}

std::string toleranceText(double tolerance) {
    char text[16];
    std::snprintf(text, sizeof text, "%.0e", tolerance);
    return text;
}

std::string rowName(const std::string& kind, int shells, const SolverColumn& column, double tolerance) {
    return "solver/" + kind + "/" + std::to_string(shells) + "/" + column.name + "/" + toleranceText(tolerance);
}

Measurement measureSet(const SolverSet& set, const SolverColumn& column, double tolerance) {
    coulomb::SolverOptions options;
    options.method = column.method;
    options.tolerance = tolerance;
    options.absoluteImpulse = 0.0; // the contact residual alone decides
    options.maxGaussSeidelIterations = column.iterations;
    coulomb::Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
    std::vector<double> samples;
    double reached = 0.0, contacts = 0.0, active = 0.0;
    const int passes = set.problems.front().contacts.size() > kWarmUpLimit || column.iterations > 1000 ? 1 : 2;
    for (int pass = 0; pass < passes; ++pass)
        for (const Problem& problem : set.problems) {
            if (interrupted)
                break;
            const double begin = threadCpuSeconds();
            const coulomb::SolveReport report = solver.solve(problem, options, r, v);
            const double spent = 1e3 * (threadCpuSeconds() - begin); // ms
            if (pass + 1 < passes)
                continue;
            samples.push_back(spent);
            reached += report.contactResidual <= tolerance ? 1.0 : 0.0;
            contacts += static_cast<double>(problem.contacts.size());
            active += report.activeContacts;
        }
    const double n = std::max(1.0, static_cast<double>(samples.size()));
    Measurement m = summarise(rowName(set.kind, set.shells, column, tolerance), std::move(samples));
    m.more = {{"reached", reached / n}, {"contacts_mean", contacts / n}, {"active_mean", active / n}};
    return m;
}

std::string measureSolvers(const std::function<bool(const std::string&)>& wanted,
                           const std::function<void(Measurement)>& done) {
    std::vector<SolverSet> sets;
    const auto wantedSize = [&](int shells) {
        for (const char* kind : {"nest", "pile"})
            for (const double tolerance : kTolerances)
                for (const SolverColumn& column : kColumns)
                    if (wanted(rowName(kind, shells, column, tolerance)))
                        return true;
        return false;
    };
    if (std::string error = collectSets(wantedSize, sets); !error.empty())
        return error;
    for (const SolverSet& set : sets)
        for (const double tolerance : kTolerances)
            for (const SolverColumn& column : kColumns)
                if (set.problems.front().contacts.size() <= column.contacts &&
                    wanted(rowName(set.kind, set.shells, column, tolerance)))
                    done(measureSet(set, column, tolerance));
    return {};
}

/// The table below the rows; the picture beside the JSON file.
std::string finishSolvers(const std::vector<Measurement>& measured, const std::string& json) {
    std::vector<SolverRow> rows;
    for (const Measurement& m : measured)
        if (const auto row = solverRow(m))
            rows.push_back(*row);
    if (rows.empty())
        return {};
    std::printf("\n%s\n", solverTable(rows).c_str());
    if (json.empty())
        return {};
    std::string error;
    const std::string png = solverPicture(rows, error);
    if (!error.empty())
        return error;
    const std::filesystem::path file = std::filesystem::path(json).replace_extension(".png");
    return record::writeAtomically(file.parent_path().string(), {{file.filename().string(), png}}).error();
}

std::uint64_t nextRandom(std::uint64_t& state) { // SplitMix64 (Steele, Lea & Flood 2014)
    std::uint64_t z = state += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
}

/// A contact between a shell of stack `a` and one of stack `b`, with surface rows both have elsewhere.
std::optional<coulomb::Contact> link(const Problem& a, const Problem& b, std::int32_t offsetA, std::int32_t offsetB,
                                     std::uint64_t& state) {
    if (a.contacts.empty() || b.contacts.empty())
        return std::nullopt;
    const coulomb::Contact& left = a.contacts[nextRandom(state) % a.contacts.size()];
    const coulomb::Contact& right = b.contacts[nextRandom(state) % b.contacts.size()];
    const bool apart = nextRandom(state) % 2 == 0;
    const double gap = 1e-4 * static_cast<double>(nextRandom(state) >> 11) * 0x1p-53; // m
    if (left.a < 0 || right.a < 0)
        return std::nullopt;
    coulomb::Contact c;
    c.a = left.a + offsetA;
    c.b = right.a + offsetB;
    c.mu = left.mu;
    c.Ha = left.Ha;
    c.Hb = -right.Ha;
    c.w[0] = apart ? gap / a.dt : 0.0;
    return c;
}

} // namespace

Problem rowOfStacks(const std::vector<Problem>& stacks, int copies, int links, std::uint64_t seed) {
    Problem row;
    std::uint64_t state = seed;
    std::vector<double> r0;
    std::int32_t before = 0;
    const Problem* last = nullptr;
    for (int i = 0; i < copies && !stacks.empty(); ++i) {
        const Problem& stack = stacks[(static_cast<std::size_t>(i) + seed) % stacks.size()];
        const auto offset = static_cast<std::int32_t>(row.bodies.size());
        row.dt = stack.dt;
        row.bodies.insert(row.bodies.end(), stack.bodies.begin(), stack.bodies.end());
        for (coulomb::Contact c : stack.contacts) {
            c.a += c.a >= 0 ? offset : 0;
            c.b += c.b >= 0 ? offset : 0;
            row.contacts.push_back(std::move(c));
        }
        for (std::size_t k = 0; k < 2 * stack.contacts.size(); ++k)
            r0.push_back(stack.r0.size() > 0 ? stack.r0[static_cast<Eigen::Index>(k)] : 0.0);
        for (int k = 0; k < links && last != nullptr; ++k)
            if (auto c = link(*last, stack, before, offset, state)) {
                row.contacts.push_back(std::move(*c));
                r0.insert(r0.end(), 2, 0.0);
            }
        before = offset;
        last = &stack;
    }
    row.r0 = Eigen::Map<const Eigen::VectorXd>(r0.data(), static_cast<Eigen::Index>(r0.size()));
    return row;
}

void addSolverBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    for (const char* kind : {"nest", "pile"}) {
        std::vector<int> shells(kStacks.begin(), kStacks.end());
        for (const int copies : kCopies)
            shells.push_back(copies * kStacks.back());
        for (const int n : shells)
            for (const double tolerance : kTolerances)
                for (const SolverColumn& column : kColumns)
                    b.names.push_back(rowName(kind, n, column, tolerance));
    }
    b.prefix = "solver";
    b.measure = measureSolvers;
    b.finish = finishSolvers;
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
