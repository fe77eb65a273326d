// The section "game" of a level (docs/how-to/levels.md).

#include "plugin/scene/loader/sections.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cctype>

namespace supercircle::scene {

namespace {

const std::vector<std::string> kKinds{"egg_drop", "lander", "clip"};

/// "#rrggbb" as 0xRRGGBB; the fallback without the key, or after a report.
std::uint32_t readColour(Context& context, ObjectReader& reader, std::uint32_t fallback) {
    const std::optional<Node> node = reader.find("colour");
    if (!node)
        return fallback;
    const std::string t = node->text();
    const bool hex = node->kind() == Node::Kind::String && t.size() == 7 && t[0] == '#' &&
                     std::all_of(t.begin() + 1, t.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
    if (hex)
        return static_cast<std::uint32_t>(std::stoul(t.substr(1), nullptr, 16));
    context.error(*node, reader.pointerTo("colour"), "this is not a colour", "\"#rrggbb\", six hex digits");
    return fallback;
}

GamePart readPart(Context& context, const ArrayItem& place) {
    ObjectReader reader(context, place.node, place.pointer);
    GamePart p;
    reader.require("name", "a text");
    p.name = reader.string("name", "");
    p.colour = readColour(context, reader, p.colour);
    p.radius = reader.number("radius", p.radius, positive);
    p.mass = reader.number("mass", p.mass, positive);
    p.phi_bar = reader.number("phi_bar", p.phi_bar, {0.1, 0.99});
    p.stiffness = reader.number("stiffness", p.stiffness, positive);
    p.mu = reader.number("mu", p.mu, notNegative);
    p.elements = static_cast<int>(reader.integer("elements", p.elements, 3, 200));
    p.cost = reader.number("cost", p.cost, notNegative);
    if (reader.find("at")) {
        const Eigen::Vector2d at = reader.vector("at", Eigen::Vector2d::Zero());
        p.at = Point{at.x(), at.y()};
    }
    reader.finish();
    return p;
}

/// Corners of an area, m; without the key they stay as they are.
void readArea(Context& context, ObjectReader& game, const std::string& key, Point& lower, Point& upper) {
    const std::optional<Node> node = game.find(key);
    if (!node)
        return;
    ObjectReader area(context, *node, game.pointerTo(key));
    const std::size_t before = context.errors();
    area.require("lower", "the lower left corner, m");
    area.require("upper", "the upper right corner, m");
    const Eigen::Vector2d a = area.vector("lower", Eigen::Vector2d::Zero());
    const Eigen::Vector2d b = area.vector("upper", Eigen::Vector2d::Ones());
    area.finish();
    if (context.errors() == before && !(a.x() < b.x() && a.y() < b.y()))
        context.error(*node, area.pointer(), "the area is empty", "lower below and left of upper");
    lower = {a.x(), a.y()};
    upper = {b.x(), b.y()};
}

/// Name of a body of the wanted type, which `typeText` names in messages; empty without the key. A body that does not
/// exist or is of another type is reported.
std::string readBody(Context& context, ObjectReader& game, const std::string& key, const Scene& scene,
                     step::BodyType type, const char* typeText) {
    const std::optional<Node> node = game.find(key);
    const std::string name = game.string(key, "");
    if (!node || node->kind() != Node::Kind::String)
        return name;
    std::vector<std::string> names;
    const step::BodyDefinition* found = nullptr;
    for (const step::BodyDefinition& b : scene.rigid.bodies) {
        if (b.type == type && !b.name.empty())
            names.push_back(b.name);
        if (b.name == name && !name.empty()) // "" names none, although bodies may go without a name
            found = &b;
    }
    if (found == nullptr)
        context.error(*node, game.pointerTo(key), "there is no body named \"" + name + "\"", "",
                      nearestName(name, names));
    else if (found->type != type)
        context.error(*node, game.pointerTo(key), "the body \"" + name + "\" is of another type", typeText);
    return name;
}

/// Reports keys that games of this kind need.
void requireForKind(ObjectReader& game, const std::string& kind) {
    game.require("actor", "the name of a dynamic body");
    game.require("part", "the kinds of shells of the level");
    if (kind == "egg_drop")
        game.require("heights", "an array of heights, m");
    else
        game.require("goal", "{\"lower\": ..., \"upper\": ...}");
    if (kind == "clip")
        game.require("carrier", "the name of a kinematic body");
}

} // namespace

void readGame(Context& context, ObjectReader& top, const Scene& scene, std::optional<Game>& out) {
    const std::optional<Node> node = top.find("game");
    if (!node)
        return;
    ObjectReader game(context, *node, "/game");
    if (!game.valid())
        return;
    Game g;
    game.require("kind", "one of \"egg_drop\", \"lander\", \"clip\"");
    if (const std::size_t kind = game.choice("kind", kKinds, kKinds.size()); kind < kKinds.size()) {
        g.kind = kKinds[kind];
        requireForKind(game, g.kind);
    }
    g.title = game.string("title", scene.name);
    g.hint = game.string("hint", "");
    g.actor = readBody(context, game, "actor", scene, step::BodyType::Dynamic, "\"type\": 2");
    g.carrier = readBody(context, game, "carrier", scene, step::BodyType::Kinematic, "\"type\": 1");
    g.service = readBody(context, game, "service", scene, step::BodyType::Static, "\"type\": 0");
    readArea(context, game, "view", g.viewLower, g.viewUpper);
    readArea(context, game, "goal", g.goalLower, g.goalUpper);
    g.hold = game.number("hold", g.hold, notNegative);
    g.time = game.number("time", g.time, positive);
    g.limit = game.number("limit", g.limit, positive);
    g.budget = game.number("budget", g.budget, positive);
    const std::size_t before = context.errors();
    g.heights = game.numbers("heights", positive);
    if (const std::optional<Node> heights = game.find("heights");
        heights && g.heights.empty() && context.errors() == before)
        context.error(*heights, "/game/heights", "no height", "at least one, m");
    g.fuel = game.number("fuel", g.fuel, positive);
    g.thrust = game.number("thrust", g.thrust, positive);
    g.wind = game.number("wind", g.wind);
    g.speed = game.number("speed", g.speed, positive);
    for (const ArrayItem& place : game.array("part"))
        g.parts.push_back(readPart(context, place));
    if (const std::optional<Node> parts = game.find("part");
        parts && parts->kind() == Node::Kind::Array && (g.parts.empty() || g.parts.size() > 9))
        context.error(*parts, "/game/part", std::to_string(g.parts.size()) + " parts", "1 to 9");
    game.finish();
    out = std::move(g);
}

} // namespace supercircle::scene
