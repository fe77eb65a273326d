// Egg drop: fill a crate with shells, then let the egg fall on them from rising heights. What the egg feels decides;
// the bars show where its energy went.

#include "examples/games/frame/feel.h"
#include "examples/games/frame/game.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

namespace {

constexpr double kG = Feel::kG;
constexpr double kRest = 0.15;     ///< m/s: a bed or an egg slower than this is at rest ...
constexpr int kRestSteps = 30;     ///< ... after so many steps
constexpr int kLongestFall = 480;  ///< steps a drop is watched at most
constexpr int kBetweenShells = 12; ///< steps between two shells, so that they do not start in each other

class EggDrop final : public Game {
public:
    std::string start(Stage& stage) override {
        egg_ = stage.body(stage.game().actor);
        const b2Fixture* f = egg_->GetFixtureList();
        const auto* circle = f != nullptr ? dynamic_cast<const b2CircleShape*>(f->GetShape()) : nullptr;
        if (circle == nullptr)
            return "the egg has to be a circle";
        money_ = stage.game().budget;
        radius_ = static_cast<double>(circle->m_radius);
        raise();
        return {};
    }

    void control(Stage& stage, const Input& input) override {
        const auto& parts = stage.game().parts;
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (input.pressed(std::to_string(i + 1)))
                chosen_ = i;
        aim_ = input.mouse();
        if (falling_)
            return;
        --wait_;
        if ((input.clicked() || input.pressed("space")) && wait_ <= 0)
            buy(stage, parts[chosen_]);
        if (input.pressed("enter"))
            release(stage);
    }

    void judge(Stage& stage) override {
        for (const auto& snap : stage.shells().events().snap_end)
            snaps_ += snap.energy_released;
        snapCount_ += static_cast<int>(stage.shells().events().snap_end.size());
        const scene::Game& level = stage.game();
        if (!falling_) {
            books_ = stage.shells().books(); // the bars count from the fall on
            snaps_ = 0.0;
            snapCount_ = 0;
            if (stage.time() > level.time)
                end(Verdict::Lost, "The time is up: the egg went cold", 0);
            return;
        }
        feel_.step(stage.velocity(*egg_));
        felt_ = feel_.hardest();
        hardest_ = std::max(hardest_, felt_);
        if (felt_ > level.limit)
            return end(Verdict::Lost,
                       "The egg broke: " + number(felt_, 1) + " g, it survives " + number(level.limit, 0), 0);
        const Point at = stage.position(*egg_), v = stage.velocity(*egg_);
        if (at.y < -3.0 || std::abs(at.x) > 12.0)
            return end(Verdict::Lost, "The egg jumped out of the crate", 0);
        ++steps_;
        still_ = std::hypot(v.x, v.y) < kRest ? still_ + 1 : 0;
        if (still_ < kRestSteps && steps_ < kLongestFall)
            return;
        points_ += static_cast<int>(std::lround(100.0 * level.heights[drop_] * (1.5 - felt_ / level.limit)));
        if (++drop_ < level.heights.size())
            return raise();
        points_ += static_cast<int>(std::lround(50.0 * money_));
        end(Verdict::Won,
            "Whole after " + std::to_string(drop_) + " drops, hardest landing " + number(hardest_, 1) + " g", points_);
    }

    void draw(const Stage& stage, const View& view, double alpha) const override {
        const scene::Game& level = stage.game();
        const double top = level.heights[std::min(drop_, level.heights.size() - 1)];
        const double left = level.viewLower.x + 0.55 * (level.viewUpper.x - level.viewLower.x);
        for (std::size_t i = 0; i < level.heights.size(); ++i) {
            const double y = level.heights[i];
            const Colour c = i < drop_ ? look::good : i == drop_ ? look::accent : look::rule;
            view.line({left - 4.6, y}, {left + 2.6, y}, c, 1.5, true);
            view.label({left + 3.1, y}, number(y, 1) + " m", c, 14.0);
        }
        view.bodies(stage, alpha, [&](const b2Body& b) {
            return &b == egg_                     ? eggStyle()
                   : b.GetType() == b2_staticBody ? Style{}
                                                  : Style{look::loose, look::looseEdge};
        });
        view.shells(stage, alpha);
        if (!falling_) {
            view.disc({dropX_, top + radius_}, radius_, eggStyle());
            const auto& part = level.parts[chosen_];
            if (wait_ <= 0 && part.cost <= money_ + 1e-9)
                drawGhost(view, part, spawnX(), spawnHeight(stage));
        }
        palette(view, level);
        const EnergyBooks b = stage.shells().books();
        drawEnergy(view, 18.0, look::top + 60.0 + 34.0 * static_cast<double>(level.parts.size()),
                   "Where the energy went",
                   {{"egg", energyOfEgg(stage)},
                    {"bending", b.bending - books_.bending},
                    {"shells move", b.kinetic + b.gravity - books_.kinetic - books_.gravity},
                    {"friction", b.friction - books_.friction},
                    {"impact", b.impact - books_.impact},
                    {"damping", b.numerical - books_.numerical},
                    {"snaps", snaps_}},
                   {look::looseEdge, look::accent, Colour::hex(0x6fb1d8), look::bad, look::muted, look::rule,
                    Colour::hex(0x8b5fbf)});
    }

