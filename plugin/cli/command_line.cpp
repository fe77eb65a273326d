#include "plugin/cli/command_line.h"

#include "plugin/cli/sibling.h"
#include "plugin/cli/subcommands.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <thread>
#include <unistd.h>

namespace supercircle::cli {

std::atomic<bool> interrupted{false};
bool allowOutside = false;

const char* const kExperimentParameterHelp = "NAME=VALUE: set a physical parameter of the experiment (repeatable)";

namespace {

void onInterrupt(int signal) {
    interrupted = true;
    std::signal(signal, SIG_DFL); // a second Ctrl-C ends the program at once
}

void listenToSignals() {
    std::signal(SIGINT, onInterrupt);
    std::signal(SIGTERM, onInterrupt);
    std::signal(SIGHUP, onInterrupt);
    // A full disk, a file-size limit or a closed pipe makes the write fail, which reports the error.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

void unknownSubcommand(const CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(subcommand->get_name());
    std::fprintf(stderr, "there is no subcommand \"%s\"%s\nRun with --help for more information.\n", word.c_str(),
                 didYouMean(word, names).c_str());
}

/// Starts the sibling with the arguments of this program.
int start(const Sibling& sibling, int argc, char** argv) {
    return startSibling(sibling.subcommand, sibling.program,
                        std::vector<std::string>(argv + (sibling.passName ? 1 : 2), argv + argc));
}

/// Calls `work`; an exception becomes a message and an exit code.
int guarded(const std::function<int()>& work) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "supercircle: out of memory\n");
    } catch (const std::exception& e) {
        std::fprintf(stderr, "supercircle: internal error, please report it: %s\n", e.what());
    }
    return kCannotGoOn;
}

/// The exit code where parsing ended the program (bad arguments, help, version), else -1.
int parse(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::RequiredError& e) {
        // CLI11 would say that a subcommand is required, not that it is unknown.
        if (argc > 1 && app.get_subcommands().empty() && app.get_require_subcommand_min() > 0) {
            unknownSubcommand(app, argv[1]);
            return kBadInput;
        }
        app.exit(e);
        return kBadInput;
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? kDone : kBadInput; // help and version come here too, with 0
    }
    return -1;
}

} // namespace

int runProgram(int argc, char** argv, const std::string& name, const std::string& about, const Describe& describe,
               const std::vector<Sibling>& siblings) {
    listenToSignals();
    return guarded([&] {
        if (argc > 1)
            for (const Sibling& s : siblings)
                if (s.subcommand == argv[1])
                    return start(s, argc, argv);
        CLI::App app{about, name};
        app.set_version_flag("--version", SC_VERSION);
        app.require_subcommand(1);
        app.failure_message(CLI::FailureMessage::simple);
        const std::vector<Subcommand> subcommands = describe(app);
        for (const Sibling& s : siblings)
            app.add_subcommand(s.subcommand, s.about);
        if (const int code = parse(app, argc, argv); code >= 0)
            return code;
        for (const Subcommand& s : subcommands)
            if (s.options->parsed())
                return s.run();
        for (const Sibling& s : siblings) // options of this program stand before it
            if (app.got_subcommand(s.subcommand))
                return start(s, argc, argv);
        return static_cast<int>(kBadInput);
    });
}

int runPlainProgram(int argc, char** argv, const std::string& name, const std::string& about,
                    const std::function<std::function<int()>(CLI::App& app)>& describe) {
    listenToSignals();
    return guarded([&] {
        CLI::App app{about, name};
        app.set_version_flag("--version", SC_VERSION);
        app.failure_message(CLI::FailureMessage::simple);
        const std::function<int()> run = describe(app);
        const int code = parse(app, argc, argv);
        return code >= 0 ? code : run();
    });
}

void endOnSignal() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        std::signal(signal, [](int) { std::_Exit(kInterrupted); });
    if (interrupted) // it came before
        std::_Exit(kInterrupted);
}

CLI::Option* addRepeatable(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                           const std::string& help) {
    return app.add_option(name, values, help)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void addParameters(CLI::App& app, std::vector<std::string>& parameters, const char* help) {
    addRepeatable(app, "--param", parameters, help)->type_name("NAME=VALUE");
}

void addAllowOutside(CLI::App& app) {
    app.add_flag("--allow-outside", allowOutside, "read files outside of the experiment's folder too");
}

Subcommand describeCheckOf(CLI::App& app, int (*check)(const std::string&, const std::vector<std::string>&)) {
    struct Arguments {
        std::string file;
        std::vector<std::string> parameters;
    };
    auto a = std::make_shared<Arguments>(); // the options write into it
    CLI::App* subcommand = app.add_subcommand("check", "validate a file without running it")->group("");
    subcommand->add_option("file", a->file)->required()->type_name("FILE.json");
    addParameters(*subcommand, a->parameters);
    addAllowOutside(*subcommand);
    return {subcommand, [a, check] { return check(a->file, a->parameters); }};
}

void addFormerName(CLI::App& app, const std::string& old, const std::string& now, std::vector<std::string>& values) {
    const auto append = [old, now, &values](const std::vector<std::string>& given) {
        std::fprintf(stderr, "warning: %s is called %s since 0.2; the old name will be removed in 0.3\n", old.c_str(),
                     now.c_str());
        values.insert(values.end(), given.begin(), given.end());
    };
    app.add_option_function<std::vector<std::string>>(old, append, "former name of " + now)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group(""); // not in the help
}

void addJobs(CLI::App& app, int& jobs, int most, const char* help) {
    app.add_option("--jobs", jobs, help)
        ->check(CLI::Range(1, most).description(""))
        ->type_name("N")
        ->capture_default_str();
}

void addAccuracy(CLI::App& app, std::string& accuracy) {
    app.add_option("--accuracy", accuracy, "how finely the test is stepped (default: as the scene says, else exact)")
        ->check(CLI::IsMember(scene::kAccuracies).description(""))
        ->type_name("exact|standard|fast");
}

std::optional<scene::Accuracy> accuracyOf(const std::string& name) {
    const auto found = std::find(scene::kAccuracies.begin(), scene::kAccuracies.end(), name);
    if (found == scene::kAccuracies.end())
        return std::nullopt;
    return static_cast<scene::Accuracy>(found - scene::kAccuracies.begin());
}

int cores(int most) {
    return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, most);
}

std::string wholeFromZero(const std::string& text) {
    std::int64_t value = 0;
    const bool valid = CLI::detail::lexical_cast(text, value) && value >= 0;
    return valid ? "" : text + " is not a whole number from 0 to 9223372036854775807";
}

std::string positive(const std::string& text) {
    double value = 0.0;
    const bool valid = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0;
    return valid ? "" : text + " is not a positive number";
}

} // namespace supercircle::cli
