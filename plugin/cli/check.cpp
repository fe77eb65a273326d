#include "plugin/cli/input.h"
#include "plugin/cli/verbs.h"

#include "bridge/lab_world.h"

#include <cstdio>

namespace supercircle::cli {

int check(const std::string& file, const std::vector<std::string>& parameters) {
    const auto scene = loadScene(file, parameters);
    if (!scene)
        return kBadInput;
    std::string why;
    if (!bridge::makeWorld(scene->rigid, why)) {
        std::fprintf(stderr, "%s: %s\n", file.c_str(), why.c_str());
        return kBadInput;
    }
    std::printf("%s: a good scene (%zu shells%s, %zu bodies, %zu parameters)\n", file.c_str(), scene->shells.size(),
                scene->drop ? (" and " + std::to_string(scene->drop->count) + " dropped").c_str() : "",
                scene->rigid.bodies.size(), scene->parameters.size());
    for (const scene::Parameter& p : scene->parameters)
        std::printf("  %-14s %-10g %s  %s\n", p.name.c_str(), p.value, p.unit.c_str(), p.about.c_str());
    return kDone;
}

} // namespace supercircle::cli
