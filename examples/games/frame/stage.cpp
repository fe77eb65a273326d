#include "examples/games/frame/stage.h"

#include "bridge/box2d/box2d_port.h"
#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "plugin/scene/loader/loader.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

namespace supercircle::frame {

namespace {

constexpr int kPieces = 48; ///< of a drawn centre line

/// Processor time of this thread, s.
double cpuNow() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

using Line = std::vector<Point>;

} // namespace

struct Stage::Impl {
    Impl(scene::Scene s, Quality q)
        : scene(std::move(s)), world(b2Vec2(0.0F, 0.0F)), attachment(bridge::attach(world, {scene.rigid.lengthScale})),
          shells(attachment) {
        shells.set_quality(q);
    }

    scene::Scene scene;
    scene::Game noGame;
    std::string path;
    b2World world;
    bridge::Attachment attachment;
    Shells shells;
    std::unique_ptr<ScenePlayer> player;
    FrameReport report;
    double time = 0.0, cost = 0.0, worst = 0.0;
    std::uint64_t frames = 0;

    GrabHandle hand{};
    ShellHandle heldShell{};
    double heldFraction = 0.0;
    b2MouseJoint* bodyHand = nullptr;
    b2Body* ground = nullptr;
    Point handTarget{};
    int held = 0;

    std::map<const b2Body*, BodyPose> bodyBefore;
    std::map<std::uint32_t, Line> lineBefore; ///< by index of the handle

    [[nodiscard]] Point metres(const b2Vec2& v) const {
        const double u = scene.rigid.lengthScale;
        return {static_cast<double>(v.x) / u, static_cast<double>(v.y) / u};
    }
    [[nodiscard]] b2Vec2 unitsOf(Point p) const {
        const double u = scene.rigid.lengthScale;
        return {static_cast<float>(p.x * u), static_cast<float>(p.y * u)};
    }
    [[nodiscard]] BodyPose pose(b2Body& b) const {
        const Point p = metres(b.GetPosition());
        return {&b, p.x, p.y, static_cast<double>(b.GetAngle())};
    }
    [[nodiscard]] Line lineOf(ShellHandle shell) const {
        Line line;
        for (int i = 0; i <= kPieces; ++i)
            if (const auto section = shells.section(shell, static_cast<double>(i) / kPieces))
                line.push_back(section->position);
        return line;
    }
    void remember() {
        bodyBefore.clear();
        for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
            bodyBefore[b] = pose(*b);
        lineBefore.clear();
        for (const ShellHandle shell : shells.list())
            lineBefore[shell.index] = lineOf(shell);
    }
    b2Body* bodyAt(Point at) const;
};

b2Body* Stage::Impl::bodyAt(Point at) const {
    const b2Vec2 p = unitsOf(at);
    for (b2Body* b = const_cast<b2World&>(world).GetBodyList(); b != nullptr; b = b->GetNext())
        if (b->GetType() == b2_dynamicBody && b->IsEnabled())
            for (b2Fixture* f = b->GetFixtureList(); f != nullptr; f = f->GetNext())
                if (f->TestPoint(p))
                    return b;
    return nullptr;
}

Stage::Stage() = default;
Stage::~Stage() = default;

Result<std::shared_ptr<Stage>>
Stage::load(const std::string& path, const std::vector<std::pair<std::string, double>>& parameters, Quality quality) {
    using Answer = Result<std::shared_ptr<Stage>>;
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : parameters)
        overrides.push_back({name, value});
    std::vector<scene::Problem> problems;
    auto scene = scene::load(path, overrides, problems);
    std::string all;
    for (const scene::Problem& p : problems)
        if (p.severity == scene::Problem::Severity::Error)
            all += (all.empty() ? "" : "\n") + p.toString();
    if (!scene)
        return Answer::failure(all);
    std::shared_ptr<Stage> stage(new Stage);
    stage->impl_ = std::make_unique<Impl>(std::move(*scene), quality);
    Impl& s = *stage->impl_;
    s.path = path;
    auto player = load_scene(path, s.shells, {parameters, 1});
    if (!player)
        return Answer::failure(player.error());
    s.player = std::make_unique<ScenePlayer>(*player);
    s.ground = s.world.CreateBody(std::make_unique<b2BodyDef>().get());
    s.remember();
    return stage;
}

const scene::Scene& Stage::scene() const {
    return impl_->scene;
}
const scene::Game& Stage::game() const {
    return impl_->scene.game ? *impl_->scene.game : impl_->noGame;
}
const std::string& Stage::path() const {
    return impl_->path;
}
Shells& Stage::shells() {
    return impl_->shells;
}
const Shells& Stage::shells() const {
    return impl_->shells;
}
ScenePlayer& Stage::player() {
    return *impl_->player;
}
b2Body* Stage::body(const std::string& name) const {
    const auto id = impl_->shells.body(name);
    return id ? impl_->attachment->bodyOf(*id) : nullptr;
}
std::uint64_t Stage::id(const b2Body& body) const {
    return impl_->attachment.body_id(body);
}
double Stage::units() const {
    return impl_->scene.rigid.lengthScale;
}
Point Stage::position(const b2Body& body) const {
    return impl_->metres(body.GetWorldCenter());
}
Point Stage::velocity(const b2Body& body) const {
    return impl_->metres(body.GetLinearVelocity());
}
void Stage::push(b2Body& body, Point force, double torque) {
    body.ApplyForceToCenter(impl_->unitsOf(force), true);
    body.ApplyTorque(static_cast<float>(torque * units() * units()), true);
}

