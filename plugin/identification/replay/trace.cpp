#include "plugin/identification/replay/trace.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

using Forces = std::vector<Reading>;

bool doubtful(const Reading& r) {
    return r.kind == Kind::Doubtful;
}

/// Through the first two of [from, end) that are not doubtful; none where they are not both steady.
template <class Iterator>
std::optional<Line> tangent(Iterator from, Iterator end) {
    const Iterator near = std::find_if_not(from, end, doubtful);
    const Iterator far = near == end ? end : std::find_if_not(near + 1, end, doubtful);
    if (far == end || near->kind != Kind::Steady || far->kind != Kind::Steady || near->time == far->time)
        return {};
    return Line{near->time, near->force, (far->force - near->force) / (far->time - near->time)};
}

/// What stands between two tangents instead of doubtful forces [from, to): those where nothing better is known.
Forces between(const std::optional<Line>& before, const std::optional<Line>& behind, Forces::const_iterator from,
               Forces::const_iterator to) {
    constexpr double kSoon = 4.0;  // longest steps among them: later ones are no help
    constexpr double kSame = 1e-4; // of the force: one line
    double all = 0.0, longest = 0.0;
    std::for_each(from, to, [&](const Reading& r) {
        all += r.way;
        longest = std::max(longest, r.way);
    });
    if (!before || !behind || all > kSoon * longest)
        return {from, to};
    const double gap = behind->time - before->time, same = kSame * std::abs(behind->force);
    const double atFront = before->force - behind->at(before->time), atBack = behind->force - before->at(behind->time);
    const double most = std::max(std::abs(atFront), std::abs(atBack));
    if (atFront * atBack > 0.0 && most > same) {
        const double corner = before->time + gap * atFront / (atFront + atBack);
        return {{corner, before->at(corner), Kind::Other, 0.0}};
    }
    const Line chord{before->time, before->force, (behind->force - before->force) / gap};
    double doubt = same; // how far they are off it
    std::for_each(from, to, [&](const Reading& r) { doubt = std::max(doubt, std::abs(r.force - chord.at(r.time))); });
    return most > doubt ? Forces(from, to) : Forces();
}

} // namespace

std::optional<Line> endTangent(std::vector<Reading>& forces) {
    const auto line = tangent(forces.rbegin(), forces.rend());
    while (line && doubtful(forces.back()))
        forces.pop_back();
    return line;
}

std::vector<Reading> mended(const std::vector<Reading>& forces) {
    Forces out;
    out.reserve(forces.size());
    for (auto from = forces.begin(); from != forces.end();) {
        if (!doubtful(*from)) {
            out.push_back(*from++);
            continue;
        }
        const auto to = std::find_if_not(from, forces.end(), doubtful);
        const Forces better = between(tangent(out.rbegin(), out.rend()), tangent(to, forces.end()), from, to);
        out.insert(out.end(), better.begin(), better.end());
        from = to;
    }
    return out;
}

} // namespace supercircle::replay
