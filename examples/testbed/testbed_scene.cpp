#include "examples/testbed/testbed_scene.h"

#include "supercircle/step/stepper.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace supercircle::testbed {

std::string Recorder::start(const std::string& film, int width, int height) {
    stop();
    std::string table = film;
    if (const std::size_t dot = table.rfind('.'); dot != std::string::npos)
        table.resize(dot);
    table += ".csv";
    table_.open(table);
    if (!table_)
        return table + ": cannot be written";
    table_ << "time_s,shell,x_m,y_m,angle_rad,curvatures_per_m\n";
    if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0)
        return "there is no ffmpeg: only the motion is recorded, in " + table;
    std::string quoted; // for the shell
    for (const char c : film)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    width_ = width & ~1; // yuv420p wants even sizes
    height_ = height & ~1;
    char command[256];
    std::snprintf(command, sizeof command,
                  "ffmpeg -loglevel error -y -f rawvideo -pix_fmt bgr0 -s %dx%d -r 60 -i - -pix_fmt yuv420p -- '",
                  width_, height_);
    film_ = popen((command + quoted + "'").c_str(), "w");
    return film_ != nullptr ? "" : film + ": ffmpeg cannot be started";
}

void Recorder::stop() {
    if (film_ != nullptr)
        pclose(film_);
    film_ = nullptr;
    if (table_.is_open())
        table_.close();
}

void Recorder::picture(const graphics::CairoCanvas& canvas) {
    const graphics::CairoCanvas::Pixels p = canvas.pixels();
    if (film_ == nullptr || p.data == nullptr)
        return;
    bool good = p.width >= width_ && p.height >= height_; // a window made smaller ends the film
    for (int y = 0; good && y < height_; ++y)
        good = std::fwrite(p.data + static_cast<std::ptrdiff_t>(y) * p.stride, 4, static_cast<std::size_t>(width_),
                           film_) == static_cast<std::size_t>(width_);
    if (!good)
        stop();
}

void Recorder::motion(const frame::GameWorld& world) {
    if (!table_.is_open())
        return;
    table_.precision(9);
    int number = 0;
    for (const ShellHandle shell : world.shells().shells()) {
        const auto pose = world.shells().pose(shell);
        if (!pose)
            continue;
        table_ << world.shells().time() << ',' << number++ << ',' << pose->start.x << ',' << pose->start.y << ','
               << pose->angle;
        for (const double k : pose->curvature)
            table_ << ',' << k;
        table_ << '\n';
    }
}

std::string TestbedScene::open() {
    auto world =
        frame::GameWorld::load(arguments_.scene, parameters_, arguments_.game ? Quality::Game : Quality::Laboratory);
    if (!world)
        return world.error();
    world_ = *world;
    curves_ = {};
    failure_.clear();
    saved_.reset();
    stageTimes_.clear();
    profile_.clear();
    for (int i = 0; i < static_cast<int>(step::Stage::Count); ++i)
        profile_.emplace_back(step::name(static_cast<step::Stage>(i)), 0.0);
    return {};
}

void TestbedScene::set(const std::string& parameter, double value) {
    for (auto& [name, old] : parameters_)
        if (name == parameter) {
            old = value;
            return;
        }
    parameters_.emplace_back(parameter, value);
}

void TestbedScene::step() {
    if (!failure_.empty())
        return;
    failure_ = world_->step().failure;
    const step::StageTimes& times = world_->shells().stepper().times();
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (stageTimes_.size() <= i)
            stageTimes_.push_back(times[i]);
        profile_[i].second += 0.05 * (1e3 * (times[i] - stageTimes_[i]) - profile_[i].second);
        stageTimes_[i] = times[i];
    }
    measure();
}

void TestbedScene::measure() {
    const EnergyBalance b = world_->shells().energy_balance();
    curves_.time.push_back(world_->shells().time());
    curves_.travel.push_back(world_->player().travel());
    curves_.force.push_back(world_->player().force());
    curves_.kinetic.push_back(b.kinetic);
    curves_.bending.push_back(b.bending);
    curves_.friction.push_back(b.friction);
    curves_.losses.push_back(b.impact + b.numerical);
}

