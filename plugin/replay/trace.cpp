#include "plugin/replay/trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace supercircle::replay {

void Trace::addForce(double at, double value, Step kind, double headWay) {
    forceTime.push_back(at);
    force.push_back(value);
    step.push_back(kind);
    way.push_back(std::abs(headWay));
}

std::optional<Trace::Line> Trace::endTangent() {
    const auto tangent = tangentAt(step.size(), false);
    if (tangent)
        while (step.back() == Step::Doubtful)
            erase(step.size() - 1, step.size());
    return tangent;
}

void Trace::mend() {
    const auto doubtful = [&](std::size_t i) { return i < step.size() && step[i] == Step::Doubtful; };
    for (std::size_t from = 0; from < step.size(); ++from) {
        std::size_t to = from;
        while (doubtful(to))
            ++to;
        if (to > from)
            mend(from, to);
        while (doubtful(from)) // those that stay
            ++from;
    }
}

/// Through the last two forces before `i`, or (ahead) the first two from it on, doubtful ones passed over; none where
/// they are not both steady.
std::optional<Trace::Line> Trace::tangentAt(std::size_t i, bool ahead) const {
    std::array<std::size_t, 2> two{};
    std::size_t found = 0;
    while (found < 2 && (ahead ? i < step.size() : i > 0)) {
        const std::size_t k = ahead ? i++ : --i;
        if (step[k] != Step::Doubtful)
            two[found++] = k;
    }
    const auto [near, far] = two;
    if (found < 2 || step[near] != Step::Steady || step[far] != Step::Steady || forceTime[near] == forceTime[far])
        return {};
    return Line{forceTime[near], force[near], (force[far] - force[near]) / (forceTime[far] - forceTime[near])};
}

/// Of a run of doubtful forces [from, to).
void Trace::mend(std::size_t from, std::size_t to) {
    constexpr double kSoon = 4.0;  // longest steps among them: later ones are no help
    constexpr double kSame = 1e-4; // of the force: one line
    const auto before = tangentAt(from, false), behind = tangentAt(to, true);
    const auto first = way.begin() + static_cast<std::ptrdiff_t>(from),
               last = way.begin() + static_cast<std::ptrdiff_t>(to);
    if (!before || !behind || std::accumulate(first, last, 0.0) > kSoon * *std::max_element(first, last))
        return;
    const double gap = behind->time - before->time, same = kSame * std::abs(behind->force);
    const double atFront = before->force - behind->at(before->time), atBack = behind->force - before->at(behind->time);
    const double most = std::max(std::abs(atFront), std::abs(atBack));
    const bool corner = atFront * atBack > 0.0 && most > same;
    const double slope = (behind->force - before->force) / gap;
    double doubt = same; // how far they are off the chord
    for (std::size_t i = from; i < to; ++i)
        doubt = std::max(doubt, std::abs(force[i] - before->force - slope * (forceTime[i] - before->time)));
    if (!corner && most > doubt)
        return;
    if (corner) {
        forceTime[from] = before->time + gap * atFront / (atFront + atBack);
        force[from] = before->at(forceTime[from]);
        step[from++] = Step::Other;
    }
    erase(from, to);
}

void Trace::erase(std::size_t from, std::size_t to) {
    const auto cut = [&](auto& v) {
        v.erase(v.begin() + static_cast<std::ptrdiff_t>(from), v.begin() + static_cast<std::ptrdiff_t>(to));
    };
    cut(forceTime);
    cut(force);
    cut(step);
    cut(way);
}

} // namespace supercircle::replay