Result<ShellHandle> Stage::add(const scene::GamePart& part, Point middle, double angle, Point velocity) {
    ShellDef def = scaledShell(part.radius, part.mass, part.phi_bar, part.stiffness);
    def.mu = part.mu;
    def.elements = part.elements;
    def.position = middle;
    def.angle = angle;
    def.velocity = velocity;
    def.name = part.name;
    def.user_data = part.colour;
    return impl_->shells.create(def);
}

std::uint32_t Stage::colour(ShellHandle shell) const {
    const auto data = impl_->shells.user_data(shell);
    return data && *data != 0 ? static_cast<std::uint32_t>(*data) : 0x3a7bd5U;
}

FrameReport Stage::step(double dt) {
    Impl& s = *impl_;
    s.remember();
    const double before = cpuNow();
    s.report = s.player->pre_step(dt);
    if (s.report.advanced > 0.0) {
        s.world.Step(static_cast<float>(s.report.advanced), 8, 3);
        s.attachment->stepped(s.report.advanced);
    }
    s.player->post_step();
    const double spent = 1e3 * (cpuNow() - before);
    s.cost += spent;
    s.worst = std::max(s.worst, spent);
    s.time += s.report.advanced;
    ++s.frames;
    if (!s.hand.null() && !s.shells.valid(s.hand))
        s.hand = {};
    return s.report;
}

const FrameReport& Stage::report() const {
    return impl_->report;
}
double Stage::time() const {
    return impl_->time;
}
std::uint64_t Stage::frames() const {
    return impl_->frames;
}
double Stage::meanCost() const {
    return impl_->frames > 0 ? impl_->cost / static_cast<double>(impl_->frames) : 0.0;
}
double Stage::worstCost() const {
    return impl_->worst;
}

bool Stage::take(Point at, double reach, double strength, double shellFrequency, double bodyFrequency) {
    letGo();
    Impl& s = *impl_;
    s.handTarget = at;
    if (b2Body* body = s.bodyAt(at)) {
        b2MouseJointDef def;
        def.bodyA = s.ground;
        def.bodyB = body;
        def.target = s.unitsOf(at);
        const double mass = static_cast<double>(body->GetMass());
        def.maxForce = static_cast<float>((strength > 0.0 ? strength : 1000.0 * mass) * units());
        b2LinearStiffness(def.stiffness, def.damping, static_cast<float>(bodyFrequency), 0.9F, s.ground, body);
        s.bodyHand = static_cast<b2MouseJoint*>(s.world.CreateJoint(&def));
        body->SetAwake(true);
        ++s.held;
        return true;
    }
    const auto near = s.shells.nearest(at, reach);
    if (!near)
        return false;
    GrabDef def;
    def.arc_fraction = near->arc_fraction;
    def.target = at;
    def.frequency = shellFrequency;
    def.max_force = strength;
    const auto hand = s.shells.grab(near->shell, def);
    if (!hand)
        return false;
    s.hand = *hand;
    s.heldShell = near->shell;
    s.heldFraction = near->arc_fraction;
    ++s.held;
    return true;
}

void Stage::moveHand(Point to) {
    Impl& s = *impl_;
    s.handTarget = to;
    if (!s.hand.null())
        s.shells.move(s.hand, to);
    if (s.bodyHand != nullptr)
        s.bodyHand->SetTarget(s.unitsOf(to));
}

void Stage::letGo() {
    Impl& s = *impl_;
    if (!s.hand.null())
        s.shells.release(s.hand);
    s.hand = {};
    if (s.bodyHand != nullptr)
        s.world.DestroyJoint(s.bodyHand);
    s.bodyHand = nullptr;
}

bool Stage::holding() const {
    return impl_->bodyHand != nullptr || !impl_->hand.null();
}

ShellHandle Stage::heldShell() const {
    return impl_->hand.null() ? ShellHandle{} : impl_->heldShell;
}

b2Body* Stage::heldBody() const {
    return impl_->bodyHand != nullptr ? impl_->bodyHand->GetBodyB() : nullptr;
}

int Stage::timesHeld() const {
    return impl_->held;
}

Point Stage::handAt() const {
    const Impl& s = *impl_;
    if (s.bodyHand != nullptr)
        return s.metres(s.bodyHand->GetAnchorB());
    const auto section = s.shells.section(s.heldShell, s.heldFraction);
    return section ? section->position : s.handTarget;
}

Point Stage::handTarget() const {
    return impl_->handTarget;
}

std::vector<BodyPose> Stage::bodies(double alpha) const {
    std::vector<BodyPose> out;
    for (b2Body* b = impl_->world.GetBodyList(); b != nullptr; b = b->GetNext()) {
        BodyPose now = impl_->pose(*b);
        if (const auto it = impl_->bodyBefore.find(b); it != impl_->bodyBefore.end()) {
            const BodyPose& old = it->second;
            now.x = old.x + alpha * (now.x - old.x);
            now.y = old.y + alpha * (now.y - old.y);
            now.angle = old.angle + alpha * (now.angle - old.angle);
        }
        out.push_back(now);
    }
    std::reverse(out.begin(), out.end()); // in the order of creation
    return out;
}

std::vector<Point> Stage::line(ShellHandle shell, double alpha) const {
    Line now = impl_->lineOf(shell);
    const auto it = impl_->lineBefore.find(shell.index);
    if (it == impl_->lineBefore.end() || it->second.size() != now.size() || alpha >= 1.0)
        return now;
    for (std::size_t i = 0; i < now.size(); ++i) {
        now[i].x = it->second[i].x + alpha * (now[i].x - it->second[i].x);
        now[i].y = it->second[i].y + alpha * (now[i].y - it->second[i].y);
    }
    return now;
}

} // namespace supercircle::frame
