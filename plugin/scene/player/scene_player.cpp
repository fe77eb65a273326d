// A scene in somebody else's loop. The laboratory (plugin/lab) plays the same scenes in frames of its own choosing and
// records them; here the caller's frame rules and nothing is recorded. Drop, touch and moves mean the same in both.

#include "plugin/api/include/supercircle/scene.hpp"

#include "plugin/scene/loader/loader.h"
#include "plugin/scene/player/dropper.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle {

namespace {

using rod::Vec2;

constexpr double kHuge = 1e5;    ///< m, a box around everything that a host can hold
constexpr double kCreep = 1e-3;  ///< m/s, approach when the scene names no speed
constexpr double kAtRest = 1e-4; ///< m/s, nothing moves
constexpr double kNotYet = 0.05; ///< s, a shell just released is slow without being at rest
constexpr double kNever = std::numeric_limits<double>::infinity();

} // namespace

struct ScenePlayer::Impl {
    enum class Stage : std::uint8_t { Drop, Settle, Touch, Moves, Free, Done };

    Impl(scene::Scene s, Shells& host, std::uint64_t seed) : scene(std::move(s)), shells(&host), random(seed) {}

    scene::Scene scene;
    Shells* shells;
    player::Random random;
    std::vector<ShellHandle> made;
    Stage stage = Stage::Free;
    std::string failure;
    int dropped = 0;
    std::size_t move = 0;
    double since = 0.0;      ///< s, when the present stage, move or batch began
    double zeroTravel = 0.0; ///< m
    bool jumped = false;

    [[nodiscard]] double elapsed() const { return shells->time() - since; }
    [[nodiscard]] Vec2 direction() const { return {scene.protocol->direction.x, scene.protocol->direction.y}; }
    [[nodiscard]] double rawTravel() const {
        return scene.protocol ? shells->world().machineTravel.dot(direction()) : 0.0;
    }
    [[nodiscard]] double force() const {
        return scene.protocol ? -shells->world().machineForce().dot(direction()) : 0.0;
    }
    void drive(double speed) {
        const Vec2 v = scene.protocol ? Vec2(speed * direction()) : Vec2::Zero();
        shells->set_machine_velocity({v.x(), v.y()});
    }
    void enter(Stage next) {
        stage = next;
        since = shells->time();
    }

    std::string populate();
    void start();
    void prepare();
    void passOver(double dt);
    void dropNext();
    void jumpToPile();
    void nextMove();
    double limit(double dt);
    bool reached();
    void addEffects(std::size_t rod, const std::string& name);
    std::string phase() const;
};

/// Effects of the material, of loads and of contact; what the laboratory's machine and load cell do is not played.
void ScenePlayer::Impl::addEffects(std::size_t rod, const std::string& name) {
    if (!scene.effects.empty())
        step::setEffects(shells->world(), rod, effects::modelFor(scene.effects, name.empty() ? "all" : name));
}

/// Bodies, shells, holds and the machine. Empty or why not; what was added by then is taken back by the caller.
std::string ScenePlayer::Impl::populate() {
    const std::shared_ptr<step::Port> port = shells->host();
    if (!port && !scene.rigid.bodies.empty())
        return "the scene has rigid bodies, but these shells have no host world";
    std::vector<std::pair<std::string, ShellHandle>> named;
    for (const ShellDef& d : scene.shells) {
        const auto shell = shells->create(d);
        if (!shell)
            return "shell \"" + d.name + "\": " + shell.error();
        made.push_back(*shell);
        addEffects(shells->world().rods.size() - 1, d.name);
        named.emplace_back(d.name, *shell);
    }
    for (const HoldDef& h : scene.holds) {
        const auto it = std::find_if(named.begin(), named.end(), [&](const auto& n) { return n.first == h.shell; });
        if (it == named.end())
            return "hold: there is no shell called \"" + h.shell + "\"";
        if (const auto hold = shells->hold(it->second, h.arc_fraction, h.kind, h.on_machine); !hold)
            return "hold on \"" + h.shell + "\": " + hold.error();
    }
    if (port) // last, because bodies cannot be taken back
        if (std::string why = port->build(scene.rigid); !why.empty())
            return why;
    if (scene.protocol && !scene.protocol->body.empty() && !shells->carry(scene.protocol->body))
        return "protocol: the host has no body called \"" + scene.protocol->body + "\"";
    return {};
}

