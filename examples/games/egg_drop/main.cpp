// Egg drop: fill a crate with shells, then let the egg fall on them from rising heights. The
// largest acceleration of the egg decides. Bars show where its energy goes.

#include "examples/games/frame/felt_acceleration.h"
#include "examples/games/frame/game.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

namespace {

constexpr double kG = FeltAcceleration::kG;
constexpr double kRest = 0.15;     ///< m/s: an egg slower than this is at rest ...
constexpr int kRestSteps = 30;     ///< ... after so many steps
constexpr int kLongestFall = 480;  ///< steps of a drop at most
constexpr int kBetweenShells = 12; ///< steps between two shells, so that they do not overlap at the start

class EggDrop final : public Game {
public:
    std::string start(GameWorld& world) override {
        egg_ = world.body(world.game().actor);
        const b2Fixture* f = egg_->GetFixtureList();
        const auto* circle = f != nullptr ? dynamic_cast<const b2CircleShape*>(f->GetShape()) : nullptr;
        if (circle == nullptr)
            return "the egg has to be a circle";
        money_ = world.game().budget;
        radius_ = static_cast<double>(circle->m_radius);
        raise();
        return {};
    }

    void beforeStep(GameWorld& world, const Input& input) override {
        const auto& parts = world.game().parts;
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (input.pressed(std::to_string(i + 1)))
                chosen_ = i;
        aim_ = input.mouse();
        if (falling_)
            return;
        --wait_;
        if ((input.clicked() || input.pressed("space")) && wait_ <= 0)
            buy(world, parts[chosen_]);
        if (input.pressed("enter"))
            release(world);
    }

    void afterStep(GameWorld& world) override {
        for (const auto& snap : world.shells().events().snap_end)
            snaps_ += snap.energy_released;
        snapCount_ += static_cast<int>(world.shells().events().snap_end.size());
        const scene::Game& level = world.game();
        if (!falling_) {
            balanceBefore_ = world.shells().energy_balance(); // the bars start with the fall
            snaps_ = 0.0;
            snapCount_ = 0;
            if (world.time() > level.time)
                end(GameResult::Lost, "The time is up: the egg went cold", 0);
            return;
        }
        acceleration_.step(world.velocity(*egg_));
        felt_ = acceleration_.hardest();
        hardest_ = std::max(hardest_, felt_);
        if (felt_ > level.limit)
            return end(GameResult::Lost,
                       "The egg broke: " + number(felt_, 1) + " g, it survives " + number(level.limit, 0), 0);
        const Point at = world.position(*egg_), v = world.velocity(*egg_);
        if (at.y < -3.0 || std::abs(at.x) > 12.0)
            return end(GameResult::Lost, "The egg jumped out of the crate", 0);
        ++steps_;
        still_ = std::hypot(v.x, v.y) < kRest ? still_ + 1 : 0;
        if (still_ < kRestSteps && steps_ < kLongestFall)
            return;
        points_ += static_cast<int>(std::lround(100.0 * level.heights[drop_] * (1.5 - felt_ / level.limit)));
        if (++drop_ < level.heights.size())
            return raise();
        points_ += static_cast<int>(std::lround(50.0 * money_));
        end(GameResult::Won,
            "Whole after " + std::to_string(drop_) + " drops, hardest landing " + number(hardest_, 1) + " g", points_);
    }

