#include "supercircle/contact/detection/sub_arcs.h"

#include "supercircle/support/invariants.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace supercircle::contact {

namespace {

constexpr double kQuarter = 1.5707963267948966;

[[noreturn]] void fail(const RodCurve& curve, const std::string& what) {
    throw std::invalid_argument("contact detection: rod with key " + std::to_string(curve.key) + ": " + what);
}

void check(const RodCurve& curve) {
    if (curve.arcs.empty())
        fail(curve, "no arcs");
    if (curve.arcs.size() > 16000)
        fail(curve, "more than 16000 arcs");
    if (curve.nodeS.size() != curve.arcs.size() + 1)
        fail(curve, "nodeS needs one entry more than arcs");
    if (!(curve.halfThickness >= 0.0))
        fail(curve, "negative half thickness");
    if (!(curve.motion >= 0.0))
        fail(curve, "motion bound is negative or not a number");
    for (std::size_t i = 0; i < curve.arcs.size(); ++i) {
        const Arc& arc = curve.arcs[i];
        if (!(arc.length > 0.0))
            fail(curve, "arc " + std::to_string(i) + " has no positive length");
        if (!std::isfinite(arc.start.x() + arc.start.y() + arc.angle + arc.curvature + arc.length))
            fail(curve, "arc " + std::to_string(i) + " is not finite");
        if (std::abs(arc.curvature) * arc.length > 600.0)
            fail(curve, "arc " + std::to_string(i) + " turns by more than 600 rad");
    }
}

/// Start frame of a part of an arc.
void startOf(const Arc& arc, std::int32_t part, std::int32_t parts, Vec2& p, Vec2& t) {
    if (part == 0) {
        p = arc.start;
        t = arc.tangentAt(0.0);
        return;
    }
    const double s = arc.length * part / parts;
    p = arc.pointAt(s);
    t = arc.tangentAt(s);
}

/// Start of the sub-arc after (element, part): of the next part, of the next element, or the end of the rod. A closed
/// rod ends at its own last point, because the weld closes only to the caller's tolerance.
void endOf(const RodCurve& curve, std::int32_t element, std::int32_t part, std::int32_t parts, Vec2& p, Vec2& t) {
    const Arc& arc = curve.arcs[static_cast<std::size_t>(element)];
    if (part + 1 < parts)
        return startOf(arc, part + 1, parts, p, t);
    if (static_cast<std::size_t>(element) + 1 < curve.arcs.size()) {
        const Arc& next = curve.arcs[static_cast<std::size_t>(element) + 1];
        return startOf(next, 0, 1, p, t);
    }
    p = arc.pointAt(arc.length);
    t = arc.tangentAt(arc.length);
}

SubArc unfinishedSubArc(const RodCurve& curve, std::int32_t element, std::int32_t part, std::int32_t parts) {
    const Arc& arc = curve.arcs[static_cast<std::size_t>(element)];
    SubArc subArc;
    subArc.curvature = arc.curvature;
    subArc.length = arc.length / parts;
    subArc.s0 = curve.nodeS[static_cast<std::size_t>(element)] + arc.length * part / parts;
    subArc.span = arc.length;
    subArc.element = element;
    subArc.part = part;
    return subArc;
}

double nodeCurvature(const RodCurve& curve, std::int32_t node) {
    const auto n = static_cast<std::int32_t>(curve.arcs.size());
    const std::int32_t before = node > 0 ? node - 1 : (curve.closed ? n - 1 : 0);
    const std::int32_t after = node < n ? node : (curve.closed ? 0 : n - 1);
    return 0.5 * (curve.arcs[static_cast<std::size_t>(before)].curvature +
                  curve.arcs[static_cast<std::size_t>(after)].curvature);
}

/// The mid-rod point as a sample; false where it is a node already.
bool midSample(const RodCurve& curve, Sample& sample) {
    const double s = curve.midS;
    const std::size_t n = curve.arcs.size();
    if (!(s > curve.nodeS.front() && s < curve.nodeS.back()))
        return false;
    std::size_t e = 0;
    while (e + 1 < n && curve.nodeS[e + 1] <= s)
        ++e;
    const double tolerance = 1e-9 * curve.arcs[e].length;
    const double local = s - curve.nodeS[e];
    if (local < tolerance || curve.nodeS[e + 1] - s < tolerance)
        return false;
    sample.p = curve.arcs[e].pointAt(local);
    sample.t = curve.arcs[e].tangentAt(local);
    sample.s = s;
    sample.element = static_cast<std::int32_t>(e);
    sample.curvature = curve.arcs[e].curvature;
    sample.index = kMidSample;
    sample.tip = false;
    return true;
}

} // namespace

std::int32_t subArcCount(const Arc& arc) {
    const double quarters = std::abs(arc.curvature) * arc.length / kQuarter;
    return quarters <= 1.0 ? 1 : static_cast<std::int32_t>(std::ceil(quarters));
}

