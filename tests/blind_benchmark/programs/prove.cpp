// prove: conceals cases (those that are not there yet), lets `supercircle diagnose` loose on each (those it has not
// diagnosed yet), and scores what it said. Can be stopped at any time; the same command goes on.
//
//   prove --program build/dev/plugin/supercircle --out out/proof [--part tuning|blind|limit] [--first N] [--limit N]
//         [--only N,N,...] [--jobs N] [--score] [--name NAME] [--from NAME] [--further] [--own] [--apart]
//         [-- flags for diagnose ...]
//
// --first A --limit B: cases A to B, counted from 1 in the order of the set; several processes may share a folder.
// --only 2,5: of these cases those with these numbers. --score: score what there is, diagnose nothing. --name: folder
// of the diagnoses (default "diagnoses"), so that the same cases can be diagnosed with other flags. --from: what the
// diagnoses of that name have simulated needs no simulation again (the digits are the same). --further: where a
// diagnosis does not decide and proposes runs, these are recorded with the same hidden effect and everything is
// diagnosed again. --own: the program's own simulator records the cases instead of the second one (an ablation; with
// --name own). --apart: diagnoses nothing; how far the two simulators' readings are apart in each case with the true
// numbers and effects, in units of its noise, and in how many deviations the best possible test would tell them apart:
// what stands out there is no diagnosis' fault.

#include "tests/blind_benchmark/conceal/record.h"
#include "tests/blind_benchmark/prove/own.h"
#include "tests/blind_benchmark/prove/scores.h"

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
using namespace supercircle::oracle;

struct Options {
    std::string program, out, part = "blind", name = "diagnoses", from, jobs = "2";
    std::set<std::size_t> only; ///< empty: all
    std::size_t first = 1, limit = 1000000;
    std::uint64_t seed = 0;
    bool scoreOnly = false, further = false, own = false, apart = false;
    std::vector<std::string> flags;
};

int run(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& w : words)
        arguments.push_back(const_cast<char*>(w.c_str()));
    arguments.push_back(nullptr);
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        execv(arguments.front(), arguments.data());
        _exit(127);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) < 0)
        return 127;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 130;
}

/// Writes a case, the answer last.
bool write(const Concealed& c, const std::string& name, const fs::path& folder) {
    if (!c.failure.empty()) {
        std::fprintf(stderr, "%s cannot be recorded: %s\n", name.c_str(), c.failure.c_str());
        return false;
    }
    fs::create_directories(folder / name);
    fs::create_directories(folder / "answers");
    for (const auto& [file, text] : c.files)
        writeWhole(folder / name / file, text);
    writeWhole(folder / "answers" / (name + ".json"), c.answer);
    return true;
}

/// Makes a case unless it is there.
bool provide(const Plan& plan, const fs::path& folder, const std::vector<Further>& further = {}) {
    return fs::exists(folder / "answers" / (plan.name + ".json")) || write(conceal(plan, further), plan.name, folder);
}

/// What the program's own simulator reads with the true numbers and effects.
std::optional<Clean> replayCase(const Options& o, const Plan& plan, const fs::path& cases, const fs::path& to) {
    if (!provide(plan, cases))
        return std::nullopt;
    const fs::path experiment = cases / plan.name / "experiment.json";
    std::vector<std::string> words = {o.program, "replay", experiment.string(), "--out", to.string(), "--quiet"};
    for (const std::string& w : truthFlags((cases / "answers" / (plan.name + ".json")).string()))
        words.push_back(w);
    if (const int code = run(words); code != 0) {
        std::fprintf(stderr, "%s: replay ended with %d\n", plan.name.c_str(), code);
        return std::nullopt;
    }
    std::ifstream in(experiment);
    const auto described = nlohmann::json::parse(in);
    const bool markers = described.at("runs").front().contains("markers_file");
    return replayed(to.string(), described.at("runs").size(), markers);
}

/// The case as the program's own simulator records it, unless it is there.
bool provideOwn(const Options& o, const Plan& plan, const fs::path& cases, const fs::path& own) {
    if (fs::exists(own / "answers" / (plan.name + ".json")))
        return true;
    const auto clean = replayCase(o, plan, cases, own / "replays" / plan.name);
    return clean && write(conceal(plan, {}, &*clean), plan.name, own);
}

