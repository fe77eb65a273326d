#include "supercircle/step/damping.h"

#include "supercircle/rod/modes.h"
#include "supercircle/step/rods/hold_rows.h"

#include <bit>

namespace supercircle::step {

namespace {

/// A number that changes with what the time depends on; never 0.
std::uint64_t signatureOf(const Rod& rod, double ratio) {
    std::uint64_t value = 0xcbf29ce484222325U;
    const auto add = [&](double x) { value = (value ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3U; };
    add(ratio);
    add(rod.model.definition().bendingModulus);
    add(rod.model.definition().linearMass);
    for (const rod::PointMass& p : rod.model.definition().pointMasses)
        for (const double x : {p.s, p.mass, p.inertia})
            add(x);
    for (const Hold& h : rod.holds)
        add(h.clamped ? h.s : -1.0 - h.s);
    return value | 1U;
}

/// The same rod in at most this many arcs: the first mode is right to 1 %, and a long rope takes no second.
struct Coarse {
    static constexpr int kMost = 24;
    rod::RodModel model;
    Eigen::VectorXd q;
    rod::Kinematics kin;
};

Coarse coarse(const Rod& rod) {
    const int n = rod.model.elements();
    if (n <= Coarse::kMost)
        return {rod.model, rod.q, rod.kin};
    rod::RodDefinition d = rod.model.definition();
    const int few = Coarse::kMost - n % 2; // with a middle element, or without one
    d.naturalCurvature.assign(static_cast<std::size_t>(few), 0.0);
    d.elementLength.clear();
    Coarse c{rod::RodModel(d), {}, {}};
    c.q.setZero(c.model.dofs());
    const auto angle = [&](double s) { return rod.kin.angle(rod::locate(rod.model, s)); };
    for (int i = 0; i < few; ++i)
        c.q[c.model.dofOfElement(i)] =
            (angle(c.model.nodeS(i + 1)) - angle(c.model.nodeS(i))) / c.model.elementLength(i);
    c.q.tail<3>() = rod.q.tail<3>();
    c.kin.evaluate(c.model, c.q);
    return c;
}

} // namespace

double firstFrequency(const Rod& rod) {
    const Coarse few = coarse(rod);
    Eigen::MatrixXd held;
    std::vector<Hold> rigid = rod.holds; // a clamp that yields counts as one that does not
    for (Hold& h : rigid)
        h.turnStiffness = 0.0;
    holdRows(few.model, rigid, few.kin, held);
    const Eigen::VectorXd frequencies = rod::circularFrequencies(few.model, few.q, held);
    return frequencies.size() > 0 ? frequencies[0] : 0.0;
}

void refreshDamping(World& world, const Settings& settings) {
    for (Rod& rod : world.rods) {
        const double ratio = rod.dampingRatio < 0.0 ? settings.dampingRatio : rod.dampingRatio;
        if (!(ratio > 0.0)) {
            rod.dampingTime = 0.0;
            rod.dampingOf = 0;
            continue;
        }
        const std::uint64_t now = signatureOf(rod, ratio);
        if (now == rod.dampingOf || rod.frozen())
            continue;
        rod.dampingOf = now;
        const double frequency = firstFrequency(rod);
        rod.dampingTime = frequency > 0.0 ? 2.0 * ratio / frequency : 0.0;
    }
}

} // namespace supercircle::step
