#include "plugin/cli/input.h"

#include <charconv>
#include <cstdio>

namespace supercircle::cli {

std::optional<scene::Scene> loadScene(const std::string& file, const std::vector<std::string>& parameters) {
    std::vector<scene::Override> overrides;
    for (const std::string& p : parameters) {
        const std::size_t eq = p.find('=');
        double value = 0.0;
        const char* first = p.data() + (eq == std::string::npos ? 0 : eq + 1);
        const char* last = p.data() + p.size();
        if (first < last && *first == '+')
            ++first;
        const auto [end, error] = std::from_chars(first, last, value);
        if (eq == std::string::npos || eq == 0 || error != std::errc{} || end != last) {
            std::fprintf(stderr, "--param %s: expected NAME=VALUE with a number, for example mu=0.35\n", p.c_str());
            return std::nullopt;
        }
        overrides.push_back({p.substr(0, eq), value});
    }
    std::vector<scene::Problem> problems;
    auto loaded = scene::load(file, overrides, problems);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s%s\n", p.severity == scene::Problem::Severity::Note ? "note: " : "",
                     p.toString().c_str());
    return loaded;
}

} // namespace supercircle::cli
