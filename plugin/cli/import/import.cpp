#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "plugin/pages/import/import_page.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/import/specimen_file.h"
#include "plugin/recording/import/template.h"
#include "plugin/recording/table/text.h"

#include <cstdio>

namespace supercircle::cli {

namespace {

/// The report with assumptions and missing values.
std::string wholeAccount(const importing::Imported& imported, const importing::Description& d) {
    std::string text = importing::account(imported);
    for (const std::string& remark : d.remarks)
        text += "derived: " + remark + "\n";
    text += "assumed in experiment.json (correct what is wrong):\n";
    for (const std::string& s : d.assumed)
        text += "  " + s + "\n";
    if (!d.todo.empty())
        text += "null in experiment.json, to be filled in before a replay (or given with --specimen and --protocol):\n";
    for (const std::string& todo : d.todo)
        text += "  " + todo + "\n";
    return text;
}

/// Keeps an earlier experiment.json under another name.
void keepOld(const std::string& folder, std::vector<record::NamedText>& files, const std::string& fresh,
             std::string& account) {
    const auto old = record::readText(folder + "/experiment.json");
    if (!old || *old == fresh)
        return;
    files.emplace_back("experiment.old.json", *old);
    account += "the earlier experiment.json is kept as experiment.old.json (give it with --specimen to reuse its "
               "values)\n";
}

/// Reports whether the written experiment can be replayed, if nothing is null.
void printReady(const importing::Description& d, const std::string& file) {
    if (!d.todo.empty())
        return;
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::load(file, problems);
    for (const scene::Problem& p : problems)
        std::printf("%s\n", p.toString().c_str());
    if (loaded)
        std::printf("ready: supercircle replay %s\n", file.c_str());
    else
        std::printf("not ready: `supercircle check %s` reports the same until this is corrected\n", file.c_str());
}

/// With quotes for a shell where they are needed.
std::string word(const std::string& text) {
    const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/+:,=";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos)
        return text;
    std::string out = "'";
    for (const char c : text)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

/// With all digits: the command gives the same bits.
std::string exact(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

/// The command without the options that the page states as decisions: columns, signs and the zero of the force. Of
/// several files and runs it has those that were given.
std::string commandOf(const ImportArguments& a, bool alone) {
    std::string command = "supercircle import";
    const auto add = [&](const char* option, const std::string& value) {
        command += value.empty() ? "" : " " + std::string(option) + " " + word(value);
    };
    const auto number = [&](const char* option, double value, double usual) {
        command += value == usual ? "" : " " + std::string(option) + " " + exact(value);
    };
    for (const std::string& file : a.files)
        command += " " + word(file);
    add("--specimen", a.specimen);
    add("--protocol", a.protocol);
    add("--scene", a.scene);
    add("--encoding", a.encoding);
    number("--rate", a.rate, 0.0);
    number("--speed", a.speed, 0.0);
    number("--tolerance", a.tolerance, 0.0);
    number("--from-turning-point", a.fromTurningPoint, 0.0);
    number("--average", a.average, 1.0);
    for (const auto& [option, values] :
         {std::pair{"--accept", &a.accept}, std::pair{"--cut", &a.cut}, std::pair{"--keep", &a.keep}})
        for (const std::string& value : *values)
            add(option, value);
    add("--units", a.units);
    if (!alone) {
        const auto sign = [](int s) { return s == 0 ? "" : s > 0 ? "positive" : "negative"; };
        add("--columns", a.columns);
        add("--displacement", sign(a.displacementSign));
        add("--force", sign(a.forceSign));
        add("--force-zero", a.forceZero);
    }
    add("--out", a.out);
    return command;
}

/// The options as hints. Errors name the option.
Result<importing::Hints> hintsOf(const ImportArguments& a) {
    using Answer = Result<importing::Hints>;
    importing::Hints hints;
    hints.encoding = importing::encodingOf(a.encoding);
    if (!a.columns.empty()) // "time[s],displacement[mm],-"
        hints.columns = record::splitAt(a.columns, ',');
    for (const std::string& text : a.units.empty() ? std::vector<std::string>{} : record::splitAt(a.units, ',')) {
        hints.units.push_back(importing::unitOf(text));
        if (hints.units.back().measures == importing::Quantity::None)
            return Answer::failure("--units: \"" + text + "\" is no unit; expected for instance s,mm,N");
    }
    hints.rate = a.rate;
    hints.speed = 1e-3 * a.speed;
    hints.driveTolerance = 1e-3 * a.tolerance;
    hints.displacementSign = a.displacementSign;
    hints.forceSign = a.forceSign;
    hints.fromTurningPoint = a.fromTurningPoint;
    hints.average = a.average;
    hints.atRest = !a.scene.empty();
    hints.accept = {a.accept.begin(), a.accept.end()};
    hints.cut = {a.cut.begin(), a.cut.end()};
    hints.keep = {a.keep.begin(), a.keep.end()};
    if (a.forceZero.empty() && a.specimen.empty())
        return hints;
    const auto zero =
        a.forceZero.empty() ? importing::statedForceZero(a.specimen) : importing::parseForceZero(a.forceZero);
    if (!zero)
        return Answer::failure((a.forceZero.empty() ? "" : "--force-zero: ") + zero.error());
    hints.forceZero = *zero;
    return hints;
}

} // namespace

int import(const ImportArguments& a) {
    const auto hints = hintsOf(a);
    if (!hints) {
        std::fprintf(stderr, "%s\n", hints.error().c_str());
        return kBadInput;
    }
    const auto imported = importing::readExports(a.files, *hints);
    if (!imported) {
        std::fprintf(stderr, "%s\n", imported.error().c_str());
        return kBadInput;
    }
    const auto description = importing::describe(*imported, {a.protocol, a.specimen, a.scene});
    if (!description) {
        std::fprintf(stderr, "%s\n", description.error().c_str());
        return kBadInput;
    }
    auto files = importing::runFiles(*imported);
    if (!files) {
        std::fprintf(stderr, "%s\n", files.error().c_str());
        return kBadInput;
    }
    std::string account = wholeAccount(*imported, *description);
    OutputFolder folder(a.out);
    std::string error = folder.prepare();
    if (error.empty()) {
        keepOld(folder.path(), *files, description->json, account);
        for (const record::NamedText& beside : description->files)
            files->push_back(beside);
        files->emplace_back("experiment.json", description->json);
        files->emplace_back("import.json", importing::accountJson(*imported, *description));
        files->emplace_back("import.txt", account);
        files->emplace_back("import.html", importPage(*imported, commandOf(a, imported->sources.size() == 1 &&
                                                                                  imported->runs.size() == 1)));
        error = record::writeAtomically(folder.path(), *files).error();
    }
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet) {
        const std::size_t runs = imported->runs.size();
        std::printf("%swritten: %s/experiment.json, %zu run%s; this account: import.txt, import.json and import.html\n",
                    account.c_str(), folder.path().c_str(), runs, runs == 1 ? "" : "s");
        printReady(*description, folder.path() + "/experiment.json");
        std::printf("%s\n", importing::worst(*imported).c_str());
    }
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
