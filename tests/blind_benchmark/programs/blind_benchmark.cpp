// Blind benchmark: makes synthetic cases with hidden effects, runs `supercircle diagnose` on each and scores the
// results. Cases and diagnoses that exist are kept, so an interrupted run continues with the same command.
//
//   blind_benchmark --program build/dev/plugin/supercircle --out out/benchmark [options] [-- options of diagnose]
//
// `--help` lists the options. docs/results/diagnosis.md describes the design and the scores.

#include "tests/blind_benchmark/scoring/scores.h"
#include "tests/blind_benchmark/scoring/self_check.h"
#include "tests/blind_benchmark/synthetic_cases/make_case.h"
#include "tests/reference_simulator/json_text.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace supercircle::blind_benchmark;

constexpr const char* kUsage =
    "blind_benchmark --program SUPERCIRCLE --out DIR [options] [-- options of supercircle diagnose]\n"
    "  --part tuning|blind|limit  set of cases (blind)\n"
    "  --seed N                   seed of the set\n"
    "  --first A --limit B        cases A to B, counted from 1 in the order of the set; processes may share DIR\n"
    "  --only N,N,...             of these, only the cases with these numbers\n"
    "  --jobs N                   threads of each diagnosis (2)\n"
    "  --score                    score the existing diagnoses, run none\n"
    "  --name NAME                folder of the diagnoses (diagnoses), for the same cases with other options\n"
    "  --from NAME                copy the stored simulations of the diagnoses of that name; results are bitwise "
    "equal\n"
    "  --further                  make the runs that undecided diagnoses propose, and diagnose again\n"
    "  --self-check               this project's simulator makes the cases (an ablation)\n"
    "  --simulator-distance       no diagnosis: distance of the two simulators with the true parameters and effects\n";

struct Options {
    std::string program, out, part = "blind", name = "diagnoses", from, jobs = "2";
    std::set<std::size_t> only; ///< empty: all
    std::size_t first = 1, limit = 1000000;
    std::uint64_t seed = 0;
    bool scoreOnly = false, further = false, selfCheck = false, simulatorDistance = false;
    std::vector<std::string> flags;
};

int run(const std::vector<std::string>& arguments) {
    std::vector<char*> pointers;
    for (const std::string& argument : arguments)
        pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        execv(pointers.front(), pointers.data());
        _exit(127);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) < 0)
        return 127;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 130;
}

/// Writes the files of a case. The answer comes last: where it exists, the case is complete.
bool write(const SyntheticCase& c, const std::string& name, const fs::path& folder) {
    if (!c.failure.empty()) {
        std::fprintf(stderr, "%s: the case cannot be made: %s\n", name.c_str(), c.failure.c_str());
        return false;
    }
    fs::create_directories(folder / name);
    fs::create_directories(folder / "answers");
    for (const auto& [file, text] : c.files)
        writeAtomically(folder / name / file, text);
    writeAtomically(folder / "answers" / (name + ".json"), c.answer);
    return true;
}

/// Makes a case unless it exists.
bool ensureCase(const CasePlan& plan, const fs::path& folder, const std::vector<ProposedRun>& further = {}) {
    return fs::exists(folder / "answers" / (plan.name + ".json")) || write(makeCase(plan, further), plan.name, folder);
}

/// Readings that this project's simulator gives with the true parameters and effects.
std::optional<CleanReadings> replayCase(const Options& o, const CasePlan& plan, const fs::path& cases,
                                        const fs::path& to) {
    if (!ensureCase(plan, cases))
        return std::nullopt;
    const fs::path experiment = cases / plan.name / "experiment.json";
    std::vector<std::string> arguments = {o.program, "replay", experiment.string(), "--out", to.string(), "--quiet"};
    for (const std::string& w : truthFlags((cases / "answers" / (plan.name + ".json")).string()))
        arguments.push_back(w);
    if (const int code = run(arguments); code != 0) {
        std::fprintf(stderr, "%s: supercircle replay failed with exit code %d\n", plan.name.c_str(), code);
        return std::nullopt;
    }
    std::ifstream in(experiment);
    const auto described = supercircle::reference_simulator::parseJson(in);
    const bool markers = described.at("runs").front().contains("markers_file");
    return replayed(to.string(), described.at("runs").size(), markers);
}