/// How well the two simulators can be told apart in each case, at the truth.
int compare(const Options& o, const std::vector<Plan>& all) {
    const fs::path folder = fs::path(o.out) / o.part;
    bool fine = true;
    std::printf("%-9s %-6s %-44s %9s %6s   %9s %6s   %s\n", "case", "", "hidden", "itself", "best", "ours", "best",
                "markers");
    std::printf("%-9s %-6s %-44s %9s %6s   %9s %6s\n", "", "", "", "rms", "test", "rms", "test");
    for (const Plan& plan : all) {
        const auto clean = replayCase(o, plan, folder / "cases", folder / "apart" / plan.name);
        const Accuracy a = clean ? accuracyOf(plan, &*clean) : Accuracy{"cannot be replayed"};
        if (!a.failure.empty()) {
            std::fprintf(stderr, "%s: %s\n", plan.name.c_str(), a.failure.c_str());
            fine = false;
            continue;
        }
        std::ifstream in(folder / "cases" / "answers" / (plan.name + ".json"));
        const auto answer = nlohmann::json::parse(in);
        std::string hidden;
        for (const auto& label : answer.at("labels"))
            hidden += (hidden.empty() ? "" : ", ") + label.get<std::string>();
        std::printf("%-9s %-6s %-44s %9.3f %6.1f   %9.3f %6.1f   %.2f\n", plan.name.c_str(),
                    answer.at("protocol").get<std::string>().c_str(), hidden.c_str(), a.rms, a.detectable, a.otherRms,
                    a.otherDetectable, a.otherMarkers);
        std::fflush(stdout);
    }
    return fine ? 0 : 3;
}

/// Kept simulations of another diagnosis of the same case.
void takeOver(const fs::path& from, const fs::path& to) {
    if (!fs::is_directory(from))
        return;
    fs::create_directories(to);
    for (const auto& file : fs::directory_iterator(from))
        if (file.path().extension() == ".cache")
            fs::copy_file(file.path(), to / file.path().filename(), fs::copy_options::skip_existing);
}

bool diagnose(const Options& o, const Plan& plan, const fs::path& cases, const fs::path& to) {
    if (fs::exists(to / "diagnosis.json"))
        return true;
    std::vector<std::string> words = {o.program, "diagnose",  (cases / plan.name / "experiment.json").string(),
                                      "--out",   to.string(), "--jobs",
                                      o.jobs,    "--quiet"};
    std::ifstream in(cases / "answers" / (plan.name + ".json"));
    const auto answer =
        nlohmann::json::parse(in); // named: a range over a part of a temporary would be one over nothing
    for (const auto& label : answer.at("diagnose_without")) {
        words.emplace_back("--without");
        words.push_back(label);
    }
    words.insert(words.end(), o.flags.begin(), o.flags.end());
    const int code = run(words);
    if (code == 130)
        throw std::runtime_error("interrupted; the same command goes on");
    if (code != 0)
        std::fprintf(stderr, "%s: diagnose ended with %d\n", plan.name.c_str(), code);
    return code == 0;
}

/// The cases that were left open, once more with the runs that were asked for. @param before as judged, same order
void settle(const Options& o, const std::vector<Plan>& all, const std::vector<Judged>& before, const fs::path& folder) {
    const fs::path cases = fs::path(o.out) / o.part / (o.name + "_further_cases"),
                   to = fs::path(o.out) / o.part / (o.name + "_further");
    Share decided, weakDecided, unsure;
    std::string lines;
    for (const Judged& was : before) {
        const auto plan = std::find_if(all.begin(), all.end(), [&](const Plan& p) { return p.name == was.name; });
        const auto runs = proposedRuns((folder / was.name / "diagnosis.json").string());
        if (!open(was) || runs.empty() || plan == all.end())
            continue;
        if (!fs::exists(to / was.name / "diagnosis.json") &&
            (o.scoreOnly || !provide(*plan, cases, runs) || !diagnose(o, *plan, cases, to / was.name)))
            continue;
        const Judged now =
            judge((cases / "answers" / (was.name + ".json")).string(), (to / was.name / "diagnosis.json").string());
        // Runs in which the second simulator is not sure of itself settle nothing: such cases are drawn again, too.
        const bool counts = now.furtherOwnError <= kSureOfItself;
        if (counts)
            (was.wouldSettle ? decided : unsure).count(settled(now));
        if (counts && was.wouldSettle && was.verdict == "not_enough_information")
            weakDecided.count(settled(now));
        char sure[96];
        std::snprintf(sure, sizeof sure, " (%ssecond simulator sure to %.2f%s)",
                      was.wouldSettle ? "" : "may not settle it; ", now.furtherOwnError, counts ? "" : ", not counted");
        lines += "  " + was.name + " (" + was.verdict + "): " + was.next + sure + "\n    " +
                 (settled(now) ? "settled" : "open or wrong") + ": " + now.statement + "\n";
    }
    const auto share = [](const Share& s) {
        char text[80];
        std::snprintf(text, sizeof text, "%d of %d, %.2f [%.2f, %.2f]", s.hits, s.of, s.value(), s.low(), s.high());
        return std::string(text);
    };
    const std::string text = "cases left open in which what was asked for settles it: " + share(decided) +
                             "\n  of those said not to hold enough information: " + share(weakDecided) +
                             "\nwhere it was said to tell most, but perhaps not enough: " + share(unsure) + "\n" +
                             lines;
    fs::create_directories(to);
    writeWhole(to / "settled.txt", text);
    std::printf("\n%s", text.c_str());
}

