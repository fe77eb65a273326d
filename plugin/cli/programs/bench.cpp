// supercircle-bench: speed and memory.

#include "plugin/cli/command_line.h"
#include "plugin/cli/subcommands.h"

#include <memory>

namespace supercircle::cli {

namespace {

std::function<int()> describeBench(CLI::App& app) {
    struct Arguments {
        std::string filter, json;
    };
    auto a = std::make_shared<Arguments>(); // the options write into it
    app.add_option("--filter", a->filter, "only benchmarks whose name contains this")->type_name("NAME");
    app.add_option("--json", a->json, "write the figures to this file")->type_name("FILE");
    return [a] { return bench(a->filter, a->json); };
}

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    return runPlainProgram(argc, argv, "supercircle bench", "Measure speed and memory", describeBench);
}