/// Makes a case with this project's simulator in place of the reference simulator, unless it exists.
bool ensureSelfCheckCase(const Options& o, const CasePlan& plan, const fs::path& cases, const fs::path& selfCheck) {
    if (fs::exists(selfCheck / "answers" / (plan.name + ".json")))
        return true;
    const auto clean = replayCase(o, plan, cases, selfCheck / "replays" / plan.name);
    return clean && write(makeCase(plan, {}, &*clean), plan.name, selfCheck);
}

/// Prints the distance of the two simulators in each case, with the true parameters and effects.
int printSimulatorDistance(const Options& o, const std::vector<CasePlan>& all) {
    const fs::path folder = fs::path(o.out) / o.part;
    bool complete = true;
    std::printf("Distance of the readings from the recorded ones (rms, noise standard deviations), and the signal of "
                "it to the\n"
                "best possible test (standard deviations of its statistic).\n\n");
    std::printf("%-9s %-6s %-44s %17s   %17s   %s\n", "", "", "", "fine reference", "this project", "markers");
    std::printf("%-9s %-6s %-44s %9s %7s   %9s %7s   %7s\n", "case", "set-up", "hidden", "rms", "signal", "rms",
                "signal", "rms");
    for (const CasePlan& plan : all) {
        const auto clean = replayCase(o, plan, folder / "cases", folder / "simulator_distance" / plan.name);
        const Accuracy a = clean ? accuracyOf(plan, &*clean) : Accuracy{"the case cannot be replayed"};
        if (!a.failure.empty()) {
            std::fprintf(stderr, "%s: %s\n", plan.name.c_str(), a.failure.c_str());
            complete = false;
            continue;
        }
        std::ifstream in(folder / "cases" / "answers" / (plan.name + ".json"));
        const auto answer = supercircle::reference_simulator::parseJson(in);
        std::string hidden;
        for (const auto& label : answer.at("labels"))
            hidden += (hidden.empty() ? "" : ", ") + label.get<std::string>();
        std::printf("%-9s %-6s %-44s %9.3f %7.1f   %9.3f %7.1f   %7.2f\n", plan.name.c_str(),
                    answer.at("protocol").get<std::string>().c_str(), hidden.c_str(), a.rms, a.detectable, a.otherRms,
                    a.otherDetectable, a.otherMarkers);
        std::fflush(stdout);
    }
    return complete ? 0 : 3;
}

/// Copies the stored simulations of another diagnosis of the same case.
void copySimulations(const fs::path& from, const fs::path& to) {
    if (!fs::is_directory(from))
        return;
    fs::create_directories(to);
    for (const auto& file : fs::directory_iterator(from))
        if (file.path().extension() == ".cache")
            fs::copy_file(file.path(), to / file.path().filename(), fs::copy_options::skip_existing);
}

bool diagnose(const Options& o, const CasePlan& plan, const fs::path& cases, const fs::path& to) {
    if (fs::exists(to / "diagnosis.json"))
        return true;
    std::vector<std::string> arguments = {o.program, "diagnose",  (cases / plan.name / "experiment.json").string(),
                                          "--out",   to.string(), "--jobs",
                                          o.jobs,    "--quiet"};
    std::ifstream in(cases / "answers" / (plan.name + ".json"));
    const auto answer =
        supercircle::reference_simulator::parseJson(in); // a variable: a loop over a part of a temporary would dangle
    for (const auto& label : answer.at("diagnose_without")) {
        arguments.emplace_back("--without");
        arguments.push_back(label);
    }
    arguments.insert(arguments.end(), o.flags.begin(), o.flags.end());
    const int code = run(arguments);
    if (code == 130)
        throw std::runtime_error("interrupted; run the same command to continue");
    if (code != 0)
        std::fprintf(stderr, "%s: supercircle diagnose failed with exit code %d\n", plan.name.c_str(), code);
    return code == 0;
}