void ScenePlayer::Impl::start() {
    if (scene.drop && scene.drop->count > 0)
        enter(Stage::Drop);
    else if (scene.protocol)
        enter(Stage::Touch);
    else
        enter(Stage::Free);
    if (stage == Stage::Touch && !scene.protocol->zero_at_touch)
        prepare();
}

void ScenePlayer::Impl::dropNext() {
    const scene::Drop& d = *scene.drop;
    if (dropped > 0) {
        const bool last = dropped >= d.count;
        const double speed = last ? d.final_settle_speed : d.settle_speed;
        const double longest = last ? d.final_settle_time : d.settle_time;
        const bool still = elapsed() > kNotYet && player::fastest(shells->world()) < speed;
        if (!still && elapsed() < longest * (1.0 - 1e-9))
            return;
        if (last)
            return enter(scene.protocol ? Stage::Touch : Stage::Free);
    }
    const int count = std::min(d.together, d.count - dropped);
    const std::size_t before = shells->world().rods.size();
    failure = player::dropBatch(*shells, d, count, random, made);
    for (std::size_t i = before; i < shells->world().rods.size(); ++i)
        addEffects(i, {});
    dropped += count;
    since = shells->time();
}

/// Puts the machine just above the pile: nothing is in the way.
void ScenePlayer::Impl::jumpToPile() {
    jumped = true;
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
        const bool machine = std::count(w.machineBodies.begin(), w.machineBodies.end(), o.body) > 0;
        if (!machine || !port->state(o.body, s))
            continue;
        for (const Vec2& at : step::placed(o, s.centre, s.angle).points)
            bottom = std::min(bottom, at.y() - o.local.radius);
    }
    const double free = bottom - player::pileTop(w);
    if (!(free > p.touch_gap) || !std::isfinite(free))
        return;
    for (const step::BodyId id : w.machineBodies) {
        step::BodyState s;
        if (port->state(id, s))
            port->drive(id, s.centre - Vec2(0.0, free - p.touch_gap), s.angle, Vec2::Zero(), 0.0);
        if (const int known = step::bodyIndex(w, id); known >= 0) // our pose of the machine rules over the host's
            w.bodies[static_cast<std::size_t>(known)].state.centre.y() -= free - p.touch_gap;
    }
    w.range.clear();
}

void ScenePlayer::Impl::nextMove() {
    drive(0.0);
    ++move;
    since = shells->time();
    if (move >= scene.protocol->moves.size())
        enter(Stage::Done);
}

/// What is due at the start of a frame.
void ScenePlayer::Impl::prepare() {
    if (stage == Stage::Drop)
        dropNext();
    if (stage == Stage::Touch) {
        const scene::Protocol& p = *scene.protocol;
        if (p.zero_at_touch && !jumped)
            jumpToPile();
        drive(p.approach_speed > 0.0 ? p.approach_speed : kCreep);
        const double longest = 1.0 + (p.touch_gap + 1e-3) / (p.approach_speed > 0.0 ? p.approach_speed : kCreep);
        if (!p.zero_at_touch || force() > 0.0 || elapsed() > longest) {
            zeroTravel = p.zero_at_touch ? rawTravel() : 0.0;
            drive(0.0);
            enter(p.moves.empty() ? Stage::Done : Stage::Moves);
        }
    }
    if (stage == Stage::Moves) {
        const scene::Move& m = scene.protocol->moves[move];
        drive(m.kind == scene::Move::Kind::Travel ? m.speed : 0.0);
    }
}

