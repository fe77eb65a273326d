// Plays a scene in the caller's loop and frames, without recording. The laboratory (plugin/lab) plays the same scenes
// in frames of its own and records them. Drop, approach and protocol are the same in both.

#include "plugin/api/include/supercircle/scene.hpp"

#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/loader.h"
#include "plugin/scene/player/dropper.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle {

namespace {

using rod::Vec2;

constexpr double kHuge = 1e5;    ///< m, half the size of a box around the whole host world
constexpr double kCreep = 1e-3;  ///< m/s, approach without approach_speed
constexpr double kAtRest = 1e-4; ///< m/s, slower than this is at rest
constexpr double kNotYet = 0.05; ///< s, before this a shell may be slow because it has just been created
constexpr double kNever = std::numeric_limits<double>::infinity();

} // namespace

struct ScenePlayer::Impl {
    enum class Phase : std::uint8_t { Drop, Settle, Approach, Protocol, Free, Done };

    Impl(scene::Scene s, Shells& host, std::uint64_t seed) : scene(std::move(s)), shells(&host), random(seed) {}

    scene::Scene scene;
    Shells* shells;
    player::Random random;
    std::vector<ShellHandle> made;
    Phase current = Phase::Free;
    std::string failure;
    int dropped = 0;
    std::size_t segment = 0;
    double since = 0.0;      ///< s, start of the present phase, segment or batch
    double zeroTravel = 0.0; ///< m
    bool atSpecimen = false;

    [[nodiscard]] double elapsed() const { return shells->time() - since; }
    [[nodiscard]] Vec2 direction() const { return {scene.protocol->direction.x, scene.protocol->direction.y}; }
    [[nodiscard]] double rawTravel() const {
        return scene.protocol ? shells->world().crossheadTravel.dot(direction()) : 0.0;
    }
    [[nodiscard]] double force() const {
        return scene.protocol ? -shells->world().crossheadForce().dot(direction()) : 0.0;
    }
    void setSpeed(double speed) {
        const Vec2 v = scene.protocol ? Vec2(speed * direction()) : Vec2::Zero();
        if (const Status set = shells->set_crosshead_velocity({v.x(), v.y()}); !set)
            failure = set.error();
    }
    void enter(Phase next) {
        current = next;
        since = shells->time();
    }

    Status populate();
    void start();
    void prepare();
    void skipFinished(double dt);
    void dropNextBatch();
    void jumpToSpecimen();
    void nextSegment();
    double limit(double dt);
    [[nodiscard]] bool waitsForForce() const { return current == Phase::Approach || current == Phase::Protocol; }
    bool reached();
    std::string phase() const;
};

/// Creates bodies, shells and holds and attaches the crosshead. The caller destroys the shells after a failure.
Status ScenePlayer::Impl::populate() {
    const std::shared_ptr<step::Port> port = shells->host();
    if (!port && !scene.rigid.bodies.empty())
        return Status::failure("the scene has rigid bodies, but these shells have no host world");
    std::vector<std::pair<std::string, ShellHandle>> named;
    for (const ShellDef& d : scene.shells) {
        const auto shell = shells->create(d);
        if (!shell)
            return Status::failure("shell \"" + d.name + "\": " + shell.error());
        made.push_back(*shell);
        step::setEffectSettings(shells->world(), shells->size() - 1, effects::settingsFor(scene.effects, d.name));
        named.emplace_back(d.name, *shell);
    }
    for (const HoldDef& h : scene.holds) {
        const auto it = std::find_if(named.begin(), named.end(), [&](const auto& n) { return n.first == h.shell; });
        if (it == named.end())
            return Status::failure("hold: there is no shell called \"" + h.shell + "\"");
        if (const auto hold = shells->create_hold(it->second, h.arc_fraction, h.kind, h.base); !hold)
            return Status::failure("hold on \"" + h.shell + "\": " + hold.error());
    }
    if (port) // last, because bodies are not destroyed after an error
        if (std::string why = port->build(scene.rigid); !why.empty())
            return Status::failure(std::move(why));
    if (scene.protocol && !scene.protocol->body.empty() && !shells->attach_to_crosshead(scene.protocol->body))
        return Status::failure("protocol: there is no body called \"" + scene.protocol->body + "\"");
    return {};
}

void ScenePlayer::Impl::start() {
    if (scene.drop && scene.drop->count > 0)
        enter(Phase::Drop);
    else if (scene.protocol)
        enter(Phase::Approach);
    else
        enter(Phase::Free);
    if (current == Phase::Approach && !scene.protocol->zero_at_first_contact)
        prepare();
}