    void draw(const GameWorld& world, const View& view, double alpha) const override {
        const scene::Game& level = world.game();
        const double top = level.heights[std::min(drop_, level.heights.size() - 1)];
        const double left = level.viewLower.x + 0.55 * (level.viewUpper.x - level.viewLower.x);
        for (std::size_t i = 0; i < level.heights.size(); ++i) {
            const double y = level.heights[i];
            const Colour c = i < drop_ ? look::good : i == drop_ ? look::accent : look::muted;
            view.line({left - 4.6, y}, {left + 2.6, y}, c, 1.5, true);
            view.label({left + 3.1, y}, number(y, 1) + " m", c, 14.0);
        }
        view.bodies(world, alpha, [&](const b2Body& b) {
            return &b == egg_                     ? eggStyle()
                   : b.GetType() == b2_staticBody ? Style{}
                                                  : Style{look::loose, look::looseEdge};
        });
        view.shells(world, alpha);
        if (!falling_) {
            view.disc({dropX_, top + radius_}, radius_, eggStyle());
            const auto& part = level.parts[chosen_];
            if (wait_ <= 0 && part.cost <= money_ + 1e-9)
                drawGhost(view, part, spawnX(), spawnHeight(world));
        }
        palette(view, level);
        const EnergyBalance b = world.shells().energy_balance();
        drawEnergy(view, 18.0, look::top + 60.0 + 34.0 * static_cast<double>(level.parts.size()),
                   "Where the energy went",
                   {{"egg", energyOfEgg(world)},
                    {"bending", b.bending - balanceBefore_.bending},
                    {"shells move", b.kinetic + b.gravity - balanceBefore_.kinetic - balanceBefore_.gravity},
                    {"friction", b.friction - balanceBefore_.friction},
                    {"impact", b.impact - balanceBefore_.impact},
                    {"damping", b.damping + b.numerical - balanceBefore_.damping - balanceBefore_.numerical},
                    {"snaps", snaps_}},
                   {look::looseEdge, look::accent, Colour::hex(0x6fb1d8), look::bad, look::muted, look::rule,
                    Colour::hex(0x8b5fbf)});
    }

    std::vector<StatusEntry> status(const GameWorld& world) const override {
        const scene::Game& level = world.game();
        const Colour c = felt_ > 0.8 * level.limit ? look::bad : look::ink;
        return {{"budget", number(money_, 0)},
                {"drop", std::to_string(std::min(drop_ + 1, level.heights.size())) + " of " +
                             std::to_string(level.heights.size())},
                {"felt", number(felt_, 1) + " / " + number(level.limit, 0) + " g", c},
                {"snaps", std::to_string(snapCount_)},
                {"points", std::to_string(result() == GameResult::Playing ? points_ : score())}};
    }
    std::string hint(const GameWorld& world) const override {
        if (falling_)
            return "Watch: what the egg feels while it lands must stay below the limit.";
        return world.game().hint.empty() ? "Click to drop shells into the crate, Enter lets the egg fall."
                                         : world.game().hint;
    }
    std::vector<std::pair<std::string, std::string>> help() const override {
        return {{"1 - 9", "choose a kind of shell"},
                {"click, space", "drop one below the mouse"},
                {"Enter", "let the egg fall"}};
    }
    DragSettings dragSettings() const override { return {.allowed = false}; }

private:
    static Style eggStyle() { return {Colour::hex(0xfdf3e1), Colour::hex(0xb07d3c)}; }
    [[nodiscard]] double spawnX() const { return std::clamp(aim_.x, -1.35, 1.35); }
    /// Above everything that lies in the crate.
    [[nodiscard]] double spawnHeight(const GameWorld& world) const {
        double top = 1.0;
        for (const ShellHandle s : world.shells().shells())
            if (const auto m = world.shells().state(s))
                top = std::max(top, m->box.upper.y);
        return top + 0.9;
    }

    void buy(GameWorld& world, const scene::GamePart& part) {
        if (part.cost > money_ + 1e-9)
            return;
        // Every shell has another angle. Its position is that of its middle; the mouse points at the centre of its
        // circle.
        const double angle = M_PI - 2.7 + 0.9 * static_cast<double>(bought_ % 7);
        const Point middle{spawnX() + part.radius * std::sin(angle),
                           spawnHeight(world) - part.radius * std::cos(angle)};
        if (!world.add(part, middle, angle))
            return;
        money_ -= part.cost;
        ++bought_;
        wait_ = kBetweenShells;
    }