/// How much of the frame the present stage may use.
double ScenePlayer::Impl::limit(double dt) {
    double left = kNever;
    if (stage == Stage::Moves) {
        const scene::Move& m = scene.protocol->moves[move];
        left = m.until.time - elapsed();
        if (m.kind == scene::Move::Kind::Travel && m.speed != 0.0 && std::isfinite(m.until.displacement))
            left = std::min(left, (m.until.displacement - (rawTravel() - zeroTravel)) / m.speed);
    } else if (stage == Stage::Free) {
        left = scene.duration - elapsed();
    }
    return std::clamp(left, 0.0, dt);
}

/// Inside a frame, after each inner step: the stage is over.
bool ScenePlayer::Impl::reached() {
    if (stage == Stage::Touch)
        return force() > 0.0;
    return stage == Stage::Moves && force() >= scene.protocol->moves[move].until.force;
}

std::string ScenePlayer::Impl::phase() const {
    switch (stage) {
    case Stage::Drop:
        return dropped >= scene.drop->count ? "settle" : "drop " + std::to_string(dropped);
    case Stage::Settle:
        return "settle";
    case Stage::Touch:
        return "approach";
    case Stage::Moves: {
        const scene::Move& m = scene.protocol->moves[move];
        if (m.kind == scene::Move::Kind::Travel)
            return (m.speed > 0.0 ? "load " : "unload ") + std::to_string(std::max(1, m.cycle));
        return m.kind == scene::Move::Kind::Hold ? "hold" : "settle";
    }
    case Stage::Free:
        return "free";
    case Stage::Done:
        break;
    }
    return "done";
}

/// Makes what is due, and leaves stages and moves that have no time left behind.
void ScenePlayer::Impl::passOver(double dt) {
    for (int skipped = 0; failure.empty() && skipped < 100000; ++skipped) {
        prepare();
        if (stage == Stage::Done || !failure.empty() || limit(dt) > 1e-9 * dt)
            return;
        if (stage == Stage::Moves)
            nextMove();
        else
            enter(Stage::Done);
    }
}

FrameReport ScenePlayer::pre_step(double dt) {
    Impl& s = *impl_;
    FrameReport report;
    try {
        s.passOver(dt);
    } catch (const std::exception& e) { // the host program never dies of us
        s.failure = e.what();
    }
    if (!s.failure.empty()) {
        report.failure = s.failure;
        return report;
    }
    const bool done = s.stage == Impl::Stage::Done;
    bool over = false;
    report = s.shells->pre_step(done ? dt : s.limit(dt), [&] { return over = s.reached(); });
    s.failure = report.failure;
    if (s.stage == Impl::Stage::Moves) {
        const scene::Move& m = s.scene.protocol->moves[s.move];
        const bool still = m.kind == scene::Move::Kind::Settle && s.elapsed() > kNotYet &&
                           player::fastest(s.shells->world()) < kAtRest;
        if (over || still)
            s.nextMove();
    }
    if (s.failure.empty() && (s.stage == Impl::Stage::Moves || s.stage == Impl::Stage::Free))
        s.passOver(dt); // so that finished() is true with the last frame, not after it
    return report;
}

void ScenePlayer::post_step() {
    impl_->shells->post_step();
}
bool ScenePlayer::finished() const {
    return impl_->stage == Impl::Stage::Done || !impl_->failure.empty();
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

Result<ScenePlayer> load_scene(const std::string& path, Shells& shells, const SceneOptions& options) {
    using Answer = Result<ScenePlayer>;
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : options.parameters)
        overrides.push_back({name, value});
    std::vector<scene::Problem> problems;
    std::optional<scene::Scene> scene = scene::load(path, overrides, problems);
    if (!scene) {
        std::string all;
        for (const scene::Problem& p : problems)
            if (p.severity == scene::Problem::Severity::Error)
                all += (all.empty() ? "" : "\n") + p.toString();
        return Answer::failure(all);
    }
    auto impl = std::make_shared<ScenePlayer::Impl>(std::move(*scene), shells, options.seed);
    if (const std::string why = impl->populate(); !why.empty()) {
        for (const ShellHandle shell : impl->made)
            shells.destroy(shell);
        return Answer::failure(path + ": " + why);
    }
    impl->start();
    return ScenePlayer(std::move(impl));
}

} // namespace supercircle