void ScenePlayer::Impl::dropNextBatch() {
    const scene::Drop& d = *scene.drop;
    if (dropped > 0) {
        const bool last = dropped >= d.count;
        const double speed = last ? d.final_settle_speed : d.settle_speed;
        const double longest = last ? d.final_settle_time : d.settle_time;
        const bool still = elapsed() > kNotYet && player::fastest(shells->world()) < speed;
        if (!still && elapsed() < longest * (1.0 - 1e-9))
            return;
        if (last)
            return enter(scene.protocol ? Phase::Approach : Phase::Free);
    }
    const int count = std::min(d.batch_size, d.count - dropped);
    const std::size_t before = shells->world().rods.size();
    if (const Status placed = player::dropBatch(*shells, d, count, random, made); !placed)
        failure = placed.error();
    for (std::size_t i = before; i < shells->world().rods.size(); ++i)
        step::setEffectSettings(shells->world(), i, effects::settingsFor(scene.effects, {}));
    dropped += count;
    since = shells->time();
}

/// Moves the crosshead to the approach gap above the specimen: nothing is in between.
void ScenePlayer::Impl::jumpToSpecimen() {
    atSpecimen = true;
    const scene::Protocol& p = *scene.protocol;
    const std::shared_ptr<step::Port> port = shells->host();
    if (!port)
        return;
    std::vector<step::BodyOutline> all;
    port->query({Vec2::Constant(-kHuge), Vec2::Constant(kHuge)}, all);
    step::World& w = shells->world();
    double bottom = kNever;
    for (const step::BodyOutline& o : all) {
        step::BodyState s;
        const bool attached = std::count(w.crossheadBodies.begin(), w.crossheadBodies.end(), o.body) > 0;
        if (!attached || !port->state(o.body, s))
            continue;
        for (const Vec2& at : step::placed(o, s.centre, s.angle).points)
            bottom = std::min(bottom, at.y() - o.local.radius);
    }
    const double free = bottom - player::pileTop(w);
    if (!(free > p.approach_gap) || !std::isfinite(free))
        return;
    for (const step::BodyId id : w.crossheadBodies) {
        step::BodyState s;
        if (port->state(id, s))
            port->drive(id, s.centre - Vec2(0.0, free - p.approach_gap), s.angle, Vec2::Zero(), 0.0);
        if (const int known = step::bodyIndex(w, id); known >= 0) // the pose of driven bodies is kept here
            w.bodies[static_cast<std::size_t>(known)].state.centre.y() -= free - p.approach_gap;
    }
    w.range.clear();
}

void ScenePlayer::Impl::nextSegment() {
    setSpeed(0.0);
    ++segment;
    since = shells->time();
    if (segment >= scene.protocol->segments.size())
        enter(Phase::Done);
}

/// Starts what is due at the beginning of a frame.
void ScenePlayer::Impl::prepare() {
    if (current == Phase::Drop)
        dropNextBatch();
    if (current == Phase::Approach) {
        const scene::Protocol& p = *scene.protocol;
        if (p.zero_at_first_contact && !atSpecimen)
            jumpToSpecimen();
        setSpeed(p.approach_speed > 0.0 ? p.approach_speed : kCreep);
        const double longest = 1.0 + (p.approach_gap + 1e-3) / (p.approach_speed > 0.0 ? p.approach_speed : kCreep);
        if (!p.zero_at_first_contact || force() > 0.0 || elapsed() > longest) {
            zeroTravel = p.zero_at_first_contact ? rawTravel() : 0.0;
            setSpeed(0.0);
            enter(p.segments.empty() ? Phase::Done : Phase::Protocol);
        }
    }
    if (current == Phase::Protocol) {
        const scene::ProtocolSegment& m = scene.protocol->segments[segment];
        setSpeed(m.kind == scene::ProtocolSegment::Kind::Travel ? m.speed : 0.0);
    }
}

/// Time that the present phase may take of a frame, s.
double ScenePlayer::Impl::limit(double dt) {
    double left = kNever;
    if (current == Phase::Protocol) {
        const scene::ProtocolSegment& m = scene.protocol->segments[segment];
        left = m.stop_when.time - elapsed();
        if (m.kind == scene::ProtocolSegment::Kind::Travel && m.speed != 0.0 && std::isfinite(m.stop_when.displacement))
            left = std::min(left, (m.stop_when.displacement - (rawTravel() - zeroTravel)) / m.speed);
    } else if (current == Phase::Free) {
        left = scene.duration - elapsed();
    }
    return std::clamp(left, 0.0, dt);
}

