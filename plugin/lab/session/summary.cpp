// The summary of a run (keys: docs/reference/program.md), its events and its key frames.

#include "plugin/lab/session/force_curve.h"
#include "plugin/lab/session/session.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace supercircle::lab {

namespace {

/// Travel (m) over which a reported force is averaged: that of 5 ms, as for a load cell with a bandwidth of about 100
/// Hz. It is at least R / 1000, which suffices for slow tests. It is at most R / 50: more would smear a fast test.
double averagingWindow(std::span<const double> time, std::span<const double> displacement, double R) {
    const double duration = time.back() - time.front();
    const double speed = duration > 0.0 ? std::abs(displacement.back() - displacement.front()) / duration : 0.0;
    return std::clamp(5e-3 * speed, 1e-3 * R, 2e-2 * R);
}

/// Relative error of inextensibility: arc length of each element, from its chord and turning angle, against its length.
double lengthError(const step::World& w) {
    double worst = 0.0;
    for (const step::Rod& r : w.rods)
        for (int i = 0; i < r.model.elements(); ++i) {
            const rod::Arc& a = r.kin.arcs()[static_cast<std::size_t>(i)];
            const double chord = (r.kin.node(i + 1) - r.kin.node(i)).norm();
            const double half = 0.5 * a.curvature * a.length;
            const double length = chord / math::sinc(half);
            worst = std::max(worst, std::abs(length / r.model.elementLength(i) - 1.0));
        }
    return worst;
}

struct SegmentCurve {
    std::vector<double> displacement, force;
};

/// Rows of a segment, and the row before them.
SegmentCurve curveOf(const record::Series& s, std::pair<std::size_t, std::size_t> rows) {
    const auto& d = s.columns[1];
    const auto& f = s.columns[2];
    const std::size_t first = rows.first > 0 ? rows.first - 1 : 0;
    const auto from = static_cast<std::ptrdiff_t>(first), to = static_cast<std::ptrdiff_t>(rows.second);
    return {{d.begin() + from, d.begin() + to}, {f.begin() + from, f.begin() + to}};
}

/// Displacement at the end of a segment; where it ended by a force, that of the force bound between two samples.
double endOf(const SegmentCurve& c, double bound) {
    const std::size_t n = c.force.size();
    if (n > 1 && std::isfinite(bound) && c.force[n - 1] > bound && c.force[n - 2] < bound)
        return c.displacement[n - 2] + (c.displacement[n - 1] - c.displacement[n - 2]) * (bound - c.force[n - 2]) /
                                           (c.force[n - 1] - c.force[n - 2]);
    return c.displacement.back();
}

std::int64_t whole(std::uint64_t count) {
    return static_cast<std::int64_t>(count);
}

} // namespace

void Session::summariseCounters() {
    const step::Counters& c = shells_.world().counters;
    const Spent spent = this->spent();
    out_.timing.emplace_back("wall_s", spent.wall);
    out_.timing.emplace_back("cpu_s", spent.cpu);
    if (cpuAtProtocol_ >= 0.0) {
        out_.timing.emplace_back("protocol_cpu_s", spent.protocolCpu);
        put("protocol_steps", whole(c.steps - countersAtProtocol_.steps));
        put("protocol_solves", whole(c.solves - countersAtProtocol_.solves));
        put("protocol_pivots", whole(c.pivots - countersAtProtocol_.pivots));
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(step::Stage::Count); ++i)
        out_.timing.emplace_back(std::string("stage_") + step::name(static_cast<step::Stage>(i)) + "_s",
                                 spent.stages[i]);
    put("contacts_max", whole(c.contactsMax));
    put("active_contacts_max", whole(c.activeContactsMax));
    put("steps", whole(c.steps));
    put("threads", static_cast<std::int64_t>(options_.threads));
}

/// Cycle numbers and snap-fits of one segment.
void Session::summariseSegment(std::size_t index, double R, double forceUnit) {
    const scene::ProtocolSegment& segment = scene_.protocol->segments[static_cast<std::size_t>(segmentIndex_[index])];
    const SegmentCurve curve = curveOf(out_.series, segmentRows_[index]);
    if (curve.force.empty() || segment.cycle <= 0)
        return;
    while (static_cast<int>(out_.cycles.size()) < segment.cycle)
        out_.cycles.emplace_back();
    record::Cycle& c = out_.cycles[static_cast<std::size_t>(segment.cycle) - 1];
    c.dissipated_J += workOf(curve.displacement, curve.force);
    if (!segment.loading)
        return;
    c.delta_max_over_R = endOf(curve, segment.stop_when.force) / R;
    const std::vector<ForceDrop> drops =
        mergeDrops(curve.displacement, curve.force,
                   forceDrops(curve.displacement, curve.force, 0.1 * forceUnit, 0.25 * R), 0.05 * R);
    for (const ForceDrop& d : drops) {
        ++c.snap_fits;
        largestForceDrop_ = std::max(largestForceDrop_, d.size);
        const std::size_t first = segmentRows_[index].first;
        const std::size_t at = (first > 0 ? first - 1 : 0) + d.top;
        out_.events.push_back({out_.series.columns[0][at], out_.series.columns[1][at], out_.series.columns[2][at],
                               "snap_fit", "force drops by " + std::to_string(d.size) + " N"});
    }
}

