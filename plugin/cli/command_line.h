#pragma once
// Command-line parsing shared by all programs.

#include "plugin/scene/loader/scene.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// A subcommand of a program and what it does; the function returns the exit code.
struct Subcommand {
    CLI::App* options = nullptr;
    std::function<int()> run;
};

/// Adds its subcommands to the program.
using Describe = std::function<std::vector<Subcommand>(CLI::App& app)>;

/// A subcommand that another program beside this one carries out.
struct Sibling {
    std::string subcommand;
    std::string program;
    std::string about;
    bool passName = true; ///< whether that program takes the subcommand's name as its first argument
};

/// Parses the command line, runs the subcommand and returns the exit code; throws nothing. Programs with `siblings`
/// list them in their help and start them.
int runProgram(int argc, char** argv, const std::string& name, const std::string& about, const Describe& describe,
               const std::vector<Sibling>& siblings = {});

/// A program without subcommands: `run` is called once the options are read.
int runPlainProgram(int argc, char** argv, const std::string& name, const std::string& about,
                    const std::function<std::function<int()>(CLI::App& app)>& describe);

/// From now on Ctrl-C and SIGTERM end the program at once with code 130, for work that does not poll `interrupted`.
void endOnSignal();

/// An option that may be given several times, with one value each: one that takes several values would consume the
/// scene that follows it.
CLI::Option* addRepeatable(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                           const std::string& help);
/// --param NAME=VALUE, repeatable.
void addParameters(CLI::App& app, std::vector<std::string>& parameters,
                   const char* help = "NAME=VALUE: set a parameter of the scene (repeatable)");
extern const char* const kExperimentParameterHelp;
/// --allow-outside, for subcommands that read experiments.
void addAllowOutside(CLI::App& app);
/// A hidden subcommand `check FILE [--param ...]`: `supercircle check` starts it for what this program reads.
Subcommand describeCheckOf(CLI::App& app, int (*check)(const std::string&, const std::vector<std::string>&));
/// --accuracy exact|standard|fast.
void addAccuracy(CLI::App& app, std::string& accuracy);
/// The accuracy of that name; empty: none is given.
std::optional<scene::Accuracy> accuracyOf(const std::string& name);
/// --jobs N, 1 to `most`; as given in `jobs` unless the user says otherwise.
void addJobs(CLI::App& app, int& jobs, int most, const char* help);
/// Cores of this machine, 1 to `most`.
int cores(int most);
/// Accepts the former name `old` of the list option `now`: appends its values and prints a warning with the new name.
void addFormerName(CLI::App& app, const std::string& old, const std::string& now, std::vector<std::string>& values);
/// CLI11 checks: empty, or what is wrong.
std::string wholeFromZero(const std::string& text);
std::string positive(const std::string& text);

} // namespace supercircle::cli