/// Inside a frame, after each inner step: whether the phase ends here.
bool ScenePlayer::Impl::reached() {
    if (current == Phase::Approach)
        return force() > 0.0;
    return current == Phase::Protocol && force() >= scene.protocol->segments[segment].stop_when.force;
}

std::string ScenePlayer::Impl::phase() const {
    switch (current) {
    case Phase::Drop:
        return dropped >= scene.drop->count ? "settle" : "drop " + std::to_string(dropped);
    case Phase::Settle:
        return "settle";
    case Phase::Approach:
        return "approach";
    case Phase::Protocol: {
        const scene::ProtocolSegment& m = scene.protocol->segments[segment];
        if (m.kind == scene::ProtocolSegment::Kind::Travel)
            return (m.speed > 0.0 ? "load " : "unload ") + std::to_string(std::max(1, m.cycle));
        return m.kind == scene::ProtocolSegment::Kind::Hold ? "hold" : "settle";
    }
    case Phase::Free:
        return "free";
    case Phase::Done:
        break;
    }
    return "done";
}

/// Starts what is due, and ends phases and segments without time left.
void ScenePlayer::Impl::skipFinished(double dt) {
    for (int skipped = 0; failure.empty() && skipped < 100000; ++skipped) {
        prepare();
        if (current == Phase::Done || !failure.empty() || limit(dt) > 1e-9 * dt)
            return;
        if (current == Phase::Protocol)
            nextSegment();
        else
            enter(Phase::Done);
    }
}

FrameReport ScenePlayer::pre_step(double dt) {
    Impl& s = *impl_;
    if (dt == 0.0)
        return s.shells->pre_step(0.0); // a pause
    FrameReport report;
    try {
        s.skipFinished(dt);
    } catch (const std::exception& e) { // no exception leaves Shells or ScenePlayer
        s.failure = e.what();
    }
    if (!s.failure.empty()) {
        report.failure = s.failure;
        return report;
    }
    const double frame = s.current == Impl::Phase::Done ? dt : s.limit(dt);
    bool over = false;
    report = s.waitsForForce() ? s.shells->pre_step(frame, [&] { return over = s.reached(); })
                               : s.shells->pre_step(frame); // nobody watches: islands step by themselves
    s.failure = report.failure;
    if (s.current == Impl::Phase::Protocol) {
        const scene::ProtocolSegment& m = s.scene.protocol->segments[s.segment];
        const bool still = m.kind == scene::ProtocolSegment::Kind::Settle && s.elapsed() > kNotYet &&
                           player::fastest(s.shells->world()) < kAtRest;
        if (over || still)
            s.nextSegment();
    }
    if (s.failure.empty() && (s.current == Impl::Phase::Protocol || s.current == Impl::Phase::Free))
        s.skipFinished(dt); // so that finished() is true with the last frame, not after it
    return report;
}

Status ScenePlayer::post_step() {
    return impl_->shells->post_step();
}
bool ScenePlayer::finished() const {
    return impl_->current == Impl::Phase::Done || !impl_->failure.empty();
}
std::string ScenePlayer::phase() const {
    return impl_->phase();
}
double ScenePlayer::travel() const {
    return impl_->rawTravel() - impl_->zeroTravel;
}
double ScenePlayer::force() const {
    return impl_->force();
}
const std::vector<ShellHandle>& ScenePlayer::shells() const {
    return impl_->made;
}
const std::string& ScenePlayer::name() const {
    return impl_->scene.name;
}

Result<ScenePlayer> load_scene_text(const std::string& text, const std::string& file, Shells& shells,
                                    const SceneOptions& options) {
    using Answer = Result<ScenePlayer>;
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : options.parameters)
        overrides.push_back({name, value});
    std::vector<scene::Problem> problems;
    Result<scene::Scene> scene = scene::loadText(text, file, overrides, problems);
    if (!scene)
        return Answer::failure(scene.error());
    auto impl = std::make_shared<ScenePlayer::Impl>(*std::move(scene), shells, options.seed);
    if (const Status populated = impl->populate(); !populated) {
        for (const ShellHandle shell : impl->made)
            (void)shells.destroy(shell);
        return Answer::failure(file + ": " + populated.error());
    }
    impl->start();
    return ScenePlayer(std::move(impl));
}

Result<ScenePlayer> load_scene(const std::string& path, Shells& shells, const SceneOptions& options) {
    std::vector<scene::Problem> problems;
    const auto text = scene::readFile(path, problems);
    return text ? load_scene_text(*text, path, shells, options) : Result<ScenePlayer>::failure(text.error());
}

} // namespace supercircle