void Session::summariseForces() {
    const double R = out_.R, B = out_.B;
    const double unit = B > 0.0 ? B / (R * R) : 1.0;
    const bool stack = scene_.report.kind == "stack";
    const auto& force = out_.series.columns[2];
    double peak = 0.0, pullOff = 0.0;
    auto peakRow = static_cast<std::size_t>(std::max_element(force.begin(), force.end()) - force.begin());
    const double unfiltered = force.empty() ? 0.0 : force[peakRow];
    if (stack)
        peak = std::max(0.0, unfiltered);
    for (const auto& [from, to] : segmentRows_)
        if (!stack && to > from) {
            const auto part = [&, from = from, to = to](std::size_t column) {
                return std::span<const double>(out_.series.columns[column]).subspan(from, to - from);
            };
            const ForceExtremes e = averagedExtremes(part(0), part(1), part(2), averagingWindow(part(0), part(1), R));
            if (e.peak > peak)
                peakRow = from + (e.from + e.to) / 2;
            peak = std::max(peak, e.peak);
            pullOff = std::min(pullOff, e.pullOff);
        }
    for (std::size_t i = 0; i < segmentRows_.size(); ++i)
        summariseSegment(i, R, unit);
    std::int64_t snapFits = 0;
    for (std::size_t i = 0; i < out_.cycles.size(); ++i) {
        record::Cycle& c = out_.cycles[i];
        double top = 0.0;
        for (std::size_t k = 0; k < segmentRows_.size(); ++k)
            if (scene_.protocol->segments[static_cast<std::size_t>(segmentIndex_[k])].cycle == static_cast<int>(i) + 1)
                for (double f : curveOf(out_.series, segmentRows_[k]).force)
                    top = std::max(top, f);
        c.dissipation_ratio =
            top > 0.0 && c.delta_max_over_R > 0.0 ? c.dissipated_J / (top * c.delta_max_over_R * R) : 0.0;
        snapFits += c.snap_fits;
    }
    if (stack) {
        put("H0_over_R", pileHeight_ / R);
        put("delta_max_over_R", out_.cycles.empty() ? 0.0 : out_.cycles.front().delta_max_over_R);
        put("dissipation_ratio", out_.cycles.empty() ? 0.0 : out_.cycles.front().dissipation_ratio);
        put("snap_fits", snapFits);
        put("max_force_drop_R2_over_B", largestForceDrop_ / unit); // no sign of an abrupt snap (decision 0062)
    }
    put("peak_force_N", peak);
    put("peak_force_R2_over_B", peak / unit);
    put("pull_off_force_R2_over_B", pullOff / unit);
    put("peak_force_unfiltered_N", unfiltered); // largest of any step: rings after a snap
    if ((scene_.report.kind == "snap" || stack) && B > 0.0)
        put("max_energy_release_R_over_B", energyRelease_.largest() * R / B); // of one shell, while it is loaded
    if (scene_.report.kind == "snap")
        put("snap_type", std::string(peak > 1.5 * unit ? "II" : pullOff < 0.0 || peak > 0.0 ? "I" : "none"));
    if (force.empty())
        return;
    const double time = out_.series.columns[0][peakRow];
    out_.events.push_back(
        {time, out_.series.columns[1][peakRow], peak > 0.0 ? peak : unfiltered, "peak", "largest force"});
    if (!stack) // which is squeezed up to its largest force
        for (std::size_t i = 0; i < out_.frames.size() && out_.frames[i].time <= time; ++i)
            out_.keyFrames[1] = static_cast<std::int32_t>(i);
}

