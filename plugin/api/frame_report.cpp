#include "plugin/api/frame_report.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

namespace supercircle {

namespace {

constexpr std::uint64_t kManyAttempts = 20; ///< made again, in a frame that is worth a line

template <class... Values>
std::string text(const char* format, Values... values) {
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

void add(std::string& line, const std::string& part) {
    line += (line.empty() ? "" : "; ") + part;
}

std::string attempts(const step::Counters& before, const step::Counters& after) {
    std::string out;
    for (std::size_t r = 0; r < after.rejectedFor.size(); ++r)
        if (const std::uint64_t count = after.rejectedFor[r] - before.rejectedFor[r]; count > 0)
            out += (out.empty() ? "steps made again: " : ", ") + std::string(step::name(static_cast<step::Reason>(r))) +
                   ' ' + std::to_string(count);
    return out;
}

/// The cause of most of it.
std::string injected(const step::InjectedEnergy& before, const step::InjectedEnergy& after) {
    const std::pair<const char*, double> causes[] = {{"overlaps", after.contact - before.contact},
                                                     {"joints", after.link - before.link},
                                                     {"holds", after.hold - before.hold},
                                                     {"bodies moved by the host", after.drift - before.drift},
                                                     {"turning forces", after.rolling - before.rolling}};
    const auto* most = std::max_element(std::begin(causes), std::end(causes),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    return text("injected %.3g J, most by %s", after.sum() - before.sum(), most->first);
}

} // namespace

void complete(FrameReport& report, const step::World& world, const step::Settings& settings, const FrameStart& start,
              double dt, const FrameEvents& events) {
    const step::Counters& now = world.counters;
    report.steps = now.steps - start.counters.steps;
    report.unconverged = now.unconverged - start.counters.unconverged;
    report.injected = world.energyBalance.injected.sum() - start.injected.sum();
    std::string& line = report.why;
    if (report.budget_exhausted)
        add(line,
            text("slowed to %.0f %%: %.0f of %.0f units of work in %llu steps", 100.0 * report.advanced / dt,
                 report.work, static_cast<double>(settings.frameWork), static_cast<unsigned long long>(report.steps)));
    const std::uint64_t again = now.rejected - start.counters.rejected;
    if (again > 0 && (report.budget_exhausted || again >= kManyAttempts))
        add(line, attempts(start.counters, now));
    if (report.unconverged > 0)
        add(line, text("unconverged steps %llu", static_cast<unsigned long long>(report.unconverged)));
    if (!events.crushed.empty())
        add(line, text("crushed %zu%s", events.crushed.size(),
                       settings.crush == step::CrushPolicy::Stop ? ", what presses stands" : ""));
    if (!events.broke.empty())
        add(line, text("broke %zu", events.broke.size()));
    if (!events.quarantined.empty())
        add(line, text("quarantined %zu", events.quarantined.size()));
    if (report.energy_gained > 0.0)
        add(line, text("energy alarm: %.3g J from nowhere", report.energy_gained));
    if (!line.empty() && report.injected > 0.0)
        add(line, injected(start.injected, world.energyBalance.injected));
}

} // namespace supercircle
