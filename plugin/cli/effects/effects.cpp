#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "supercircle/effects/effect.h"
#include "supercircle/support/names.h"

#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

std::string text(const effects::Parameter& p, double value) {
    if (!p.choices.empty())
        return p.choices[static_cast<std::size_t>(value)];
    if (std::isinf(value))
        return "none";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.4g", value);
    return buffer;
}

std::string range(const effects::Parameter& p) {
    if (!p.choices.empty()) {
        std::string all;
        for (const std::string& w : p.choices)
            all += (all.empty() ? "" : " | ") + w;
        return all;
    }
    return text(p, p.min) + " to " + (std::isinf(p.max) ? "any" : text(p, p.max));
}

void describe(const effects::Effect& e, bool all) {
    std::printf("%s (%s): %s\n", e.name.c_str(), effects::name(e.slot), e.about.c_str());
    if (all)
        std::printf("  law: %s\n  fingerprint: %s\n  literature: %s\n", e.law.c_str(), e.fingerprint.c_str(),
                    e.literature.c_str());
    for (std::size_t i = 0; i < e.parameters.size(); ++i) {
        const effects::Parameter& p = e.parameters[i];
        std::string name = p.name;
        while (i + 1 < e.parameters.size() && e.parameters[i + 1].about == p.about) // coefficients of one law
            ++i;
        if (const std::string& last = e.parameters[i].name; last != name)
            name += " to " + last;
        std::printf("  %-22s %-6s default %s%s, %s; %s\n", name.c_str(), p.unit.c_str(), text(p, p.off).c_str(),
                    p.isSwitch ? " (off)" : "", range(p).c_str(), p.about.c_str());
    }
}

} // namespace

int effects(const std::string& key) {
    if (!key.empty()) {
        const effects::Effect* e = effects::find(key);
        std::vector<std::string> names;
        for (const effects::Effect& known : effects::catalog())
            names.push_back(known.name);
        if (e == nullptr) {
            std::fprintf(stderr, "there is no effect \"%s\"%s\n", key.c_str(), didYouMean(key, names).c_str());
            return kBadInput;
        }
        describe(*e, true);
        return printed() ? kDone : kCannotWrite;
    }
    for (const effects::Effect& e : effects::catalog())
        describe(e, false);
    std::printf("In a scene: \"effects\": [{\"key\": ..., NAME: VALUE, \"shell\": \"all\"}]; on the command line: "
                "--effect KEY:NAME=VALUE. `supercircle effects KEY` prints its law and literature; see also "
                "docs/reference/effects.md.\n");
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
