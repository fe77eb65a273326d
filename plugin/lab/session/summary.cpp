// The flat summary of a run (interface: README, docs/scenes.md), its events and its key frames.

#include "plugin/lab/session/curve.h"
#include "plugin/lab/session/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

namespace supercircle::lab {

namespace {

/// Travel (m) over which a reported force is averaged: that of 5 ms, as for a load cell with a bandwidth of some 100
/// Hz, but at least R / 1000 (slow machines need no more) and at most R / 50 (fast ones would smear the curve).
double averagingWindow(std::span<const double> time, std::span<const double> displacement, double R) {
    const double duration = time.back() - time.front();
    const double speed = duration > 0.0 ? std::abs(displacement.back() - displacement.front()) / duration : 0.0;
    return std::clamp(5e-3 * speed, 1e-3 * R, 2e-2 * R);
}

/// Inextensibility, measured and not assumed: arc length of each element from its chord and turning angle against l.
double lengthError(const step::World& w) {
    double worst = 0.0;
    for (const step::Rod& r : w.rods)
        for (int i = 0; i < r.model.elements(); ++i) {
            const rod::Arc& a = r.kin.arcs()[static_cast<std::size_t>(i)];
            const double chord = (r.kin.node(i + 1) - r.kin.node(i)).norm();
            const double half = 0.5 * a.curvature * a.length;
            const double length = chord / rod::sinc(half);
            worst = std::max(worst, std::abs(length / r.model.elementLength(i) - 1.0));
        }
    return worst;
}

struct Leg {
    std::vector<double> displacement, force;
};

Leg legOf(const record::Series& s, std::pair<std::size_t, std::size_t> rows) {
    const auto& d = s.columns[1];
    const auto& f = s.columns[2];
    const std::size_t first = rows.first > 0 ? rows.first - 1 : 0;
    const auto from = static_cast<std::ptrdiff_t>(first), to = static_cast<std::ptrdiff_t>(rows.second);
    return {{d.begin() + from, d.begin() + to}, {f.begin() + from, f.begin() + to}};
}

} // namespace

void Session::summarise(record::Recording& out) {
    const step::World& w = shells_.world();
    const double R = out.R, B = out.B;
    const double unit = B > 0.0 ? B / (R * R) : 1.0;
    const auto put = [&](const std::string& key, record::Value v) { out.summary.emplace_back(key, std::move(v)); };
    put("scene", out.scene);
    put("seed", static_cast<std::int64_t>(options_.seed));
    put("status", std::string(end_ == End::Done ? "done" : end_ == End::Interrupted ? "interrupted" : "failed"));
    if (!message_.empty())
        put("message", message_);
    put("simulated_s", w.time);
    put("wall_s",
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count() - wallStart_);
    const double cpu = cpuClock();
    put("cpu_s", cpu - cpuStart_);
    if (cpuProtocol_ >= 0.0) {
        put("protocol_cpu_s", cpu - cpuProtocol_);
        put("protocol_steps", static_cast<std::int64_t>(w.counters.steps - countProtocol_.steps));
        put("protocol_solves", static_cast<std::int64_t>(w.counters.solves - countProtocol_.solves));
        put("protocol_pivots", static_cast<std::int64_t>(w.counters.pivots - countProtocol_.pivots));
    }
    put("contacts_max", static_cast<std::int64_t>(w.counters.contactsMax));
    put("loaded_contacts_max", static_cast<std::int64_t>(w.counters.loadedMax));
    put("steps", static_cast<std::int64_t>(w.counters.steps));
    put("threads", static_cast<std::int64_t>(options_.threads));
    double friction = 0.0;
    if (scene_.protocol) {
        const auto& force = out.series.columns[2];
        const auto& travelled = out.series.columns[1];
        int snaps = 0;
        double drop = 0.0;
        double deltaMax = 0.0, area = 0.0, peak = 0.0, pull = 0.0;
        auto peakRow = static_cast<std::size_t>(std::max_element(force.begin(), force.end()) - force.begin());
        const double instant = force.empty() ? 0.0 : force[peakRow];
        if (scene_.report.kind == "stack")
            peak = std::max(0.0, instant);
        for (const auto& [from, to] : legs_)
            if (scene_.report.kind != "stack" && to > from) {
                const auto part = [&](std::size_t column) {
                    return std::span<const double>(out.series.columns[column]).subspan(from, to - from);
                };
                const Extremes e = averagedExtremes(part(0), part(1), part(2), averagingWindow(part(0), part(1), R));
                if (e.peak > peak)
                    peakRow = from + (e.from + e.to) / 2;
                peak = std::max(peak, e.peak);
                pull = std::min(pull, e.pull);
            }
        for (std::size_t i = 0; i < legs_.size(); ++i) {
            const scene::Move& move = scene_.protocol->moves[static_cast<std::size_t>(legMove_[i])];
            const Leg leg = legOf(out.series, legs_[i]);
            if (leg.force.empty() || move.cycle <= 0)
                continue;
            while (static_cast<int>(out.cycles.size()) < move.cycle)
                out.cycles.emplace_back();
            record::Cycle& c = out.cycles[static_cast<std::size_t>(move.cycle) - 1];
            c.dissipated_J += workOf(leg.displacement, leg.force);
            if (!move.loading)
                continue;
            double delta = leg.displacement.back(); // where the force reached its bound, between two samples
            const std::size_t n = leg.force.size();
            if (n > 1 && std::isfinite(move.until.force) && leg.force[n - 1] > move.until.force &&
                leg.force[n - 2] < move.until.force)
                delta = leg.displacement[n - 2] + (leg.displacement[n - 1] - leg.displacement[n - 2]) *
                                                      (move.until.force - leg.force[n - 2]) /
                                                      (leg.force[n - 1] - leg.force[n - 2]);
            c.delta_max_over_R = delta / R;
            for (const ForceDrop& d :
                 mergeDrops(leg.displacement, leg.force, forceDrops(leg.displacement, leg.force, 0.1 * unit, 0.25 * R),
                            0.05 * R)) {
                ++c.snap_fits;
                drop = std::max(drop, d.size);
                const std::size_t at = (legs_[i].first > 0 ? legs_[i].first - 1 : 0) + d.top;
                out.events.push_back({out.series.columns[0][at], travelled[at], force[at], "snap_fit",
                                      "force drops by " + std::to_string(d.size) + " N"});
            }
            snaps += c.snap_fits;
        }
        for (std::size_t i = 0; i < out.cycles.size(); ++i) {
            record::Cycle& c = out.cycles[i];
            double top = 0.0;
            for (std::size_t k = 0; k < legs_.size(); ++k)
                if (scene_.protocol->moves[static_cast<std::size_t>(legMove_[k])].cycle == static_cast<int>(i) + 1)
                    for (double f : legOf(out.series, legs_[k]).force)
                        top = std::max(top, f);
            c.eta = top > 0.0 && c.delta_max_over_R > 0.0 ? c.dissipated_J / (top * c.delta_max_over_R * R) : 0.0;
        }
        if (!out.cycles.empty()) {
            deltaMax = out.cycles.front().delta_max_over_R;
            area = out.cycles.front().eta;
        }
        if (scene_.report.kind == "stack") {
            put("H0_over_R", pileHeight_ / R);
            put("delta_max_over_R", deltaMax);
            put("eta", area);
            put("snap_fits", static_cast<std::int64_t>(snaps));
            put("largest_drop_R2_over_B", drop / unit); // no sign of an abrupt snap: see release.h
        }
        put("peak_force_N", peak);
        put("peak_force_R2_over_B", peak / unit);
        put("pull_force_R2_over_B", pull / unit);
        put("instant_force_N", instant); // largest of any step: rings after a snap
        if ((scene_.report.kind == "snap" || scene_.report.kind == "stack") && B > 0.0)
            put("largest_release_R_over_B", release_.largest() * R / B); // of one shell, while it is loaded
        if (scene_.report.kind == "snap")
            put("snap_type", std::string(peak > 1.5 * unit ? "II" : pull < 0.0 || peak > 0.0 ? "I" : "none"));
        if (!force.empty()) {
            const double when = out.series.columns[0][peakRow];
            out.events.push_back({when, travelled[peakRow], peak > 0.0 ? peak : instant, "peak", "largest force"});
            if (scene_.report.kind != "stack") // which is squeezed up to its largest force
                for (std::size_t i = 0; i < out.frames.size() && out.frames[i].time <= when; ++i)
                    out.keyFrames[1] = static_cast<std::int32_t>(i);
        }
    }
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
    const step::Ledger& l = w.ledger;
    const step::Ledger& s = atStart_;
    friction = l.friction - s.friction;
    const double work = l.work - s.work, residual = l.residual() - s.residual();
    out.energy = {{"work_in_J", work},
                  {"elastic_J", l.bending - s.bending},
                  {"gravity_J", l.gravity - s.gravity},
                  {"kinetic_J", l.kinetic - s.kinetic},
                  {"friction_J", friction},
                  {"impact_J", l.impact - s.impact},
                  {"effects_J", l.effects - s.effects},
                  {"numerical_J", l.numerical - s.numerical},
                  {"push_out_J", l.pushOut - s.pushOut},
                  {"to_bodies_J", l.toBodies - s.toBodies},
                  {"residual_J", residual}};
    double gross = 0.0; // the work done on the specimen while it resists, without what it gives back
    if (scene_.protocol)
        for (std::size_t i = 1; i < out.series.rows(); ++i)
            gross += std::max(0.0, out.series.columns[3][i] - out.series.columns[3][i - 1]);
    put("plate_work_J", gross);
    put("energy_residual_relative",
        residual / std::max({std::abs(work), gross, std::abs(l.stored() - s.stored()), 1e-12}));
    put("numerical_over_friction", friction > 0.0 ? (l.numerical - s.numerical) / friction : 0.0);
    put("push_out_over_friction", friction > 0.0 ? (l.pushOut - s.pushOut) / friction : 0.0);
    double thickness = 1e300;
    for (const step::Rod& r : w.rods)
        thickness = std::min(thickness, r.model.definition().thickness);
    put("penetration_max_over_h", w.rods.empty() ? 0.0 : w.counters.penetrationMax / thickness);
    put("crossings", static_cast<std::int64_t>(w.counters.crossings));
    put("length_error_max", lengthError(w));
    put("contact_residual_max", w.counters.etaMax);
    put("unconverged_steps", static_cast<std::int64_t>(w.counters.unconverged));
    put("rejected_steps", static_cast<std::int64_t>(w.counters.rejected));
    for (std::size_t i = 1; i < w.counters.rejectedFor.size(); ++i)
        put(std::string("rejected_") + step::name(static_cast<step::Reason>(i)),
            static_cast<std::int64_t>(w.counters.rejectedFor[i]));
    put("contact_solves", static_cast<std::int64_t>(w.counters.solves));
    put("sweeps", static_cast<std::int64_t>(w.counters.sweeps));
    put("pivots", static_cast<std::int64_t>(w.counters.pivots));
    for (std::size_t i = 0; i < static_cast<std::size_t>(step::Stage::Count); ++i)
        put(std::string("stage_") + step::name(static_cast<step::Stage>(i)) + "_s", shells_.stepper().times()[i]);
}

record::Recording Session::finish(End end, const std::string& message) {
    end_ = end;
    message_ = message;
    summarise(out_);
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

Outcome run(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const Options& options) {
    Outcome out;
    Session session(scene, std::move(host), options);
    if (std::string why = session.populate(); !why.empty()) {
        out.end = End::BadScene;
        out.message = why;
        return out;
    }
    if (scene.drop)
        session.drop();
    if (session.end() == End::Done)
        session.protocol();
    out.end = session.end();
    out.message = session.message();
    out.recording = session.finish(out.end, out.message);
    return out;
}

} // namespace supercircle::lab
