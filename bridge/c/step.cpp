#include "bridge/box2d/box2d_port.h"
#include "bridge/c/include/supercircle_box2d.h"
#include "bridge/c/json.h"
#include "bridge/c/world.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace supercircle::c {

namespace {

/// Box2D ends the process when a body's numbers overflow.
void requireFiniteBodies(const World& w) {
    for (const b2Body* b = w.box2d->GetBodyList(); b != nullptr; b = b->GetNext()) {
        const b2Vec2 v = b->GetLinearVelocity(), p = b->GetPosition();
        for (const float x : {v.x, v.y, b->GetAngularVelocity(), p.x, p.y})
            if (!(std::abs(x) < 1e15F))
                refuse(SC_FAILED, "body " + std::to_string(w.attachment.body_id(*b)) +
                                      " has a velocity or position that is not finite: destroy it or set them");
    }
}

} // namespace

std::string reportJson(const FrameReport& report) {
    return written(
        {{"failure", report.failure}, {"why", report.why}, {"refused", report.refused}, {"note", report.note}});
}

void describe(World& w, const FrameReport& report, sc_frame& out) {
    out = {};
    out.advanced = report.advanced;
    out.work = report.work;
    out.injected = report.injected;
    out.energy_gained = report.energy_gained;
    out.steps = report.steps;
    out.unconverged = report.unconverged;
    out.budget_exhausted = report.budget_exhausted ? 1 : 0;
    out.quarantined = static_cast<int32_t>(report.quarantined.size());
    out.left_out = report.refused.empty() ? 0 : 1;
    w.report = reportJson(report);
    if (report.advanced > 0.0)
        w.lastStep = report.advanced;
}

void watchZones(World& w) {
    w.zoneEvents.clear();
    w.zones.sweep([&](std::uint64_t id, Zone& zone) {
        std::vector<ShellHandle> now = done(w.shells.overlap_box(zone.box));
        const auto report = [&](const std::vector<ShellHandle>& of, const std::vector<ShellHandle>& other, int kind) {
            for (const ShellHandle& h : of)
                if (std::find(other.begin(), other.end(), h) == other.end()) {
                    sc_event e{};
                    e.kind = kind;
                    e.time = w.shells.time();
                    e.a = w.out(h);
                    e.zone = {id};
                    w.zoneEvents.push_back(e);
                }
        };
        report(now, zone.inside, SC_ZONE_ENTER);
        report(zone.inside, now, SC_ZONE_LEAVE);
        zone.inside = std::move(now);
        return false;
    });
}

/// What zones, pictures and sound keep of a step.
void watch(World& w) {
    watchZones(w);
    w.snaps.frame(w.shells);
    w.sound.frame(w.shells);
}

void step(World& w, double dt, sc_frame& out, ScenePlayer* scene) {
    if (!w.own)
        refuse(SC_REFUSED, "this world belongs to a host: call sc_world_pre_step, step the b2World by the frame's "
                           "`advanced`, then call sc_world_post_step");
    if (!(dt >= 0.0 && std::isfinite(dt)))
        refuse(SC_BAD_INPUT, "dt must be a finite number of seconds, 0 or more");
    const FrameReport report = scene != nullptr ? scene->pre_step(dt) : w.shells.pre_step(dt);
    describe(w, report, out);
    if (report.advanced > 0.0) {
        requireFiniteBodies(w);
        w.box2d->Step(static_cast<float>(report.advanced), w.velocityIterations, w.positionIterations);
        w.attachment->stepped(report.advanced);
    }
    done(scene != nullptr ? scene->post_step() : w.shells.post_step(), SC_FAILED);
    watch(w);
    if (!report.failure.empty())
        refuse(report.bad_input ? SC_BAD_INPUT : SC_FAILED, report.failure);
}

void preStep(World& w, double dt, sc_frame& out, ScenePlayer* scene) {
    if (w.own)
        refuse(SC_REFUSED, "this world has bodies of its own: sc_world_step and sc_scene_step advance both");
    if (!(dt >= 0.0 && std::isfinite(dt)))
        refuse(SC_BAD_INPUT, "dt must be a finite number of seconds, 0 or more");
    w.requireUnlocked();
    const FrameReport report = scene != nullptr ? scene->pre_step(dt) : w.shells.pre_step(dt);
    describe(w, report, out);
    if (!report.failure.empty())
        refuse(report.bad_input ? SC_BAD_INPUT : SC_FAILED, report.failure);
}

void postStep(World& w) {
    if (w.own)
        refuse(SC_REFUSED, "this world has bodies of its own: sc_world_step and sc_scene_step advance both");
    w.requireUnlocked();
    done(w.shells.post_step(), SC_FAILED);
    watch(w);
}

} // namespace supercircle::c

using namespace supercircle::c;
using supercircle::FrameReport;

sc_status sc_world_step(sc_world w, double dt, sc_frame* out) {
    return use(w, [&](World& x) {
        sc_frame frame{};
        sc_frame& result = out != nullptr ? *out : frame;
        step(x, dt, result, nullptr);
    });
}

const char* sc_world_report(sc_world w) {
    return textIn(w, [&](World& x) { return x.report; });
}

sc_status sc_world_attach(b2World* host, const sc_world_def* def, sc_world* out) {
    return shielded([&] {
        given(host, "the host's world");
        given(out, "the result");
        if (host->IsLocked())
            refuse(SC_REFUSED, "the host's world is inside its step");
        *out = enlist(def, host);
    });
}

sc_status sc_world_pre_step(sc_world w, double dt, sc_frame* out) {
    return use(w, [&](World& x) {
        sc_frame frame{};
        preStep(x, dt, out != nullptr ? *out : frame, nullptr);
    });
}

sc_status sc_world_post_step(sc_world w) {
    return use(w, [&](World& x) { postStep(x); });
}
