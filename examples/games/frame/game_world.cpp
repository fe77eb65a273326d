#include "examples/games/frame/game_world.h"

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

struct GameWorld::Impl {
    Impl(scene::Scene s, Quality q)
        : scene(std::move(s)), world(b2Vec2(0.0F, 0.0F)), attachment(bridge::attach(world, {scene.rigid.lengthScale})),
          shells(attachment) {
        shells.set_quality(q).or_fail();
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

    MouseJointHandle mouseJoint{};
    ShellHandle draggedShell{};
    double draggedFraction = 0.0;
    b2MouseJoint* bodyJoint = nullptr;
    b2Body* ground = nullptr;
    Point dragTarget{};
    int drags = 0;

    std::map<const b2Body*, BodyPose> bodyBefore;
    std::map<std::uint32_t, Line> lineBefore; ///< by index of the handle
    live::SnapWatch snaps;
    live::SoundWatch sound;

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
        for (const ShellHandle shell : shells.shells())
            lineBefore[shell.index] = lineOf(shell);
    }
    b2Body* bodyAt(Point at) const;
};

b2Body* GameWorld::Impl::bodyAt(Point at) const {
    const b2Vec2 p = unitsOf(at);
    for (b2Body* b = const_cast<b2World&>(world).GetBodyList(); b != nullptr; b = b->GetNext())
        if (b->GetType() == b2_dynamicBody && b->IsEnabled())
            for (b2Fixture* f = b->GetFixtureList(); f != nullptr; f = f->GetNext())
                if (f->TestPoint(p))
                    return b;
    return nullptr;
}

GameWorld::GameWorld() = default;
GameWorld::~GameWorld() = default;

Result<std::shared_ptr<GameWorld>> GameWorld::load(const std::string& path,
                                                   const std::vector<std::pair<std::string, double>>& parameters,
                                                   Quality quality) {
    using Answer = Result<std::shared_ptr<GameWorld>>;
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : parameters)
        overrides.push_back({name, value});
    std::vector<scene::Problem> problems;
    auto scene = scene::load(path, overrides, problems);
    if (!scene)
        return Answer::failure(scene.error());
    std::shared_ptr<GameWorld> world(new GameWorld);
    world->impl_ = std::make_unique<Impl>(std::move(*scene), quality);
    Impl& s = *world->impl_;
    s.path = path;
    auto player = load_scene(path, s.shells, {parameters, 1});
    if (!player)
        return Answer::failure(player.error());
    s.player = std::make_unique<ScenePlayer>(*player);
    s.ground = s.world.CreateBody(std::make_unique<b2BodyDef>().get());
    s.remember();
    return world;
}

const scene::Scene& GameWorld::scene() const {
    return impl_->scene;
}
const scene::Game& GameWorld::game() const {
    return impl_->scene.game ? *impl_->scene.game : impl_->noGame;
}
const std::string& GameWorld::path() const {
    return impl_->path;
}
Shells& GameWorld::shells() {
    return impl_->shells;
}
const Shells& GameWorld::shells() const {
    return impl_->shells;
}
ScenePlayer& GameWorld::player() {
    return *impl_->player;
}
b2Body* GameWorld::body(const std::string& name) const {
    const auto id = impl_->shells.body(name);
    return id ? impl_->attachment->bodyOf(*id) : nullptr;
}
std::uint64_t GameWorld::id(const b2Body& body) const {
    return impl_->attachment.body_id(body);
}
double GameWorld::units() const {
    return impl_->scene.rigid.lengthScale;
}
Point GameWorld::position(const b2Body& body) const {
    return impl_->metres(body.GetWorldCenter());
}
Point GameWorld::velocity(const b2Body& body) const {
    return impl_->metres(body.GetLinearVelocity());
}
void GameWorld::push(b2Body& body, Point force, double torque) {
    body.ApplyForceToCenter(impl_->unitsOf(force), true);
    body.ApplyTorque(static_cast<float>(torque * units() * units()), true);
}

Result<ShellHandle> GameWorld::add(const scene::GamePart& part, Point middle, double angle, Point velocity) {
    ShellDef def = scaled_shell(part.radius, part.mass, part.phi_bar, part.stiffness);
    def.mu = part.mu;
    def.elements = part.elements;
    def.position = middle;
    def.angle = angle;
    def.velocity = velocity;
    def.name = part.name;
    def.user_data = part.colour;
    return impl_->shells.create(def);
}

std::uint32_t GameWorld::colour(ShellHandle shell) const {
    const auto data = impl_->shells.user_data(shell);
    return data && *data != 0 ? static_cast<std::uint32_t>(*data) : 0x3a7bd5U;
}

FrameReport GameWorld::step(double dt) {
    Impl& s = *impl_;
    s.remember();
    const double before = cpuNow();
    s.report = s.player->pre_step(dt);
    if (s.report.advanced > 0.0) {
        s.world.Step(static_cast<float>(s.report.advanced), 8, 3);
        s.attachment->stepped(s.report.advanced);
    }
    s.player->post_step().or_fail();
    s.snaps.frame(s.shells);
    s.sound.frame(s.shells);
    const double spent = 1e3 * (cpuNow() - before);
    s.cost += spent;
    s.worst = std::max(s.worst, spent);
    s.time += s.report.advanced;
    ++s.frames;
    if (!s.mouseJoint.null() && !s.shells.valid(s.mouseJoint))
        s.mouseJoint = {};
    return s.report;
}

const FrameReport& GameWorld::report() const {
    return impl_->report;
}
double GameWorld::time() const {
    return impl_->time;
}
std::uint64_t GameWorld::frames() const {
    return impl_->frames;
}
double GameWorld::meanCost() const {
    return impl_->frames > 0 ? impl_->cost / static_cast<double>(impl_->frames) : 0.0;
}
double GameWorld::worstCost() const {
    return impl_->worst;
}

