// Lander: a craft on two snap-fit legs. Each leg is a shell that hangs on two strings under a peg of the craft, its
// opening up. A landing pushes the peg into it: it opens, slides, snaps shut around the peg and absorbs energy once. A
// second landing on a spent leg is hard. On the service pad clamps hold spent legs, and the craft can pull its pegs
// off.

#include "examples/games/frame/felt_acceleration.h"
#include "examples/games/frame/game.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace supercircle::frame {

namespace {

constexpr double kSpent = 1.35;     ///< of the radius: peg nearer than this to the middle of its leg: spent ...
constexpr double kArmed = 2.15;     ///< ... farther: armed again
constexpr double kClearance = 0.02; ///< m, between peg and tips at the start
constexpr double kSide = 0.35;      ///< side jets over main thrust
constexpr double kRest = 0.2;       ///< m/s

struct LandingLeg {
    b2Vec2 peg{};        ///< in the craft's frame
    double radius = 0.0; ///< of the peg, m
    ShellHandle shell{};
    std::array<JointHandle, 2> strings{};
    std::array<Point, 2> tied{}; ///< on the craft, its frame, m
    HoldHandle clamp{};
    bool spent = false;
};

class Lander final : public Game {
public:
    std::string start(GameWorld& world) override {
        const scene::Game& level = world.game();
        craft_ = world.body(level.actor);
        for (const b2Fixture* f = craft_->GetFixtureList(); f != nullptr; f = f->GetNext())
            if (const auto* c = dynamic_cast<const b2CircleShape*>(f->GetShape()))
                legs_.push_back({c->m_p, static_cast<double>(c->m_radius)});
        if (legs_.size() != 2)
            return "the craft needs two circles, the pegs of its legs";
        for (LandingLeg& leg : legs_)
            if (std::string why = hang(world, leg); !why.empty())
                return why;
        fuel_ = level.fuel;
        acceleration_.reset(world.velocity(*craft_));
        return {};
    }

    void beforeStep(GameWorld& world, const Input& input) override {
        const scene::Game& level = world.game();
        const double angle = static_cast<double>(craft_->GetAngle()),
                     spin = static_cast<double>(craft_->GetAngularVelocity());
        const double inertia = static_cast<double>(craft_->GetInertia());
        world.push(*craft_, {level.wind, 0.0}, inertia * (-14.0 * angle - 6.0 * spin)); // a gyroscope keeps it upright
        main_ = input.held("up") && fuel_ > 0.0;
        side_ = fuel_ > 0.0 ? (input.held("right") ? 1.0 : 0.0) - (input.held("left") ? 1.0 : 0.0) : 0.0;
        if (main_)
            world.push(*craft_, {-level.thrust * std::sin(angle), level.thrust * std::cos(angle)});
        if (side_ != 0.0)
            world.push(*craft_, {kSide * side_ * level.thrust, 0.0});
        fuel_ = std::max(0.0, fuel_ - kStep * ((main_ ? 1.0 : 0.0) + kSide * std::abs(side_)));
    }

    void afterStep(GameWorld& world) override {
        const scene::Game& level = world.game();
        for (LandingLeg& leg : legs_)
            update(world, leg);
        acceleration_.step(world.velocity(*craft_));
        if (acceleration_.hardest() > level.limit)
            return end(GameResult::Lost,
                       "A hard landing: " + number(acceleration_.hardest(), 1) + " g, the crew bears " +
                           number(level.limit, 0),
                       0);
        const Point at = world.position(*craft_), v = world.velocity(*craft_);
        if (at.y < level.viewLower.y - 1.0 || at.x < level.viewLower.x - 2.0 || at.x > level.viewUpper.x + 2.0)
            return end(GameResult::Lost, "Lost in space", 0);
        if (world.time() > level.time)
            return end(GameResult::Lost, "The time is up", 0);
        if (std::abs(craft_->GetAngle()) > 1.2F)
            return end(GameResult::Lost, "Tipped over", 0);
        const bool there = at.x > level.goalLower.x && at.x < level.goalUpper.x && at.y > level.goalLower.y &&
                           at.y < level.goalUpper.y;
        still_ = there && std::hypot(v.x, v.y) < kRest ? still_ + kStep : 0.0;
        if (still_ > level.hold)
            end(GameResult::Won,
                "Landed with " + number(acceleration_.hardest(), 1) + " g and " + number(fuel_, 1) + " s of fuel left",
                static_cast<int>(
                    std::lround(100.0 * (1.0 + fuel_ / level.fuel) * (2.0 - acceleration_.hardest() / level.limit))));
    }

