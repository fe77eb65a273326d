// Clip: carry a load across a gap with double clips - two shells back to back. The upper one snaps onto the carrier's
// peg (or onto a shell that hangs there), the lower one around the peg of the load. Smooth clips (Type I) slide on and
// off; abrupt ones (Type II) refuse, snap, and hold.

#include "examples/games/frame/game.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

namespace {

constexpr double kDragForce = 900.0; ///< N, largest force of the mouse
constexpr double kReach = 0.35;      ///< m, largest distance of a click from a shell
constexpr double kSpring = 6.0;      ///< Hz, of the mouse joint
constexpr double kRamp = 1.5;        ///< s, in which the carrier accelerates and brakes

struct DoubleClip {
    ShellHandle upper{}, lower{};
    std::string name;
};

class Clip final : public Game {
public:
    std::string start(GameWorld& world) override {
        const scene::Game& level = world.game();
        load_ = world.body(level.actor);
        carrier_ = world.body(level.carrier);
        if (!peg(*load_, loadPeg_))
            return "the load has no circle, the peg to clip it by";
        if (!peg(*carrier_, carrierPeg_))
            if (std::string why = hangShell(world); !why.empty())
                return why;
        double x = level.viewLower.x + 1.5;
        for (const scene::GamePart& part : level.parts) {
            const Point at = part.at.value_or(Point{x, level.viewLower.y + 3.0});
            x += 2.5 * part.radius;
            if (std::string why = make(world, part, at); !why.empty())
                return why;
        }
        goalX_ = 0.5 * (level.goalLower.x + level.goalUpper.x);
        startX_ = world.position(*carrier_).x;
        return {};
    }

    void beforeStep(GameWorld& world, const Input& input) override {
        keepUpright(world);
        if (input.pressed("space") || input.pressed("enter"))
            going_ = true;
        drive(world);
    }

    void afterStep(GameWorld& world) override {
        const scene::Game& level = world.game();
        for (const auto& snap : world.shells().events().snap_end)
            released_ += snap.energy_released;
        snaps_ += static_cast<int>(world.shells().events().snap_end.size());
        const Point at = world.position(*load_);
        if (at.y < level.viewLower.y - 0.5)
            return end(GameResult::Lost, "The load fell into the gap", 0);
        if (world.time() > level.time)
            return end(GameResult::Lost, "The time is up", 0);
        const bool there = at.x > level.goalLower.x && at.x < level.goalUpper.x && at.y > level.goalLower.y &&
                           at.y < level.goalUpper.y && !world.dragging();
        stay_ = there ? stay_ + kStep : 0.0;
        if (stay_ > level.hold)
            end(GameResult::Won, "Carried across in " + number(world.time(), 1) + " s",
                static_cast<int>(std::lround(200.0 + 10.0 * (level.time - world.time()))));
    }

    void draw(const GameWorld& world, const View& view, double alpha) const override {
        const scene::Game& level = world.game();
        view.area(level.goalLower, level.goalUpper, look::good, "bring it here");
        const Point c = world.position(*carrier_);
        view.line({startX_, c.y + 0.75}, {goalX_, c.y + 0.75}, look::rule, 6.0);
        view.line({c.x, c.y + 0.75}, c, look::drivenEdge, 5.0);
        view.bodies(world, alpha);
        view.shells(world, alpha);
        for (const DoubleClip& clip : clips_)
            if (const auto middle = world.shells().section(clip.upper, 0.5))
                view.disc(middle->position, 0.07, {look::strip, look::ink});
        double y = look::top + 18.0;
        for (const scene::GamePart& p : level.parts) {
            Canvas& canvas = view.canvas();
            canvas.rectangle({18.0, y, 330.0, 28.0},
                             {.fill = look::strip, .stroke = graphics::Stroke{look::rule, 1.0}});
            canvas.rectangle({26.0, y + 7.0, 14.0, 14.0}, {.fill = Colour::hex(p.colour)});
            canvas.text({50.0, y + 19.0}, p.name, {.size = 14.0, .colour = look::ink, .bold = true});
            canvas.text({336.0, y + 19.0},
                        number(360.0 * p.phi_bar, 0) + "\u00b0   mu " + number(p.mu, 2) + "   stiffness " +
                            number(p.stiffness, 1),
                        {.size = 12.0, .colour = look::muted, .anchor = graphics::Anchor::End});
            y += 32.0;
        }
    }

