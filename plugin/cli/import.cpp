#include "plugin/cli/output.h"
#include "plugin/cli/verbs.h"

#include "plugin/experiment/load.h"
#include "plugin/importing/template.h"

#include <algorithm>
#include <cstdio>

namespace supercircle::cli {

namespace {

/// "time[s],displacement[mm],-" as names per column.
std::vector<std::string> splitNames(const std::string& list) {
    std::vector<std::string> names;
    std::size_t from = 0;
    while (!list.empty() && from <= list.size()) {
        const std::size_t to = std::min(list.find(',', from), list.size());
        names.push_back(list.substr(from, to - from));
        from = to + 1;
    }
    return names;
}

/// What stands between the import and a replay; empty: nothing.
void printNext(const importing::Description& d, const std::string& file) {
    if (!d.todo.empty()) {
        std::printf("to be filled in in %s before it can be replayed (or given with --specimen and --protocol):\n",
                    file.c_str());
        for (const std::string& todo : d.todo)
            std::printf("  %s\n", todo.c_str());
        return;
    }
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::load(file, problems);
    for (const scene::Problem& p : problems)
        std::printf("%s\n", p.toString().c_str());
    if (loaded)
        std::printf("ready: supercircle replay %s\n", file.c_str());
}

} // namespace

int import(const ImportArguments& a) {
    importing::Hints hints;
    hints.columns = splitNames(a.columns);
    hints.rate = a.rate;
    hints.speed = 1e-3 * a.speed;
    hints.driveTolerance = 1e-3 * a.tolerance;
    hints.displacementSign = a.displacementSign;
    hints.forceSign = a.forceSign;
    const auto imported = importing::readExports(a.files, hints);
    if (!imported) {
        std::fprintf(stderr, "%s\n", imported.error.c_str());
        return kBadInput;
    }
    const auto description = importing::describe(imported.value, {a.protocol, a.specimen});
    if (!description) {
        std::fprintf(stderr, "%s\n", description.error.c_str());
        return kBadInput;
    }
    auto files = importing::runFiles(imported.value);
    if (!files) {
        std::fprintf(stderr, "%s\n", files.error.c_str());
        return kBadInput;
    }
    std::string account = importing::account(imported.value);
    for (const std::string& remark : description.value.remarks)
        account += "worked out: " + remark + "\n";
    files.value.emplace_back("experiment.json", description.value.json);
    files.value.emplace_back("import.json", importing::accountJson(imported.value, description.value));
    files.value.emplace_back("import.txt", account);
    Folder folder(a.out);
    std::string error = folder.prepare();
    if (error.empty())
        error = record::writeAtomically(folder.path(), files.value);
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet) {
        std::printf("%swritten: %s/experiment.json, %zu runs; this account: import.txt and import.json\n",
                    account.c_str(), folder.path().c_str(), imported.value.runs.size());
        printNext(description.value, folder.path() + "/experiment.json");
    }
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
