#include "plugin/identification/replay/pulled_taut.h"

#include "plugin/api/from_definition.h"
#include "supercircle/effects/backlash.h"
#include "supercircle/rod/kinematics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using rod::Vec2;

/// Share of the length by which a strip that bends at all is shorter from end to end: it deflects by 2e-5 of its
/// length. A straight one has no direction to bend to, and 1e-5 of its length too much gives 1e5 N.
constexpr double kStraight = 1e-9;

/// Two neighbouring supports of a shell.
struct SupportPair {
    double from = 0.0, to = 0.0; ///< arc fractions
    double length = 0.0;         ///< m, of the strip between them
    Vec2 apart = Vec2::Zero();   ///< m, from one to the other at displacement 0
    Vec2 parting = Vec2::Zero(); ///< change of it per displacement, 1

    [[nodiscard]] double distance(double displacement) const { return (apart + displacement * parting).norm(); }
    [[nodiscard]] bool straight(double displacement) const {
        return distance(displacement) > (1.0 - kStraight) * length;
    }
};

std::vector<SupportPair> supportPairs(const scene::Scene& scene, const ShellDef& shell) {
    std::vector<const HoldDef*> holds;
    for (const HoldDef& h : scene.holds)
        if (h.shell == shell.name)
            holds.push_back(&h);
    const auto made = holds.size() < 2 ? Result<RodFromDefinition>::failure("") : fromDefinition(shell);
    if (!made)
        return {};
    std::sort(holds.begin(), holds.end(),
              [](const HoldDef* a, const HoldDef* b) { return a->arc_fraction < b->arc_fraction; });
    const rod::RodModel model(made->definition);
    rod::Kinematics kin;
    kin.evaluate(model, made->q);
    const Vec2 along = scene.protocol ? Vec2(scene.protocol->direction.x, scene.protocol->direction.y) : Vec2::Zero();
    const auto place = [&](const HoldDef& h) {
        return kin.point(rod::locate(model, h.arc_fraction * made->definition.length));
    };
    const auto speed = [&](const HoldDef& h) { return h.base == HoldBase::Moving ? along : Vec2::Zero().eval(); };
    std::vector<SupportPair> pairs;
    for (std::size_t i = 1; i < holds.size(); ++i) {
        const HoldDef &a = *holds[i - 1], &b = *holds[i];
        pairs.push_back({a.arc_fraction, b.arc_fraction, (b.arc_fraction - a.arc_fraction) * made->definition.length,
                         place(b) - place(a), speed(b) - speed(a)});
    }
    return pairs;
}

std::string shortText(const char* format, double a, double b = 0.0) {
    char text[160];
    std::snprintf(text, sizeof text, format, a, b);
    return text;
}

std::string between(const ShellDef& shell, const SupportPair& p) {
    return "the shell \"" + shell.name + "\" is held at arc fractions " + shortText("%.4g and %.4g", p.from, p.to) +
           " and is " + shortText("%.6g mm long between them", 1e3 * p.length);
}

/// The first moment at which the supports pull the strip straight, in words; empty: there is none. Their distance is
/// convex in the displacement, so it is largest at break points of the drive, or at displacement 0, where it starts.
std::string straightAt(const SupportPair& p, effects::DriveMotion drive) {
    drive.time.insert(drive.time.begin(), drive.time.front());
    drive.displacement.insert(drive.displacement.begin(), 0.0);
    const std::vector<double>& d = drive.displacement;
    for (std::size_t i = 0; i < d.size(); ++i) {
        if (!p.straight(d[i]))
            continue;
        double slack = i > 0 ? d[i - 1] : 0.0, taut = d[i];
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (slack + taut);
            (p.straight(middle) ? taut : slack) = middle;
        }
        const double share = i > 0 ? (taut - d[i - 1]) / (d[i] - d[i - 1]) : 0.0;
        const double time = i > 0 ? drive.time[i - 1] + share * (drive.time[i] - drive.time[i - 1]) : drive.time[i];
        const double most =
            *std::max_element(d.begin(), d.end(), [&](double a, double b) { return p.distance(a) < p.distance(b); });
        return shortText("at t = %.6g s, a displacement of %.6g mm", time, 1e3 * taut) +
               (p.distance(most) > (1.0 + kStraight) * p.length
                    ? shortText(", and part to %.9g mm", 1e3 * p.distance(most))
                    : "");
    }
    return {};
}

/// Whether something acts on the part between two supports or is read there: it is no clamp of a finite length.
bool concerns(const Experiment& e, const scene::Scene& scene, const ShellDef& shell, const SupportPair& p) {
    const auto inside = [&](const std::string& name, double fraction) {
        return name == shell.name && fraction > p.from && fraction < p.to;
    };
    const auto seen = [&](const scene::Observation& o) {
        return o.of == scene::Observation::Of::Shell && inside(o.target, o.arc_fraction);
    };
    return p.to - p.from > 0.5 || seen(e.scene->observation) ||
           std::any_of(e.scene->further.begin(), e.scene->further.end(),
                       [&](const experiment::FurtherChannel& c) { return seen(c.observation); }) ||
           std::any_of(e.markers.begin(), e.markers.end(),
                       [&](const experiment::Marker& m) { return inside(m.body, m.arcFraction); }) ||
           std::any_of(scene.loads.begin(), scene.loads.end(),
                       [&](const scene::PointLoad& l) { return inside(l.shell, l.arc_fraction); });
}

} // namespace

std::string pulledTaut(const Experiment& e, std::size_t index, const scene::Scene& scene,
                       const std::vector<effects::Setting>& settings) {
    if (scene.holds.size() < 2) // asked before each simulation
        return {};
    const experiment::Run& run = e.runs[index];
    effects::DriveMotion drive{{0.0}, {0.0}};
    if (scene.protocol && !experiment::drivesLoad(e))
        drive = effects::motionBehindBacklash({run.driveTime, run.driveDisplacement},
                                              effects::modelFor(settings, "all").apparatus.backlash);
    for (const ShellDef& shell : scene.shells)
        for (const SupportPair& p : supportPairs(scene, shell))
            if (const std::string when = straightAt(p, drive);
                !when.empty() && (p.parting != Vec2::Zero() || concerns(e, scene, shell, p)))
                return between(shell, p) + "; its supports are as far apart " + when +
                       ". Strips do not stretch here, so a straight one cannot bend and its force is undetermined. "
                       "Expected supports that stay closer than the strip is long, which a \"natural_curvature\" "
                       "brings about, a roller in place of one of them, or for what stretches a joint with a "
                       "\"spring\" between bodies";
    return {};
}

} // namespace supercircle::replay
