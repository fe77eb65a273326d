// The pictures of the tutorials, drawn by the calls that they explain; `supercircle bench --filter guide`.

#include "bridge/box2d/lab_world.h"
#include "plugin/bench/bench_game_scenes.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/files.h"
#include "plugin/scene/player/dropper.h"
#include "supercircle/step/world.h"

#include <cmath>
#include <limits>
#include <memory>

namespace supercircle::cli {

namespace {

namespace theme = graphics::theme;

/// Mapping of a part of the plane to the sheet.
struct SheetWindow {
    graphics::Rect area;          ///< px
    double left = 0.0, low = 0.0; ///< m, of the area's lower left corner
    double scale = 1.0;           ///< px/m
    [[nodiscard]] graphics::Point at(double x, double y) const {
        return {area.x + scale * (x - left), area.bottom() - scale * (y - low)};
    }
};

/// Shells::draw on a canvas, as a b2Draw of a game would do it.
class SheetDraw : public DebugDraw {
public:
    SheetDraw(graphics::Canvas& canvas, const SheetWindow& window, double width)
        : canvas_(canvas), window_(window), width_(width) {}
    void polyline(std::span<const Point> points, const Colour& colour) override { path(points, false, colour, width_); }
    void outline(std::span<const Point> points, const Colour& colour) override { path(points, true, colour, 0.7); }
    void mark(const Point& at, const Colour& colour) override {
        canvas_.circle(window_.at(at.x, at.y), 2.6, {.fill = of(colour)});
    }

private:
    static graphics::Colour of(const Colour& c) { return {c.red, c.green, c.blue, c.alpha}; }
    void path(std::span<const Point> points, bool closed, const Colour& colour, double width) {
        std::vector<graphics::Point> line;
        for (const Point& p : points)
            line.push_back(window_.at(p.x, p.y));
        canvas_.path(line, closed, {.stroke = graphics::Stroke{of(colour), width}});
    }
    graphics::Canvas& canvas_;
    SheetWindow window_;
    double width_;
};

/// A Box2D world with shells, stepped in frames.
struct GameWorld {
    std::shared_ptr<step::HostWorld> host;
    std::unique_ptr<Shells> shells;
    std::string failure;
    std::vector<double> frames; ///< ms