void Session::summariseEnergy() {
    const step::EnergyBalance& l = shells_.world().energyBalance;
    const step::EnergyBalance& s = energyAtStart_;
    const double friction = l.friction - s.friction;
    const double work = l.work - s.work, residual = l.residual() - s.residual();
    out_.energy = {{"work_in_J", work},
                   {"elastic_J", l.bending - s.bending},
                   {"gravity_J", l.gravity - s.gravity},
                   {"kinetic_J", l.kinetic - s.kinetic},
                   {"friction_J", friction},
                   {"impact_J", l.impact - s.impact},
                   {"effects_J", l.effects - s.effects},
                   {"numerical_dissipation_J", l.numerical - s.numerical},
                   {"position_correction_J", l.positionCorrection - s.positionCorrection},
                   {"to_bodies_J", l.toBodies - s.toBodies},
                   {"residual_J", residual}};
    if (l.damping > s.damping)
        out_.energy.emplace_back("damping_J", l.damping - s.damping);
    if (unitDamping_ > 0.0)
        put("numerical_damping_ratio", std::max(0.0, l.numerical - s.numerical) / unitDamping_);
    double plateWork = 0.0; // done on the specimen while it resists, without what it returns
    if (scene_.protocol)
        for (std::size_t i = 1; i < out_.series.rows(); ++i)
            plateWork += std::max(0.0, out_.series.columns[3][i] - out_.series.columns[3][i - 1]);
    put("plate_work_J", plateWork);
    put("energy_residual_relative",
        residual / std::max({std::abs(work), plateWork, std::abs(l.stored() - s.stored()), 1e-12}));
    put("numerical_over_friction", friction > 0.0 ? (l.numerical - s.numerical) / friction : 0.0);
    put("position_correction_over_friction",
        friction > 0.0 ? (l.positionCorrection - s.positionCorrection) / friction : 0.0);
}

void Session::summarise() {
    const step::World& w = shells_.world();
    put("scene", out_.scene);
    put("seed", static_cast<std::int64_t>(options_.seed));
    put("status", std::string(status_ == RunStatus::Done          ? "done"
                              : status_ == RunStatus::Interrupted ? "interrupted"
                                                                  : "failed"));
    if (!message_.empty())
        put("message", message_);
    put("simulated_s", w.time);
    if (accuracy_ != scene::Accuracy::Exact)
        put("accuracy", scene::kAccuracies[static_cast<std::size_t>(accuracy_)]);
    summariseCounters();
    if (scene_.protocol)
        summariseForces();
    if (scene_.report.kind == "cantilever" && !w.rods.empty()) {
        const step::Rod& r = w.rods.front();
        const double L = r.model.definition().length;
        const rod::Vec2 tip = r.kin.node(r.model.elements()) - r.kin.node(0);
        put("tip_x_over_L", tip.x() / L);
        put("tip_y_over_L", tip.y() / L);
    }
    if (creepStart_ >= 0.0 && w.time > creepStart_) {
        double farthest = 0.0;
        std::size_t k = 0;
        for (const step::Rod& r : w.rods)
            for (int i = 0; i <= r.model.elements() && k < creepFrom_.size(); ++i)
                farthest = std::max(farthest, (r.kin.node(i) - creepFrom_[k++]).norm());
        put("creep_speed_m_s", farthest / (w.time - creepStart_));
    }
    summariseEnergy();
    double thickness = 1e300;
    for (const step::Rod& r : w.rods)
        thickness = std::min(thickness, r.model.definition().thickness);
    put("penetration_max_over_h", w.rods.empty() ? 0.0 : w.counters.penetrationMax / thickness);
    put("crossings", whole(w.counters.crossings));
    put("length_error_max", lengthError(w));
    put("contact_residual_max", w.counters.contactResidualMax);
    put("unconverged_steps", whole(w.counters.unconverged));
    put("absolute_floor_steps", whole(w.counters.byAbsoluteFloor));
    put("rejected_steps", whole(w.counters.rejected));
    for (std::size_t i = 1; i < w.counters.rejectedFor.size(); ++i)
        put(std::string("rejected_") + step::name(static_cast<step::Reason>(i)), whole(w.counters.rejectedFor[i]));
    put("contact_solves", whole(w.counters.solves));
    put("gauss_seidel_iterations", whole(w.counters.gaussSeidelIterations));
    put("pivots", whole(w.counters.pivots));
}

record::Recording Session::finish(RunStatus status, const std::string& message) {
    status_ = status;
    message_ = message;
    summarise();
    out_.keyFrames[2] = static_cast<std::int32_t>(out_.frames.size()) - 1;
    if (out_.keyFrames[1] < 0 && !out_.frames.empty()) {
        std::size_t best = 0;
        for (std::size_t i = 0; i < out_.frames.size(); ++i)
            if (out_.frames[i].force > out_.frames[best].force)
                best = i;
        out_.keyFrames[1] = static_cast<std::int32_t>(best);
    }
    std::stable_sort(out_.events.begin(), out_.events.end(),
                     [](const record::Event& a, const record::Event& b) { return a.time < b.time; });
    return std::move(out_);
}

} // namespace supercircle::lab