    std::vector<StatusEntry> status(const GameWorld& world) const override {
        const double weight = 9.81 * static_cast<double>(load_->GetMass());
        return {{"load", number(weight, 0) + " N"},
                {"snaps", std::to_string(snaps_)},
                {"released", number(released_, 0) + " J"},
                {"carrier", going_ ? "on its way" : "waiting"},
                {"time", number(world.game().time - world.time(), 0) + " s"}};
    }
    std::string hint(const GameWorld& world) const override {
        if (going_)
            return "Hold on ...";
        return world.game().hint.empty() ? "Drag a clip onto the carrier, the load into the clip, then Space."
                                         : world.game().hint;
    }
    std::vector<std::pair<std::string, std::string>> help() const override {
        return {{"drag", "clips and load"}, {"space", "the carrier goes"}};
    }
    DragSettings dragSettings() const override { return {true, kReach, kDragForce, kSpring, 0.5 * kSpring}; }

private:
    /// The circle of a body.
    static bool peg(const b2Body& body, Point& out) {
        for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
            if (const auto* c = dynamic_cast<const b2CircleShape*>(f->GetShape())) {
                out = {static_cast<double>(c->m_p.x), static_cast<double>(c->m_p.y)};
                return true;
            }
        return false;
    }

    /// Turns the dragged clip or load upright with a spring and a damper of some hertz.
    void keepUpright(GameWorld& world) {
        constexpr double kStiff = 250.0, kDamp = 24.0; // 1/s^2, 1/s
        if (world.draggedBody() == load_) {
            const double turn = std::remainder(static_cast<double>(load_->GetAngle()), 2.0 * M_PI);
            const double spin = static_cast<double>(load_->GetAngularVelocity());
            world.push(*load_, {}, -0.3 * static_cast<double>(load_->GetInertia()) * (kStiff * turn + kDamp * spin));
        }
        for (const DoubleClip& clip : clips_) {
            if (world.draggedShell() != clip.upper && world.draggedShell() != clip.lower)
                continue;
            const auto middle = world.shells().section(clip.upper, 0.5);
            const auto shell = world.shells().state(clip.upper);
            if (!middle || !shell)
                continue;
            const double inertia = 2.0 * shell->mass * std::pow(0.25 * shell->length, 2);
            const double turn = std::remainder(middle->angle, 2.0 * M_PI);
            // A refused torque is one frame without help.
            (void)world.shells().apply_torque(clip.upper, 0.5, -inertia * (kStiff * turn + kDamp * middle->spin));
        }
    }

    /// Welds the level's first shell to a carrier without a peg; clips snap onto it.
    std::string hangShell(GameWorld& world) {
        if (world.shells().shells().empty())
            return "the carrier has no circle, and there is no shell to hang on it";
        JointDef weld;
        weld.shell = world.shells().shells().front();
        weld.body = world.id(*carrier_);
        const auto joint = world.shells().create_joint(weld);
        return joint ? "" : "carrier: " + joint.error();
    }

    /// Two shells back to back, their middles welded together at `at`.
    std::string make(GameWorld& world, const scene::GamePart& part, Point at) {
        const double half = 0.52 * scaled_shell(part.radius, part.mass).thickness;
        const auto upper = world.add(part, {at.x, at.y + half}, 0.0);
        const auto lower = world.add(part, {at.x, at.y - half}, M_PI);
        if (!upper || !lower)
            return part.name + ": " + (upper ? lower.error() : upper.error());
        JointDef weld;
        weld.shell = *upper;
        weld.other = *lower;
        if (const auto joint = world.shells().create_joint(weld); !joint)
            return part.name + ": " + joint.error();
        clips_.push_back({*upper, *lower, part.name});
        return {};
    }

    /// Moves the carrier with smooth acceleration and braking, so that the load swings little.
    void drive(GameWorld& world) {
        double v = 0.0;
        if (going_) {
            const double way = std::abs(goalX_ - startX_), top = world.game().speed;
            const double gone = std::abs(world.position(*carrier_).x - startX_), left = way - gone;
            ramp_ = std::min(1.0, ramp_ + kStep / kRamp);
            const double stop = std::sqrt(std::max(0.0, 2.0 * left * top / kRamp));
            v = std::min({ramp_ * top, stop, left / kStep}) * (goalX_ > startX_ ? 1.0 : -1.0);
        }
        carrier_->SetLinearVelocity({static_cast<float>(v), 0.0F});
    }

    b2Body* load_ = nullptr;
    b2Body* carrier_ = nullptr;
    Point loadPeg_{}, carrierPeg_{};
    std::vector<DoubleClip> clips_;
    bool going_ = false;
    int snaps_ = 0;
    double goalX_ = 0.0, startX_ = 0.0, ramp_ = 0.0, stay_ = 0.0, released_ = 0.0;
};

} // namespace

} // namespace supercircle::frame

int main(int argc, char** argv) {
    using namespace supercircle::frame;
    return run(argc, argv, {"clip", "Clip", {"clip_1.json", "clip_2.json", "clip_3.json"}, [] {
                                return std::make_unique<Clip>();
                            }});
}