    explicit GameWorld(const step::RigidWorldDefinition& world) {
        host = bridge::makeWorld(world, failure);
        if (!host)
            return;
        shells = std::make_unique<Shells>(host);
        shells->set_quality(Quality::Game).or_fail();
    }
    ShellHandle add(const ShellDef& d) {
        const auto made = shells->create(d);
        if (!made && failure.empty())
            failure = made.error();
        return made ? *made : ShellHandle{};
    }
    void addJoint(const JointDef& d) {
        const auto made = shells->create_joint(d);
        if (!made && failure.empty())
            failure = made.error();
    }
    void run(double seconds) {
        for (double t = 0.0; t < seconds - 1e-9 && failure.empty();) {
            const double begin = wallSeconds();
            const FrameReport report = shells->pre_step(kGameFrame);
            failure = report.failure;
            if (report.advanced <= 0.0)
                return;
            host->step(report.advanced);
            shells->post_step().or_fail();
            frames.push_back(1e3 * (wallSeconds() - begin));
            t += report.advanced;
        }
    }
    void draw(graphics::Canvas& canvas, const SheetWindow& window, const DrawOptions& options,
              double width = 2.4) const {
        canvas.pushClip(window.area);
        std::vector<step::BodyOutline> all;
        host->everything(all);
        const graphics::Paint solid{.fill = theme::body, .stroke = graphics::Stroke{theme::bodyEdge, 1.0}};
        for (const step::BodyOutline& o : all) {
            const step::BodyState s = host->stateOf(o.body);
            const contact::Outline placed = step::placed(o, s.centre, s.angle);
            std::vector<graphics::Point> points;
            for (const Vec2& p : placed.points)
                points.push_back(window.at(p.x(), p.y()));
            if (placed.kind == contact::OutlineKind::Circle)
                canvas.circle(points.front(), placed.radius * window.scale, solid);
            else
                canvas.path(points, true, solid);
        }
        SheetDraw sheet(canvas, window, width);
        shells->draw(sheet, options).or_fail();
        canvas.popClip();
    }
};

step::BodyDefinition boxBody(const Vec2& centre, double halfWidth, double halfHeight, double mass) {
    step::BodyDefinition body;
    body.type = mass > 0.0 ? step::BodyType::Dynamic : step::BodyType::Static;
    body.position = centre;
    step::FixtureDefinition box;
    box.vertices = {
        {-halfWidth, -halfHeight}, {halfWidth, -halfHeight}, {halfWidth, halfHeight}, {-halfWidth, halfHeight}};
    box.density = mass / (4.0 * halfWidth * halfHeight);
    box.friction = 0.35;
    body.fixtures.push_back(box);
    return body;
}

ShellDef shellAt(double x, double y, double angle) {
    ShellDef d = scaled_shell(1.0, 2.0);
    d.position = {x, y};
    d.angle = angle;
    return d;
}

DrawOptions lines() {
    DrawOptions o;
    o.outlines = o.contacts = o.forces = o.strain = false;
    o.tolerance = 1e-3;
    o.line = {0.16F, 0.43F, 0.72F};
    return o;
}

struct DrawnPicture {
    std::vector<double> frames; ///< ms
    std::string failure;
};

/// scenes/hello.json at three times.
DrawnPicture drawHello(graphics::Canvas& canvas) {
    step::RigidWorldDefinition world;
    world.bodies = {boxBody({0.0, -0.2}, 6.0, 0.2, 0.0), boxBody({0.0, 0.51}, 0.5, 0.5, 20.0)};
    GameWorld stage(world);
    if (!stage.shells)
        return {{}, stage.failure};
    stage.add(shellAt(-3.2, 2.0, 0.6));
    stage.add(shellAt(0.1, 4.0, M_PI));
    ShellDef rolling = shellAt(3.0, 2.5, 2.2);
    rolling.velocity = {-1.5, 0.0};
    stage.add(rolling);
    double x = 20.0;
    for (const auto& [until, title] : {std::pair{0.0, "0 s"}, std::pair{0.75, "0.75 s"}, std::pair{1.8, "1.8 s"}}) {
        stage.run(until - stage.shells->time());
        const SheetWindow window{{x, 36.0, 320.0, 145.0}, -5.6, -0.45, 320.0 / 11.2};
        canvas.text({x, 26.0}, title, {theme::labelSize, theme::ink, graphics::Anchor::Start, true});
        stage.draw(canvas, window, lines(), 2.0);
        x += 340.0;
    }
    return {stage.frames, stage.failure};
}

/// A swing, two shells on a tether, a springboard, a mouse joint.
DrawnPicture drawJoints(graphics::Canvas& canvas) {
    step::RigidWorldDefinition world;
    world.bodies = {boxBody({0.0, -0.2}, 9.0, 0.2, 0.0), boxBody({0.0, 5.3}, 9.0, 0.1, 0.0),
                    boxBody({1.2, 1.0}, 0.2, 1.0, 0.0), boxBody({3.25, 2.31}, 0.25, 0.25, 6.0)};
    GameWorld stage(world);
    if (!stage.shells)
        return {{}, stage.failure};
    Shells& shells = *stage.shells;
    const ShellHandle swing = stage.add(shellAt(-7.0, 1.4, 0.0));
    for (const double end : {0.0, 1.0})
        stage.addJoint(
            {.kind = JointKind::Tether, .shell = swing, .arc_fraction = end, .point = {-7.0 + (end - 0.5), 5.2}});
    const ShellHandle upper = stage.add(shellAt(-3.0, 4.0, M_PI)), lower = stage.add(shellAt(-3.0, 1.95, M_PI));
    stage.addJoint({.kind = JointKind::Tether, .shell = upper, .point = {-3.0, 5.2}});
    stage.addJoint({.kind = JointKind::Tether, .shell = lower, .other = upper, .other_fraction = 0.0});
    stage.addJoint({.kind = JointKind::Tether, .shell = lower, .other = upper, .other_fraction = 1.0});
    ShellDef board = scaled_shell(1.0, 6.0, 0.75, 0.3);
    board.radius = std::numeric_limits<double>::infinity();
    board.length = 2.6;
    board.position = {2.4, 2.0 + board.thickness};
    board.elements = 24;
    const ShellHandle plank = stage.add(board);
    const auto clamp = shells.create_clamp(plank, 0.0);
    if (!clamp)
        stage.failure = clamp.error();
    const ShellHandle held = stage.add(shellAt(6.8, 0.05, 0.0));
    const auto hand = shells.create_mouse_joint(held, {.arc_fraction = 0.0, .target = {6.4, 4.3}, .frequency = 2.0});
    if (!hand)
        stage.failure = hand.error();
    stage.run(4.0);
    const SheetWindow window{{20.0, 40.0, 1000.0, 330.0}, -9.0, -0.5, 1000.0 / 18.0};
    stage.draw(canvas, window, lines());
    const auto string = [&](ShellHandle a, double fa, Point to) {
        const auto from = shells.section(a, fa);
        if (from)
            canvas.line(window.at(from->position.x, from->position.y), window.at(to.x, to.y),
                        {theme::muted, 1.0, {4.0, 3.0}});
    };
    string(swing, 0.0, {-7.5, 5.2});
    string(swing, 1.0, {-6.5, 5.2});
    string(upper, 0.5, {-3.0, 5.2});
    for (const double end : {0.0, 1.0})
        if (const auto p = shells.section(upper, end))
            string(lower, 0.5, p->position);
    string(held, 0.0, {6.4, 4.3});
    canvas.circle(window.at(6.4, 4.3), 4.0, {.fill = theme::loading});
    for (const auto& [x, text] :
         {std::pair{-7.0, "two tethers to the world"}, std::pair{-3.0, "tethers between shells"},
          std::pair{2.4, "a clamp, and a crate of Box2D"}, std::pair{6.8, "a mouse joint"}})
        canvas.text({window.at(x, 0.0).x, 30.0}, text, {theme::labelSize, theme::ink, graphics::Anchor::Middle, true});
    return {stage.frames, stage.failure};
}

/// Shells::draw with all options.
DrawnPicture drawDebug(graphics::Canvas& canvas) {
    PileCase pile;
    pile.shells = pile.batchSize = 12;
    pile.width = 9.0;
    GameWorld stage(boxWorld(pile));
    if (!stage.shells)
        return {{}, stage.failure};
    scene::Drop drop = dropOf(pile);
    player::Random random(5);
    std::vector<ShellHandle> made;
    stage.failure = player::dropBatch(*stage.shells, drop, pile.shells, random, made).error();
    stage.run(5.0);
    DrawOptions options;
    options.outlines = false;
    options.tolerance = 1e-3;
    options.metres_per_newton = 0.012;
    options.full_strain = 0.0011;
    const SheetWindow window{{20.0, 40.0, 620.0, 400.0}, -4.65, -0.15, 620.0 / 9.3};
    stage.draw(canvas, window, options);
    canvas.text({20.0, 28.0}, "Shells::draw: surface strain (blue to red), contacts and their forces",
                {theme::labelSize, theme::ink, graphics::Anchor::Start, true});
    return {stage.frames, stage.failure};
}

struct Picture {
    const char* name;
    double width, height; ///< px
    DrawnPicture (*draw)(graphics::Canvas&);
};
constexpr Picture kPictures[] = {
    {"hello", 1040.0, 196.0, drawHello}, {"joints", 1040.0, 385.0, drawJoints}, {"draw", 660.0, 455.0, drawDebug}};

} // namespace

void addGuidePictures(std::vector<Benchmark>& all) {
    Benchmark b;
    b.prefix = "guide";
    for (const Picture& p : kPictures)
        b.names.push_back(std::string("guide/") + p.name);
    const auto files = std::make_shared<std::vector<record::NamedText>>();
    b.measure = [files](const auto& wanted, const auto& done) {
        for (const Picture& p : kPictures) {
            const std::string name = std::string("guide/") + p.name;
            if (!wanted(name))
                continue;
            graphics::CairoCanvas canvas(p.width, p.height, 1.5);
            const DrawnPicture drawn = p.draw(canvas);
            const auto png = canvas.png();
            if (!drawn.failure.empty() || !png)
                return name + ": " + (drawn.failure.empty() ? png.error() : drawn.failure);
            files->push_back({std::string("guide_") + p.name + ".png", *png});
            done(summarise(name, drawn.frames));
        }
        return std::string();
    };
    b.finish = writesPictures(files, "guide_*.png");
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
