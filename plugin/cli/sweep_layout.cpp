#include "plugin/cli/sweep_layout.h"

#include "plugin/report/words.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

namespace supercircle::cli {

namespace {

using report::Colour;

/// Told apart by most eyes (P. Tol's "bright" scheme), the paper's three coefficients blue, red, green.
constexpr std::array kColours = {Colour::hex(0x4477AA), Colour::hex(0xEE6677), Colour::hex(0x228833),
                                 Colour::hex(0xCCBB44), Colour::hex(0xAA3377), Colour::hex(0x66CCEE),
                                 Colour::hex(0x882255), Colour::hex(0x332288)};

} // namespace

std::string shortNumber(double value, const char* format) {
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string parameterLabel(const std::string& name) {
    if (name == "phi_bar")
        return "Φ / 2π";
    if (name == "mu")
        return "μ";
    const std::string unit = report::parameterUnit(name);
    return report::plainName(name) + (unit.empty() ? "" : " (" + unit + ")");
}

std::string quantityLabel(const std::string& key) {
    const std::string unit = report::unitOf(key);
    return report::plainName(key) + (unit.empty() ? "" : " (" + unit + ")");
}

std::vector<SweepGroup> groupsOf(const sweep::Definition& sweep) {
    std::vector<SweepGroup> groups;
    for (std::size_t set = 0; set < sweep.sets.size(); ++set) {
        std::string label;
        double x = 0.0;
        for (std::size_t i = 0; i < sweep.names.size(); ++i)
            if (sweep.names[i] == sweep.x)
                x = sweep.sets[set][i];
            else
                label += (label.empty() ? "" : ", ") + parameterLabel(sweep.names[i]) + " = " +
                         shortNumber(sweep.sets[set][i]);
        auto at = std::find_if(groups.begin(), groups.end(), [&](const SweepGroup& g) { return g.label == label; });
        if (at == groups.end()) {
            groups.push_back({label, kColours[groups.size() % kColours.size()], {}, {}});
            at = groups.end() - 1;
        }
        at->x.push_back(x);
        at->sets.push_back(set);
    }
    for (SweepGroup& g : groups) {
        std::vector<std::size_t> order(g.x.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return g.x[a] < g.x[b]; });
        SweepGroup sorted = g;
        for (std::size_t i = 0; i < order.size(); ++i) {
            sorted.x[i] = g.x[order[i]];
            sorted.sets[i] = g.sets[order[i]];
        }
        g = std::move(sorted);
    }
    return groups;
}

} // namespace supercircle::cli