void TestbedScene::save() {
    Saved s{world_->shells().save(), {}};
    for (const frame::BodyPose& pose : world_->bodies(1.0)) {
        const b2Body& b = *pose.body;
        const b2Vec2 v = b.GetLinearVelocity();
        s.bodies.push_back({static_cast<double>(b.GetPosition().x), static_cast<double>(b.GetPosition().y),
                            static_cast<double>(b.GetAngle()), static_cast<double>(v.x), static_cast<double>(v.y),
                            static_cast<double>(b.GetAngularVelocity())});
    }
    saved_ = std::move(s);
}

void TestbedScene::restore() {
    if (!saved_ || !world_->shells().restore(saved_->shells))
        return;
    const auto bodies = world_->bodies(1.0);
    for (std::size_t i = 0; i < bodies.size() && i < saved_->bodies.size(); ++i) {
        const auto f = [&](std::size_t k) { return static_cast<float>(saved_->bodies[i][k]); };
        bodies[i].body->SetTransform({f(0), f(1)}, f(2));
        bodies[i].body->SetLinearVelocity({f(3), f(4)});
        bodies[i].body->SetAngularVelocity(f(5));
    }
}

void TestbedScene::pushAway(Point at) {
    Shells& shells = world_->shells();
    for (const ShellHandle shell : shells.shells()) {
        const auto m = shells.state(shell);
        const auto near = shells.closest_point(shell, at);
        if (!m || !near)
            continue;
        const double reach = m->length, apart = std::hypot(near->point.x - at.x, near->point.y - at.y);
        if (apart > 2.0 * reach)
            continue;
        // At the centre: the speed of a fall through twice its own length.
        const double push = m->mass * std::sqrt(4.0 * 9.81 * reach) * std::exp(-apart / reach);
        const double d = std::hypot(m->centre.x - at.x, m->centre.y - at.y) + 1e-12;
        (void)shells.apply_impulse(
            shell, near->arc_fraction,
            {push * (m->centre.x - at.x) / d, push * (m->centre.y - at.y) / d}); // too strong a blow is left out
    }
    for (const frame::BodyPose& pose : world_->bodies(1.0))
        if (pose.body->GetType() == b2_dynamicBody) {
            const Point c = world_->position(*pose.body);
            const double d = std::hypot(c.x - at.x, c.y - at.y) + 1e-12;
            const double push = 5.0 * static_cast<double>(pose.body->GetMass()) * world_->units() * std::exp(-d);
            pose.body->ApplyLinearImpulseToCenter(
                {static_cast<float>(push * (c.x - at.x) / d), static_cast<float>(push * (c.y - at.y) / d)}, true);
        }
}

void TestbedScene::extent(Point& lower, Point& upper, bool shellsOnly) const {
    lower = {1e300, 1e300};
    upper = {-1e300, -1e300};
    const auto add = [&](double x, double y) {
        lower = {std::min(lower.x, x), std::min(lower.y, y)};
        upper = {std::max(upper.x, x), std::max(upper.y, y)};
    };
    for (const ShellHandle shell : world_->shells().shells())
        if (const auto m = world_->shells().state(shell)) {
            add(m->box.lower.x, m->box.lower.y);
            add(m->box.upper.x, m->box.upper.y);
        }
    const double u = world_->units();
    const bool bodies = !shellsOnly || !(lower.x < upper.x);
    for (const frame::BodyPose& pose : bodies ? world_->bodies(1.0) : std::vector<frame::BodyPose>{})
        for (const b2Fixture* f = pose.body->GetFixtureList(); f != nullptr; f = f->GetNext())
            for (int child = 0; child < f->GetShape()->GetChildCount(); ++child) {
                const b2AABB box = f->GetAABB(child);
                add(static_cast<double>(box.lowerBound.x) / u, static_cast<double>(box.lowerBound.y) / u);
                add(static_cast<double>(box.upperBound.x) / u, static_cast<double>(box.upperBound.y) / u);
            }
    if (!(lower.x < upper.x && lower.y < upper.y)) {
        lower = {-1, -1};
        upper = {1, 1};
    }
    const double pad = 0.04 * std::max(upper.x - lower.x, upper.y - lower.y);
    lower = {lower.x - pad, lower.y - pad};
    upper = {upper.x + pad, upper.y + pad};
}

} // namespace supercircle::testbed