/// Diagnoses the undecided cases again, together with the runs that their diagnoses proposed.
/// @param before scores of the first diagnoses, in the order of `all`
void diagnoseWithProposedRuns(const Options& o, const std::vector<CasePlan>& all, const std::vector<CaseScore>& before,
                              const fs::path& folder) {
    const fs::path cases = fs::path(o.out) / o.part / (o.name + "_further_cases"),
                   to = fs::path(o.out) / o.part / (o.name + "_further");
    Proportion resolvedExpected, resolvedInconclusive, resolvedUncertain;
    std::string lines;
    for (const CaseScore& was : before) {
        const auto plan = std::find_if(all.begin(), all.end(), [&](const CasePlan& p) { return p.name == was.name; });
        const auto runs = proposedRuns((folder / was.name / "diagnosis.json").string());
        if (!undecided(was) || runs.empty() || plan == all.end())
            continue;
        if (!fs::exists(to / was.name / "diagnosis.json") &&
            (o.scoreOnly || !ensureCase(*plan, cases, runs) || !diagnose(o, *plan, cases, to / was.name)))
            continue;
        const CaseScore now =
            scoreCase((cases / "answers" / (was.name + ".json")).string(), (to / was.name / "diagnosis.json").string());
        // Runs that the reference simulator does not know well enough prove nothing (decision 0089).
        const bool counts = now.proposedRunsOwnError <= kMaxOwnError;
        if (counts)
            (was.expectedConclusive ? resolvedExpected : resolvedUncertain).count(resolved(now));
        if (counts && was.expectedConclusive && was.verdict == "inconclusive")
            resolvedInconclusive.count(resolved(now));
        char remark[128];
        std::snprintf(remark, sizeof remark, " (%serror of the reference simulator %.2f%s)",
                      was.expectedConclusive ? "" : "not expected to be conclusive; ", now.proposedRunsOwnError,
                      counts ? "" : ", not counted");
        lines += "  " + was.name + " (" + was.verdict + "): " + was.nextExperiment + remark + "\n    " +
                 (resolved(now) ? "resolved" : "undecided or wrong") + ": " + now.statement + "\n";
    }
    const auto share = [](const Proportion& s) {
        char text[80];
        std::snprintf(text, sizeof text, "%d of %d, %.2f [%.2f, %.2f]", s.hits, s.of, s.value(), s.low(), s.high());
        return std::string(text);
    };
    const std::string text =
        "undecided cases that the proposed runs resolve, where the diagnosis expected it: " + share(resolvedExpected) +
        "\n  of those with the verdict inconclusive: " + share(resolvedInconclusive) +
        "\nwhere the diagnosis did not expect it: " + share(resolvedUncertain) + "\n" + lines;
    fs::create_directories(to);
    writeAtomically(to / "resolved.txt", text);
    std::printf("\n%s", text.c_str());
}

