#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/load.h"

#include <cstdio>

namespace supercircle::cli {

int checkExperiment(const std::string& file, const std::vector<std::string>& parameters) {
    std::vector<scene::Problem> problems;
    const auto loaded =
        experiment::load(file, problems, allowOutside ? experiment::Outside::Allowed : experiment::Outside::Refused);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!loaded)
        return kBadInput;
    replay::Parameters values = replay::nominal(*loaded);
    std::vector<scene::Override> overrides;
    if (!readOverrides(parameters, overrides))
        return kBadInput;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(values, *loaded, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return kBadInput;
        }
    std::printf("%s: valid experiment (%s, %zu specimens, %zu runs, %zu markers)\n", file.c_str(),
                experiment::name(loaded->protocol), loaded->specimens.size(), loaded->runs.size(),
                loaded->markers.size());
    for (const experiment::Run& run : loaded->runs)
        std::printf("  %-16s %zu samples, %g s%s\n", run.file.c_str(), run.readings.time.size(),
                    run.driveTime.back() - run.driveTime.front(), run.markers.time.empty() ? "" : ", with markers");
    for (const replay::ParameterInfo& p : replay::parameterList(*loaded))
        std::printf("  %-20s %-12.6g +- %-10.3g %-6s %s\n", p.name.c_str(),
                    replay::get(values, *loaded, p.name).value_or(0.0), p.stated.halfWidth, p.unit.c_str(),
                    p.about.c_str());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