    void draw(const GameWorld& world, const View& view, double alpha) const override {
        const scene::Game& level = world.game();
        view.area(level.goalLower, level.goalUpper, look::good, "land here");
        for (const LandingLeg& leg : legs_)
            for (int i = 0; i < 2; ++i)
                if (const auto tip = world.shells().section(leg.shell, i))
                    view.line(toWorld(leg.tied[static_cast<std::size_t>(i)]), tip->position, look::muted, 1.5);
        flames(view);
        const b2Body* service = world.body(level.service);
        view.bodies(world, alpha, [&](const b2Body& b) {
            return &b == service  ? Style{look::driven, look::drivenEdge}
                   : &b == craft_ ? Style{look::loose, look::looseEdge}
                                  : Style{};
        });
        view.shells(world, alpha, [&](ShellHandle s) {
            const bool spent =
                std::any_of(legs_.begin(), legs_.end(), [&](const LandingLeg& l) { return l.shell == s && l.spent; });
            return spent ? look::bad : Colour::hex(world.colour(s));
        });
        for (const LandingLeg& leg : legs_)
            if (!leg.clamp.null())
                if (const auto middle = world.shells().section(leg.shell, 0.5))
                    view.disc(middle->position, 0.09, {look::accent, look::ink});
        if (level.wind != 0.0)
            drawWind(view, level);
    }

    std::vector<StatusEntry> status(const GameWorld& world) const override {
        const Point v = world.velocity(*craft_);
        const auto spent = std::count_if(legs_.begin(), legs_.end(), [](const LandingLeg& l) { return l.spent; });
        const scene::Game& level = world.game();
        return {{"fuel", number(fuel_, 1) + " s", fuel_ < 0.25 * level.fuel ? look::bad : look::ink},
                {"sinking", number(-v.y, 1) + " m/s", v.y < -4.5 ? look::bad : look::ink},
                {"felt", number(acceleration_.hardest(), 1) + " / " + number(level.limit, 0) + " g"},
                {"legs", spent == 0 ? "armed" : std::to_string(spent) + " spent", spent == 0 ? look::good : look::bad},
                {"time", number(level.time - world.time(), 0) + " s"}};
    }
    std::string hint(const GameWorld& world) const override {
        if (std::any_of(legs_.begin(), legs_.end(), [](const LandingLeg& l) { return !l.clamp.null(); }))
            return "The clamp holds the spent legs: full thrust pulls the craft off them, and they are armed again.";
        return world.game().hint.empty() ? "Up: main engine, left and right: jets. The legs absorb one landing."
                                         : world.game().hint;
    }
    std::vector<std::pair<std::string, std::string>> help() const override {
        return {{"up", "main engine"}, {"left, right", "side jets"}};
    }
    DragSettings dragSettings() const override { return {.allowed = false}; }

private:
    [[nodiscard]] Point toWorld(Point p) const {
        const b2Vec2 w = craft_->GetWorldPoint({static_cast<float>(p.x), static_cast<float>(p.y)});
        return {static_cast<double>(w.x), static_cast<double>(w.y)};
    }
    [[nodiscard]] Point pegOf(const LandingLeg& leg) const {
        return toWorld({static_cast<double>(leg.peg.x), static_cast<double>(leg.peg.y)});
    }

    /// Hangs an armed leg under its peg: tips at the peg's flanks, strings from the craft to the tips.
    std::string hang(GameWorld& world, LandingLeg& leg) {
        const scene::GamePart& part = world.game().parts.front();
        const double phi = M_PI * part.phi_bar, r = part.radius, reach = leg.radius + kClearance + 0.013 * r;
        if (r * std::sin(phi) > reach)
            return "the pegs are smaller than the opening of the legs";
        // Distance of the two centres with both tips `reach` away from the peg's centre, above the leg's own.
        const double apart = -r * std::cos(phi) + std::sqrt(reach * reach - std::pow(r * std::sin(phi), 2));
        const Point peg = pegOf(leg);
        const auto shell = world.add(part, {peg.x, peg.y - apart - r}, 0.0);
        if (!shell)
            return "leg: " + shell.error();
        leg.shell = *shell;
        for (int i = 0; i < 2; ++i) {
            const auto tip = world.shells().section(*shell, i);
            const double side = tip->position.x > peg.x ? 1.0 : -1.0;
            const auto k = static_cast<std::size_t>(i);
            const Point tie{peg.x + side * 1.15 * r, peg.y + 0.9 * r};
            const b2Vec2 local = craft_->GetLocalPoint({static_cast<float>(tie.x), static_cast<float>(tie.y)});
            leg.tied[k] = {static_cast<double>(local.x), static_cast<double>(local.y)};
            JointDef def;
            def.kind = JointKind::Tether;
            def.shell = *shell;
            def.arc_fraction = i;
            def.body = world.id(*craft_);
            def.point = tie;
            def.collide_connected = true;
            const auto string = world.shells().create_joint(def);
            if (!string)
                return "string: " + string.error();
            leg.strings[k] = *string;
        }
        return {};
    }