SubArc subArcOf(const RodCurve& curve, std::int32_t element, std::int32_t part) {
    SC_ASSERT_EXPENSIVE(invariants::inRange(element, curve.arcs.size()), "an element of the curve");
    const Arc& arc = curve.arcs[static_cast<std::size_t>(element)];
    const std::int32_t parts = subArcCount(arc);
    SC_ASSERT_EXPENSIVE(part >= 0 && part < parts, "a sub-arc of the element");
    SubArc subArc = unfinishedSubArc(curve, element, part, parts);
    startOf(arc, part, parts, subArc.p0, subArc.t0);
    endOf(curve, element, part, parts, subArc.p1, subArc.t1);
    return subArc;
}

void prepare(const RodCurve& curve, RodShape& shape) {
    check(curve);
    shape.subArcs.clear();
    shape.samples.clear();
    shape.turn.clear();
    shape.halfThickness = curve.halfThickness;
    shape.closed = curve.closed;
    shape.endS = curve.nodeS.back();
    shape.length = curve.nodeS.back() - curve.nodeS.front();
    const auto n = static_cast<std::int32_t>(curve.arcs.size());
    double turn = 0.0;
    for (std::int32_t e = 0; e < n; ++e) {
        const Arc& arc = curve.arcs[static_cast<std::size_t>(e)];
        const std::int32_t parts = subArcCount(arc);
        for (std::int32_t part = 0; part < parts; ++part) {
            SubArc subArc = unfinishedSubArc(curve, e, part, parts);
            startOf(arc, part, parts, subArc.p0, subArc.t0);
            if (!shape.subArcs.empty()) {
                shape.subArcs.back().p1 = subArc.p0;
                shape.subArcs.back().t1 = subArc.t0;
            }
            shape.subArcs.push_back(subArc);
            shape.turn.push_back(turn);
            turn += subArc.curvature * subArc.length;
            if (part == 0)
                shape.samples.push_back({subArc.p0, subArc.t0, curve.nodeS[static_cast<std::size_t>(e)], e,
                                         nodeCurvature(curve, e), e, e == 0 && !curve.closed});
        }
    }
    shape.turn.push_back(turn);
    SubArc& last = shape.subArcs.back();
    endOf(curve, n - 1, last.part, last.part + 1, last.p1, last.t1);
    if (!curve.closed)
        shape.samples.push_back({last.p1, last.t1, curve.nodeS.back(), n - 1, nodeCurvature(curve, n), n, true});
    Sample mid;
    shape.midS = -1.0;
    if (midSample(curve, mid)) {
        shape.midS = mid.s;
        shape.samples.push_back(mid);
    }
    SC_ASSERT(shape.turn.size() == shape.subArcs.size() + 1, "one angle at each end of a sub-arc");
    SC_ASSERT(shape.samples.size() >= static_cast<std::size_t>(n), "one sample a node at least");
    SC_ASSERT(shape.length > 0.0, "a rod has a length");
    SC_ASSERT_EXPENSIVE(invariants::forAll(shape.subArcs.size(),
                                           [&](std::size_t i) {
                                               const SubArc& arc = shape.subArcs[i];
                                               return invariants::isUnit(arc.t0) && invariants::isUnit(arc.t1) &&
                                                      arc.length > 0.0 &&
                                                      std::abs(arc.curvature) * arc.length <= kQuarter * (1.0 + 1e-12);
                                           }),
                        "a sub-arc has unit tangents and turns by a quarter at most");
}

Sample sampleAt(const RodCurve& curve, std::int32_t element, double s) {
    const auto n = static_cast<std::int32_t>(curve.arcs.size());
    const auto e = static_cast<std::size_t>(element);
    SC_ASSERT(element >= 0 && element < n, "an element of the curve");
    Sample sample;
    if (s == curve.nodeS[e] || s == curve.nodeS[e + 1]) {
        const bool end = s == curve.nodeS[e + 1];
        const std::int32_t node = end ? element + 1 : element;
        if (end)
            endOf(curve, element, 0, 1, sample.p, sample.t);
        else
            startOf(curve.arcs[e], 0, 1, sample.p, sample.t);
        sample.s = s;
        sample.element = node < n ? node : n - 1;
        sample.curvature = nodeCurvature(curve, node);
        sample.index = node;
        sample.tip = !curve.closed && (node == 0 || node == n);
        return sample;
    }
    if (s == curve.midS && midSample(curve, sample))
        return sample;
    const double local = s - curve.nodeS[e];
    return {curve.arcs[e].pointAt(local),
            curve.arcs[e].tangentAt(local),
            s,
            element,
            curve.arcs[e].curvature,
            kMidSample,
            false};
}

} // namespace supercircle::contact