    std::vector<Status> status(const Stage& stage) const override {
        const scene::Game& level = stage.game();
        const Colour c = felt_ > 0.8 * level.limit ? look::bad : look::ink;
        return {{"budget", number(money_, 0)},
                {"drop", std::to_string(std::min(drop_ + 1, level.heights.size())) + " of " +
                             std::to_string(level.heights.size())},
                {"felt", number(felt_, 1) + " / " + number(level.limit, 0) + " g", c},
                {"snaps", std::to_string(snapCount_)},
                {"points", std::to_string(verdict() == Verdict::Playing ? points_ : score())}};
    }
    std::string hint(const Stage& stage) const override {
        if (falling_)
            return "Watch: what the egg feels while it lands must stay below the limit.";
        return stage.game().hint.empty() ? "Click to drop shells into the crate, Enter lets the egg fall."
                                         : stage.game().hint;
    }
    std::vector<std::pair<std::string, std::string>> help() const override {
        return {{"1 - 9", "choose a kind of shell"},
                {"click, space", "drop one below the mouse"},
                {"Enter", "let the egg fall"}};
    }
    Grip grip() const override { return {.allowed = false}; }

private:
    static Style eggStyle() { return {Colour::hex(0xfdf3e1), Colour::hex(0xb07d3c)}; }
    [[nodiscard]] double spawnX() const { return std::clamp(aim_.x, -1.35, 1.35); }
    /// Above everything that lies in the crate.
    [[nodiscard]] double spawnHeight(const Stage& stage) const {
        double top = 1.0;
        for (const ShellHandle s : stage.shells().list())
            if (const auto m = stage.shells().measure(s))
                top = std::max(top, m->box.upper.y);
        return top + 0.9;
    }

    void buy(Stage& stage, const scene::GamePart& part) {
        if (part.cost > money_ + 1e-9)
            return;
        // Every shell lies another way; its place is that of its middle, the mouse points at the centre of its circle.
        const double angle = M_PI - 2.7 + 0.9 * static_cast<double>(bought_ % 7);
        const Point middle{spawnX() + part.radius * std::sin(angle),
                           spawnHeight(stage) - part.radius * std::cos(angle)};
        if (!stage.add(part, middle, angle))
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

    void release(Stage& stage) {
        const double y = stage.game().heights[drop_] + radius_;
        egg_->SetTransform({static_cast<float>(dropX_), static_cast<float>(y)}, 0.0F);
        egg_->SetLinearVelocity({0.0F, 0.0F});
        egg_->SetAngularVelocity(0.0F);
        egg_->SetEnabled(true);
        egg_->SetAwake(true);
        falling_ = true;
        steps_ = still_ = snapCount_ = 0;
        felt_ = snaps_ = 0.0;
        feel_.reset({0.0, 0.0});
        books_ = stage.shells().books();
    }

    [[nodiscard]] double energyOfEgg(const Stage& stage) const {
        if (!falling_)
            return static_cast<double>(egg_->GetMass()) * kG *
                   stage.game().heights[std::min(drop_, stage.game().heights.size() - 1)];
        const Point v = stage.velocity(*egg_), at = stage.position(*egg_);
        const double m = static_cast<double>(egg_->GetMass());
        return m * (0.5 * (v.x * v.x + v.y * v.y) + kG * std::max(0.0, at.y - radius_));
    }

    void drawGhost(const View& view, const scene::GamePart& part, double x, double y) const {
        std::vector<Point> line;
        for (int i = 0; i <= 32; ++i) {
            const double a = 0.5 * M_PI + 2.0 * M_PI * part.phi_bar * (i / 32.0 - 0.5);
            line.push_back({x + part.radius * std::cos(a), y + part.radius * std::sin(a)});
        }
        view.curve(line, Colour::hex(part.colour, 0.45), 0.0);
    }

    void palette(const View& view, const scene::Game& level) const {
        Canvas& c = view.canvas();
        for (std::size_t i = 0; i < level.parts.size(); ++i) {
            const scene::GamePart& p = level.parts[i];
            const double y = look::top + 18.0 + 34.0 * static_cast<double>(i);
            const Colour edge = i == chosen_ ? look::accent : look::rule;
            c.rectangle({18.0, y, 300.0, 30.0},
                        {.fill = look::strip, .stroke = report::Stroke{edge, i == chosen_ ? 2.5 : 1.0}});
            c.rectangle({26.0, y + 8.0, 14.0, 14.0}, {.fill = Colour::hex(p.colour)});
            c.text({50.0, y + 20.0}, std::to_string(i + 1) + "  " + p.name, {.size = 14.0, .bold = true});
            c.text({306.0, y + 20.0},
                   number(360.0 * p.phi_bar, 0) + "\u00b0  mu " + number(p.mu, 2) + "  costs " + number(p.cost, 0),
                   {.size = 12.0, .colour = look::muted, .anchor = report::Anchor::End});
        }
    }

    b2Body* egg_ = nullptr;
    double money_ = 0.0, radius_ = 0.4, dropX_ = 0.0;
    std::size_t chosen_ = 0, drop_ = 0;
    int bought_ = 0, wait_ = 0, steps_ = 0, still_ = 0, snapCount_ = 0, points_ = 0;
    bool falling_ = false;
    double felt_ = 0.0, hardest_ = 0.0, snaps_ = 0.0;
    Point aim_{};
    Feel feel_;
    EnergyBooks books_{};
};

} // namespace

} // namespace supercircle::frame

int main(int argc, char** argv) {
    using namespace supercircle::frame;
    return run(argc, argv, {"egg_drop", "Egg drop", {"egg_drop_1.json", "egg_drop_2.json", "egg_drop_3.json"}, [] {
                                return std::make_unique<EggDrop>();
                            }});
}