int work(const Options& o) {
    const std::uint64_t seed = o.seed != 0 ? o.seed : o.part == "tuning" ? 1 : 2026;
    const fs::path second = fs::path(o.out) / o.part / "cases", folder = fs::path(o.out) / o.part / o.name;
    const fs::path cases = o.own ? fs::path(o.out) / o.part / "own_cases" : second;
    const auto make = [&](const Plan& plan) {
        return o.own ? provideOwn(o, plan, second, cases) : provide(plan, cases);
    };
    std::vector<Plan> all;
    const std::vector<Plan> set = plans(o.part, seed);
    for (std::size_t number = o.first; number <= std::min(o.limit, set.size()); ++number)
        if (o.only.empty() || o.only.count(number) > 0)
            all.push_back(set[number - 1]);
    if (all.empty())
        throw std::runtime_error("no such case: the set has " + std::to_string(set.size()) +
                                 ", and --first A --limit B are the first and the last of those wanted");
    if (o.apart)
        return compare(o, all);
    std::vector<Judged> judged;
    const std::string title = "Proof of the diagnosis, part \"" + o.part + "\", seed " + std::to_string(seed) +
                              (o.name == "diagnoses" ? "" : ", " + o.name);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path to = folder / all[i].name;
        const bool there = fs::exists(to / "diagnosis.json");
        if (!there && !o.scoreOnly && !o.from.empty())
            takeOver(fs::path(o.out) / o.part / o.from / all[i].name, to);
        if (!there && (o.scoreOnly || !make(all[i]) || !diagnose(o, all[i], cases, to)))
            continue;
        judged.push_back(
            judge((cases / "answers" / (all[i].name + ".json")).string(), (to / "diagnosis.json").string()));
        if (!there) {
            const Judged& j = judged.back();
            std::printf("%s (%zu of %zu): %s\n", j.name.c_str(), i + 1, all.size(), j.statement.c_str());
            std::fflush(stdout);
        }
        if (!there || i + 1 == all.size()) { // whoever looks meanwhile sees what there is
            writeWhole(folder / "scores.json", asJson(judged, title));
            writeWhole(folder / "scores.txt", asText(judged, title));
            writeWhole(folder / "report.html", asPage(judged, title, ""));
        }
    }
    if (o.scoreOnly && !judged.empty()) {
        writeWhole(folder / "scores.json", asJson(judged, title));
        writeWhole(folder / "scores.txt", asText(judged, title));
        writeWhole(folder / "report.html", asPage(judged, title, ""));
    }
    std::printf("%s\npage: %s\n", asText(judged, title).c_str(), (folder / "report.html").c_str());
    if (o.further)
        settle(o, all, judged, folder);
    return judged.empty() ? 3 : 0;
}

std::set<std::size_t> numbersOf(const std::string& list) {
    std::set<std::size_t> out;
    std::istringstream in(list);
    for (std::string word; std::getline(in, word, ',');)
        out.insert(std::strtoull(word.c_str(), nullptr, 10));
    return out;
}

} // namespace

int main(int argc, char** argv) {
    Options o;
    bool good = true;
    for (int i = 1; i < argc; ++i) {
        const std::string key = argv[i];
        if (key == "--") {
            o.flags.assign(argv + i + 1, argv + argc);
            break;
        }
        if (key == "--score") {
            o.scoreOnly = true;
            continue;
        }
        if (key == "--further") {
            o.further = true;
            continue;
        }
        if (key == "--own") {
            o.own = true;
            continue;
        }
        if (key == "--apart") {
            o.apart = true;
            continue;
        }
        if (i + 1 >= argc) {
            good = false;
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
            o.only = numbersOf(value);
        else if (key == "--jobs")
            o.jobs = value;
        else if (key == "--first")
            o.first = std::max<std::size_t>(1, std::strtoull(value.c_str(), nullptr, 10));
        else if (key == "--limit")
            o.limit = std::strtoull(value.c_str(), nullptr, 10);
        else if (key == "--seed")
            o.seed = std::strtoull(value.c_str(), nullptr, 10);
        else
            good = false;
    }
    if (!good || o.out.empty() || (o.program.empty() && !o.scoreOnly) || !isPart(o.part)) {
        std::fprintf(stderr,
                     "prove --program SUPERCIRCLE --out DIR [--part tuning|blind|limit] [--first N] [--limit N] "
                     "[--only N,N] [--jobs N]"
                     " [--seed N] [--score] [--further] [--own] [--apart] [--name NAME] [--from NAME] [-- "
                     "flags for diagnose ...]\n");
        return 2;
    }
    try {
        return work(o);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 3;
    }
}
