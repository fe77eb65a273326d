#include "plugin/pages/sweep/sweep_layout.h"

#include "plugin/pages/run/key_labels.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <numeric>

namespace supercircle::pages {

namespace {

using graphics::Colour;

/// Distinct for most readers (P. Tol's "bright" scheme); the paper's three coefficients are blue, red, green.
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
    const std::string unit = pages::parameterUnit(name);
    return pages::keyLabel(name) + (unit.empty() ? "" : " (" + unit + ")");
}

std::string quantityLabel(const std::string& key) {
    const std::string unit = pages::keyUnit(key);
    return pages::keyLabel(key) + (unit.empty() ? "" : " (" + unit + ")");
}

namespace {

/// Whether a parameter varies with the abscissa only, such as a box that widens with the number of shells.
bool followsAbscissa(const sweep::SweepDefinition& sweep, std::size_t parameter) {
    const auto x =
        static_cast<std::size_t>(std::find(sweep.names.begin(), sweep.names.end(), sweep.x) - sweep.names.begin());
    if (x == sweep.names.size() || x == parameter)
        return false;
    bool varies = false;
    for (const std::vector<double>& a : sweep.sets)
        for (const std::vector<double>& b : sweep.sets) {
            if (a[x] == b[x] && a[parameter] != b[parameter])
                return false;
            varies = varies || a[parameter] != b[parameter];
        }
    return varies;
}

/// The parameters that distinguish a group; of more than two, those that differ from the first group.
std::string labelOf(const sweep::SweepDefinition& sweep, const std::vector<char>& follows,
                    const std::vector<SweepGroup>& groups, std::size_t g) {
    const auto value = [&](std::size_t group, std::size_t i) { return sweep.sets[groups[group].sets.front()][i]; };
    std::vector<std::size_t> varying, named;
    for (std::size_t i = 0; i < sweep.names.size(); ++i) {
        bool varies = groups.size() == 1;
        for (std::size_t k = 1; k < groups.size(); ++k)
            varies = varies || value(k, i) != value(0, i);
        if (sweep.names[i] != sweep.x && varies && follows[i] == 0)
            varying.push_back(i);
    }
    constexpr std::size_t kMost = 2;
    if (varying.size() > kMost && g == 0)
        return "first set";
    std::copy_if(varying.begin(), varying.end(), std::back_inserter(named),
                 [&](std::size_t i) { return varying.size() <= kMost || value(g, i) != value(0, i); });
    std::string label;
    for (const std::size_t i : named)
        label += (label.empty() ? "" : ", ") + parameterLabel(sweep.names[i]) + " = " + shortNumber(value(g, i));
    std::string following; // named once, because these parameters vary along with the abscissa
    for (std::size_t i = 0; i < sweep.names.size(); ++i)
        if (g == 0 && follows[i] != 0)
            following += (following.empty() ? "" : ", ") + pages::keyLabel(sweep.names[i]);
    if (!following.empty())
        following += " along with " + parameterLabel(sweep.x);
    return label + (label.empty() || following.empty() ? "" : ", ") + following;
}

} // namespace

std::vector<SweepGroup> groupsOf(const sweep::SweepDefinition& sweep) {
    std::vector<SweepGroup> groups;
    std::vector<std::vector<double>> others; // values of all but the abscissa and what follows it, of each group
    std::vector<char> follows;
    for (std::size_t i = 0; i < sweep.names.size(); ++i)
        follows.push_back(followsAbscissa(sweep, i) ? 1 : 0);
    for (std::size_t set = 0; set < sweep.sets.size(); ++set) {
        std::vector<double> values;
        double x = 0.0;
        for (std::size_t i = 0; i < sweep.names.size(); ++i)
            if (sweep.names[i] == sweep.x)
                x = sweep.sets[set][i];
            else if (follows[i] == 0)
                values.push_back(sweep.sets[set][i]);
        const auto at = static_cast<std::size_t>(std::find(others.begin(), others.end(), values) - others.begin());
        if (at == groups.size()) {
            groups.push_back({"", kColours[groups.size() % kColours.size()], {}, {}});
            others.push_back(values);
        }
        groups[at].x.push_back(x);
        groups[at].sets.push_back(set);
    }
    for (std::size_t g = 0; g < groups.size(); ++g)
        groups[g].label = labelOf(sweep, follows, groups, g);
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

} // namespace supercircle::pages