    /// Updates the state of a leg. On the service pad spent legs are clamped and armed ones released.
    void update(GameWorld& world, LandingLeg& leg) {
        const auto middle = world.shells().section(leg.shell, 0.5);
        if (!middle)
            return;
        const Point peg = pegOf(leg);
        const double r = world.game().parts.front().radius;
        const double apart = std::hypot(middle->position.x - peg.x, middle->position.y - peg.y);
        if (apart < kSpent * r)
            leg.spent = true;
        if (apart > kArmed * r)
            leg.spent = false;
        const b2Body* service = world.body(world.game().service);
        if (leg.spent && leg.clamp.null() && service != nullptr && onService(middle->position, *service))
            if (const auto clamp = world.shells().create_clamp(leg.shell, 0.5))
                leg.clamp = *clamp;
        if (!leg.spent && !leg.clamp.null()) {
            (void)world.shells().destroy(leg.clamp); // it may be gone with its shell
            leg.clamp = {};
        }
    }

    /// The middle of a leg stands on the pad.
    static bool onService(Point p, const b2Body& pad) {
        for (const b2Fixture* f = pad.GetFixtureList(); f != nullptr; f = f->GetNext())
            if (f->TestPoint({static_cast<float>(p.x), static_cast<float>(p.y - 0.08)}))
                return true;
        return false;
    }

    void flames(const View& view) const {
        const Colour hot = Colour::hex(0xf08a24), warm = Colour::hex(0xf9c74f);
        if (main_)
            for (const double w : {1.0, 0.55})
                view.canvas().path({view.pixel(toWorld({-0.32 * w, -0.6})), view.pixel(toWorld({0.32 * w, -0.6})),
                                    view.pixel(toWorld({0.0, -0.6 - 1.1 * w}))},
                                   true, {.fill = w > 0.9 ? hot : warm});
        if (side_ != 0.0)
            view.canvas().path({view.pixel(toWorld({-1.2 * side_, 0.12})), view.pixel(toWorld({-1.2 * side_, -0.12})),
                                view.pixel(toWorld({-1.9 * side_, 0.0}))},
                               true, {.fill = hot});
    }

    static void drawWind(const View& view, const scene::Game& level) {
        const double sign = level.wind > 0.0 ? 1.0 : -1.0;
        const double y = level.viewUpper.y - 0.8, x = level.viewLower.x + 3.0;
        for (int i = 0; i < 3; ++i) {
            const double xi = x + 2.2 * i;
            view.line({xi, y}, {xi + 1.5 * sign, y}, look::accent, 2.0);
            view.line({xi + 1.5 * sign, y}, {xi + 1.1 * sign, y + 0.22}, look::accent, 2.0);
            view.line({xi + 1.5 * sign, y}, {xi + 1.1 * sign, y - 0.22}, look::accent, 2.0);
        }
        view.label({x + 2.9, y + 0.4}, "wind " + number(std::abs(level.wind), 0) + " N", look::accent, 13.0);
    }

    b2Body* craft_ = nullptr;
    std::vector<LandingLeg> legs_;
    FeltAcceleration acceleration_;
    double fuel_ = 0.0, still_ = 0.0, side_ = 0.0;
    bool main_ = false;
};

} // namespace

} // namespace supercircle::frame

int main(int argc, char** argv) {
    using namespace supercircle::frame;
    return run(argc, argv, {"lander", "Lander", {"lander_1.json", "lander_2.json", "lander_3.json"}, [] {
                                return std::make_unique<Lander>();
                            }});
}