bool GameWorld::startDrag(Point at, double reach, double strength, double shellFrequency, double bodyFrequency) {
    releaseMouse();
    Impl& s = *impl_;
    s.dragTarget = at;
    if (b2Body* body = s.bodyAt(at)) {
        b2MouseJointDef def;
        def.bodyA = s.ground;
        def.bodyB = body;
        def.target = s.unitsOf(at);
        const double mass = static_cast<double>(body->GetMass());
        def.maxForce = static_cast<float>((strength > 0.0 ? strength : 1000.0 * mass) * units());
        b2LinearStiffness(def.stiffness, def.damping, static_cast<float>(bodyFrequency), 0.9F, s.ground, body);
        s.bodyJoint = static_cast<b2MouseJoint*>(s.world.CreateJoint(&def));
        body->SetAwake(true);
        ++s.drags;
        return true;
    }
    const auto near = s.shells.closest_point(at, reach);
    if (!near)
        return false;
    MouseJointDef def;
    def.arc_fraction = near->arc_fraction;
    def.target = at;
    def.frequency = shellFrequency;
    def.max_force = strength;
    const auto joint = s.shells.create_mouse_joint(near->shell, def);
    if (!joint)
        return false;
    s.mouseJoint = *joint;
    s.draggedShell = near->shell;
    s.draggedFraction = near->arc_fraction;
    ++s.drags;
    return true;
}

void GameWorld::moveMouse(Point to) {
    Impl& s = *impl_;
    s.dragTarget = to;
    if (!s.mouseJoint.null())
        (void)s.shells.set_target(s.mouseJoint, to); // it may be gone with its shell
    if (s.bodyJoint != nullptr)
        s.bodyJoint->SetTarget(s.unitsOf(to));
}

void GameWorld::releaseMouse() {
    Impl& s = *impl_;
    if (!s.mouseJoint.null())
        (void)s.shells.destroy(s.mouseJoint); // it may be gone with its shell
    s.mouseJoint = {};
    if (s.bodyJoint != nullptr)
        s.world.DestroyJoint(s.bodyJoint);
    s.bodyJoint = nullptr;
}

bool GameWorld::dragging() const {
    return impl_->bodyJoint != nullptr || !impl_->mouseJoint.null();
}

ShellHandle GameWorld::draggedShell() const {
    return impl_->mouseJoint.null() ? ShellHandle{} : impl_->draggedShell;
}

b2Body* GameWorld::draggedBody() const {
    return impl_->bodyJoint != nullptr ? impl_->bodyJoint->GetBodyB() : nullptr;
}

int GameWorld::dragCount() const {
    return impl_->drags;
}

Point GameWorld::dragPoint() const {
    const Impl& s = *impl_;
    if (s.bodyJoint != nullptr)
        return s.metres(s.bodyJoint->GetAnchorB());
    const auto section = s.shells.section(s.draggedShell, s.draggedFraction);
    return section ? section->position : s.dragTarget;
}

Point GameWorld::dragTarget() const {
    return impl_->dragTarget;
}

std::vector<BodyPose> GameWorld::bodies(double alpha) const {
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

std::vector<picture::Body> GameWorld::pieces(const BodyPose& pose) const {
    std::vector<picture::Body> out;
    const b2Transform x(b2Vec2(0.0F, 0.0F), b2Rot(static_cast<float>(pose.angle)));
    const auto place = [&](const b2Vec2& local) {
        const Point turned = impl_->metres(b2Mul(x, local));
        return picture::Point{pose.x + turned.x, pose.y + turned.y};
    };
    const bool loose = pose.body->GetType() == b2_dynamicBody;
    for (const b2Fixture* f = pose.body->GetFixtureList(); f != nullptr; f = f->GetNext()) {
        if (f->IsSensor())
            continue;
        picture::Body piece;
        piece.role = loose                                      ? picture::Role::Loose
                     : pose.body->GetType() == b2_kinematicBody ? picture::Role::Driven
                                                                : picture::Role::Still;
        piece.id = id(*pose.body);
        if (const auto* c = dynamic_cast<const b2CircleShape*>(f->GetShape())) {
            piece.points = {place(c->m_p)};
            piece.radius = static_cast<double>(c->m_radius) / units();
            if (loose && pose.body->GetFixtureList()->GetNext() == nullptr)
                piece.angle = pose.angle;
        } else if (const auto* p = dynamic_cast<const b2PolygonShape*>(f->GetShape())) {
            for (int i = 0; i < p->m_count; ++i)
                piece.points.push_back(place(p->m_vertices[i]));
        } else if (const auto* chain = dynamic_cast<const b2ChainShape*>(f->GetShape())) {
            piece.solid = false;
            for (int i = 0; i < chain->m_count; ++i)
                piece.points.push_back(place(chain->m_vertices[i]));
        } else if (const auto* e = dynamic_cast<const b2EdgeShape*>(f->GetShape())) {
            piece.solid = false;
            piece.points = {place(e->m_vertex1), place(e->m_vertex2)};
        }
        out.push_back(std::move(piece));
    }
    return out;
}

std::vector<picture::Shell> GameWorld::shellPictures(double alpha, double tolerance) const {
    return live::shellsOf(impl_->shells, alpha, tolerance);
}

std::vector<picture::SnapMark> GameWorld::snaps() {
    return impl_->snaps.at(impl_->shells);
}

std::span<const float> GameWorld::sound(double seconds) {
    return impl_->sound.make(impl_->shells, seconds);
}

std::vector<Point> GameWorld::line(ShellHandle shell, double alpha) const {
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