    /// Takes the egg out of the world until it falls again.
    void raise() {
        falling_ = false;
        wait_ = 0;
        dropX_ = 0.0;

        egg_->SetEnabled(false);
    }

    void release(GameWorld& world) {
        const double y = world.game().heights[drop_] + radius_;
        egg_->SetTransform({static_cast<float>(dropX_), static_cast<float>(y)}, 0.0F);
        egg_->SetLinearVelocity({0.0F, 0.0F});
        egg_->SetAngularVelocity(0.0F);
        egg_->SetEnabled(true);
        egg_->SetAwake(true);
        falling_ = true;
        steps_ = still_ = snapCount_ = 0;
        felt_ = snaps_ = 0.0;
        acceleration_.reset({0.0, 0.0});
        balanceBefore_ = world.shells().energy_balance();
    }

    [[nodiscard]] double energyOfEgg(const GameWorld& world) const {
        if (!falling_)
            return static_cast<double>(egg_->GetMass()) * kG *
                   world.game().heights[std::min(drop_, world.game().heights.size() - 1)];
        const Point v = world.velocity(*egg_), at = world.position(*egg_);
        const double m = static_cast<double>(egg_->GetMass());
        return m * (0.5 * (v.x * v.x + v.y * v.y) + kG * std::max(0.0, at.y - radius_));
    }

    void drawGhost(const View& view, const scene::GamePart& part, double x, double y) const {
        std::vector<Point> line;
        for (int i = 0; i <= 32; ++i) {
            const double a = 0.5 * M_PI + 2.0 * M_PI * part.phi_bar * (i / 32.0 - 0.5);
            line.push_back({x + part.radius * std::cos(a), y + part.radius * std::sin(a)});
        }
        view.ghost(line, Colour::hex(part.colour, 0.45));
    }

    void palette(const View& view, const scene::Game& level) const {
        Canvas& c = view.canvas();
        for (std::size_t i = 0; i < level.parts.size(); ++i) {
            const scene::GamePart& p = level.parts[i];
            const double y = look::top + 18.0 + 34.0 * static_cast<double>(i);
            const Colour edge = i == chosen_ ? look::accent : look::rule;
            c.rectangle({18.0, y, 300.0, 30.0},
                        {.fill = look::strip, .stroke = graphics::Stroke{edge, i == chosen_ ? 2.5 : 1.0}});
            c.rectangle({26.0, y + 8.0, 14.0, 14.0}, {.fill = Colour::hex(p.colour)});
            c.text({50.0, y + 20.0}, std::to_string(i + 1) + "  " + p.name,
                   {.size = 14.0, .colour = look::ink, .bold = true});
            c.text({306.0, y + 20.0},
                   number(360.0 * p.phi_bar, 0) + "\u00b0  mu " + number(p.mu, 2) + "  costs " + number(p.cost, 0),
                   {.size = 12.0, .colour = look::muted, .anchor = graphics::Anchor::End});
        }
    }

    b2Body* egg_ = nullptr;
    double money_ = 0.0, radius_ = 0.4, dropX_ = 0.0;
    std::size_t chosen_ = 0, drop_ = 0;
    int bought_ = 0, wait_ = 0, steps_ = 0, still_ = 0, snapCount_ = 0, points_ = 0;
    bool falling_ = false;
    double felt_ = 0.0, hardest_ = 0.0, snaps_ = 0.0;
    Point aim_{};
    FeltAcceleration acceleration_;
    EnergyBalance balanceBefore_{};
};

} // namespace

} // namespace supercircle::frame

int main(int argc, char** argv) {
    using namespace supercircle::frame;
    return run(argc, argv, {"egg_drop", "Egg drop", {"egg_drop_1.json", "egg_drop_2.json", "egg_drop_3.json"}, [] {
                                return std::make_unique<EggDrop>();
                            }});
}
