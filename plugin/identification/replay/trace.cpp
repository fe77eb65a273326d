#include "plugin/identification/replay/trace.h"

#include "supercircle/effects/sensor.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

using Forces = std::vector<ForceSample>;

bool isUncertain(const ForceSample& r) {
    return r.kind == MeanForceKind::Uncertain;
}

/// Tangent through the first two certain forces of [from, end); none if they are not both steady.
template <class Iterator>
std::optional<Tangent> tangent(Iterator from, Iterator end) {
    const Iterator near = std::find_if_not(from, end, isUncertain);
    const Iterator far = near == end ? end : std::find_if_not(near + 1, end, isUncertain);
    if (far == end || near->kind != MeanForceKind::Steady || far->kind != MeanForceKind::Steady ||
        near->time == far->time)
        return {};
    return Tangent{near->time, near->force, (far->force - near->force) / (far->time - near->time)};
}

/// Replacement of uncertain forces [from, to) between two tangents; those themselves where nothing better is known.
Forces between(const std::optional<Tangent>& before, const std::optional<Tangent>& behind, Forces::const_iterator from,
               Forces::const_iterator to) {
    constexpr double kSoon = 4.0;  // longest steps among them; later forces do not help
    constexpr double kSame = 1e-4; // of the force: tangents coincide
    double all = 0.0, longest = 0.0;
    std::for_each(from, to, [&](const ForceSample& r) {
        all += r.travel;
        longest = std::max(longest, r.travel);
    });
    if (!before || !behind || all > kSoon * longest)
        return {from, to};
    const double gap = behind->time - before->time, same = kSame * std::abs(behind->force);
    const double atFront = before->force - behind->at(before->time), atBack = behind->force - before->at(behind->time);
    const double most = std::max(std::abs(atFront), std::abs(atBack));
    if (atFront * atBack > 0.0 && most > same) {
        const double corner = before->time + gap * atFront / (atFront + atBack);
        return {{corner, before->at(corner), MeanForceKind::Other, 0.0}};
    }
    const Tangent chord{before->time, before->force, (behind->force - before->force) / gap};
    double doubt = same; // their largest distance from it
    std::for_each(from, to,
                  [&](const ForceSample& r) { doubt = std::max(doubt, std::abs(r.force - chord.at(r.time))); });
    return most > doubt ? Forces(from, to) : Forces();
}

} // namespace

std::optional<Tangent> endTangent(std::vector<ForceSample>& forces) {
    const auto line = tangent(forces.rbegin(), forces.rend());
    while (line && isUncertain(forces.back()))
        forces.pop_back();
    return line;
}

std::vector<ForceSample> despiked(const std::vector<ForceSample>& forces) {
    Forces out;
    out.reserve(forces.size());
    for (auto from = forces.begin(); from != forces.end();) {
        if (!isUncertain(*from)) {
            out.push_back(*from++);
            continue;
        }
        const auto to = std::find_if_not(from, forces.end(), isUncertain);
        const Forces better = between(tangent(out.rbegin(), out.rend()), tangent(to, forces.end()), from, to);
        out.insert(out.end(), better.begin(), better.end());
        from = to;
    }
    return out;
}

void readBy(const effects::SensorModel& sensor, const std::vector<double>& times, double zero,
            std::vector<double>& rows) {
    effects::SensorChain chain(sensor);
    for (std::size_t i = 0; i < rows.size(); ++i)
        rows[i] = zero + (sensor.on() && std::isfinite(rows[i]) ? chain.read(times[i], rows[i]) : rows[i]);
}

} // namespace supercircle::replay
