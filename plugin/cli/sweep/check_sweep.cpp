#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"
#include "plugin/cli/sweep/sweep_input.h"

#include "plugin/scene/loader/document.h"

#include <cstdio>

namespace supercircle::cli {

int checkSweep(const std::string& file, const std::vector<std::string>& parameters) {
    if (!parameters.empty()) {
        std::fprintf(stderr,
                     "--param: a sweep sets its parameters in the file, with \"grid\", \"cases\" and \"fixed\"\n");
        return kBadInput;
    }
    std::vector<scene::Problem> problems;
    const auto loaded = sweep::load(file, problems);
    const auto text = loaded ? scene::readFile(loaded->scene, problems) : Result<std::string>::failure("no sweep");
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!text)
        return kBadInput;
    for (std::size_t set = 0; set < loaded->sets.size(); ++set)
        if (!canStart(*text, loaded->scene, loaded->parameterValues(set)))
            return kBadInput;
    std::printf("%s: valid sweep of %s (%zu sets of parameters, %zu seeds, %zu runs)\n", file.c_str(),
                loaded->scene.c_str(), loaded->sets.size(), loaded->seeds.size(),
                loaded->sets.size() * loaded->seeds.size());
    for (std::size_t set = 0; set < loaded->sets.size() && set < 100; ++set)
        std::printf("  %s\n", sweep::keyOf(loaded->parameterValues(set)).c_str());
    if (loaded->sets.size() > 100)
        std::printf("  and %zu more\n", loaded->sets.size() - 100);
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