int work(const Options& o) {
    const std::uint64_t seed = o.seed != 0 ? o.seed : o.part == "tuning" ? 1 : 2026;
    const fs::path referenceCases = fs::path(o.out) / o.part / "cases", folder = fs::path(o.out) / o.part / o.name;
    const fs::path cases = o.selfCheck ? fs::path(o.out) / o.part / "self_check_cases" : referenceCases;
    const auto make = [&](const CasePlan& plan) {
        return o.selfCheck ? ensureSelfCheckCase(o, plan, referenceCases, cases) : ensureCase(plan, cases);
    };
    std::vector<CasePlan> all;
    const std::vector<CasePlan> set = casePlans(o.part, seed);
    for (std::size_t number = o.first; number <= std::min(o.limit, set.size()); ++number)
        if (o.only.empty() || o.only.count(number) > 0)
            all.push_back(set[number - 1]);
    if (all.empty())
        throw std::runtime_error("no such case: the set has " + std::to_string(set.size()) +
                                 " cases, and --first and --limit give the first and the last of those wanted");
    if (o.simulatorDistance)
        return printSimulatorDistance(o, all);
    std::vector<CaseScore> scores;
    const std::string title = "Blind benchmark of the diagnosis, part \"" + o.part + "\", seed " +
                              std::to_string(seed) + (o.name == "diagnoses" ? "" : ", " + o.name);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path to = folder / all[i].name;
        const bool there = fs::exists(to / "diagnosis.json");
        if (!there && !o.scoreOnly && !o.from.empty())
            copySimulations(fs::path(o.out) / o.part / o.from / all[i].name, to);
        if (!there && (o.scoreOnly || !make(all[i]) || !diagnose(o, all[i], cases, to)))
            continue;
        scores.push_back(
            scoreCase((cases / "answers" / (all[i].name + ".json")).string(), (to / "diagnosis.json").string()));
        if (!there) {
            const CaseScore& j = scores.back();
            std::printf("%s (%zu of %zu): %s\n", j.name.c_str(), i + 1, all.size(), j.statement.c_str());
            std::fflush(stdout);
        }
        if (!there || i + 1 == all.size()) { // intermediate scores for a reader
            writeAtomically(folder / "scores.json", asJson(scores, title));
            writeAtomically(folder / "scores.txt", asText(scores, title));
            writeAtomically(folder / "report.html", asPage(scores, title, ""));
        }
    }
    if (o.scoreOnly && !scores.empty()) {
        writeAtomically(folder / "scores.json", asJson(scores, title));
        writeAtomically(folder / "scores.txt", asText(scores, title));
        writeAtomically(folder / "report.html", asPage(scores, title, ""));
    }
    std::printf("%s\nreport: %s\n", asText(scores, title).c_str(), (folder / "report.html").c_str());
    if (o.further)
        diagnoseWithProposedRuns(o, all, scores, folder);
    return scores.empty() ? 3 : 0;
}

std::set<std::size_t> numbersIn(const std::string& list) {
    std::set<std::size_t> out;
    std::istringstream in(list);
    for (std::string word; std::getline(in, word, ',');)
        out.insert(std::strtoull(word.c_str(), nullptr, 10));
    return out;
}

} // namespace

int main(int argc, char** argv) {
    Options o;
    bool valid = true;
    for (int i = 1; i < argc; ++i) {
        const std::string key = argv[i];
        if (key == "--") {
            o.flags.assign(argv + i + 1, argv + argc);
            break;
        }
        if (key == "--help") {
            std::fputs(kUsage, stdout);
            return 0;
        }
        if (key == "--score") {
            o.scoreOnly = true;
            continue;
        }
        if (key == "--further") {
            o.further = true;
            continue;
        }
        if (key == "--self-check") {
            o.selfCheck = true;
            continue;
        }
        if (key == "--simulator-distance") {
            o.simulatorDistance = true;
            continue;
        }
        if (i + 1 >= argc) {
            valid = false;
            break;
        }
        const std::string value = argv[++i];
        if (key == "--program")
            o.program = value;
        else if (key == "--out")
            o.out = value;
        else if (key == "--part")
            o.part = value;
        else if (key == "--name")
            o.name = value;
        else if (key == "--from")
            o.from = value;
        else if (key == "--only")
            o.only = numbersIn(value);
        else if (key == "--jobs")
            o.jobs = value;
        else if (key == "--first")
            o.first = std::max<std::size_t>(1, std::strtoull(value.c_str(), nullptr, 10));
        else if (key == "--limit")
            o.limit = std::strtoull(value.c_str(), nullptr, 10);
        else if (key == "--seed")
            o.seed = std::strtoull(value.c_str(), nullptr, 10);
        else
            valid = false;
    }
    if (!valid || o.out.empty() || (o.program.empty() && !o.scoreOnly) || !isPart(o.part)) {
        std::fputs(kUsage, stderr);
        return 2;
    }
    try {
        return work(o);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 3;
    }
}
