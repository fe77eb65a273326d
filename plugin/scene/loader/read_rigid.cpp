// Rigid bodies under the names R.U.B.E. and b2dJson use, so that existing Box2D exports load unchanged.

#include "plugin/scene/loader/sections.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::scene {

namespace {

using rod::Vec2;
using step::BodyDefinition;
using step::BodyType;
using step::FixtureDefinition;
using step::ShapeKind;

// Box2D 2.4 merges polygon vertices closer than half its slop and refuses chains with edges shorter than the slop. Both
// abort the process, so they are refused here. Units of the host, after scaling.
constexpr double box2dSlop = 0.005;
constexpr double farthest = 1e4;   // single precision resolves a fifth of the slop there
constexpr double box2dArea = 1e-5; // it asserts on less than 1.2e-7
constexpr std::size_t box2dPolygonVertices = 8;

/// b2dJson's {"x": [...], "y": [...]}.
std::vector<Vec2> readVertices(Context& context, ObjectReader& shape) {
    std::vector<Vec2> vertices;
    if (!shape.require("vertices", "{\"x\": [...], \"y\": [...]}"))
        return vertices;
    const std::optional<Node> node = shape.find("vertices");
    if (!node)
        return vertices;
    ObjectReader lists(context, *node, shape.pointerTo("vertices"), true);
    const std::vector<double> x = lists.numbers("x");
    const std::vector<double> y = lists.numbers("y");
    lists.finish();
    if (x.size() != y.size()) {
        context.error(*node, lists.pointer(),
                      std::to_string(x.size()) + " x but " + std::to_string(y.size()) + " y coordinates",
                      "as many x as y");
        return vertices;
    }
    for (std::size_t i = 0; i < x.size(); ++i)
        vertices.emplace_back(x[i], y[i]);
    return vertices;
}

/// Length of the shortest edge, m.
double shortestEdge(const std::vector<Vec2>& v, bool closed) {
    double shortest = INFINITY;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < v.size(); ++i)
        shortest = std::min(shortest, (v[(i + 1) % v.size()] - v[i]).norm());
    return shortest;
}

bool checkEdges(Context& context, const Node& at, const std::string& pointer, const std::vector<Vec2>& v, bool closed,
                double shortest) {
    if (shortestEdge(v, closed) > shortest)
        return true;
    context.error(at, pointer, "two neighbouring vertices coincide or nearly so",
                  "edges longer than " + std::to_string(shortest) +
                      " m (Box2D's tolerance divided by \"lengthScale\"; raise \"lengthScale\" for small shapes)");
    return false;
}

/// Reports a distance from the origin that is too large for single precision.
void checkReach(Context& context, const Node& at, const std::string& pointer, double reach, double scale) {
    if (reach * scale <= farthest)
        return;
    context.error(at, pointer, "too far out for the single precision of Box2D",
                  "at most " + std::to_string(farthest / scale) + " m (10000 divided by \"lengthScale\")");
}

double reachOf(const std::vector<Vec2>& vertices) {
    double reach = 0.0;
    for (const Vec2& v : vertices)
        reach = std::max(reach, v.norm());
    return reach;
}

/// Removes corners that are straight within the precision of exports (seven digits): rounding decides whether they are
/// convex.
void dropStraightCorners(std::vector<Vec2>& v) {
    constexpr double straight = 1e-6; // rad
    for (std::size_t i = 0; i < v.size() && v.size() > 3;) {
        const Vec2 a = v[i] - v[(i + v.size() - 1) % v.size()];
        const Vec2 b = v[(i + 1) % v.size()] - v[i];
        if (std::abs(math::atan2(rod::cross(a, b), a.dot(b))) < straight)
            v.erase(v.begin() + static_cast<std::ptrdiff_t>(i));
        else
            ++i;
    }
}

/// Checks that the polygon is convex and simple, and orders it counter-clockwise.
void checkPolygon(Context& context, const Node& at, const std::string& pointer, std::vector<Vec2>& v, double scale) {
    if (v.size() < 3 || v.size() > box2dPolygonVertices) {
        context.error(at, pointer, "a polygon of " + std::to_string(v.size()) + " vertices",
                      "3 to 8 vertices (Box2D's limit; split larger ones into several fixtures)");
        return;
    }
    if (!checkEdges(context, at, pointer, v, true, box2dSlop / scale))
        return;
    dropStraightCorners(v);
    double turned = 0.0;
    double area = 0.0;
    double least = INFINITY;
    double most = -INFINITY;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec2 a = v[(i + 1) % v.size()] - v[i];
        const Vec2 b = v[(i + 2) % v.size()] - v[(i + 1) % v.size()];
        const double turn = math::atan2(rod::cross(a, b), a.dot(b));
        turned += turn;
        area += 0.5 * rod::cross(v[i], v[(i + 1) % v.size()]);
        least = std::min(least, turn);
        most = std::max(most, turn);
    }
    if (turned < 0.0)
        std::reverse(v.begin(), v.end());
    const double sharpest = M_PI - 1e-6; // a corner that reverses the direction
    const bool oneWay = turned < 0.0 ? most < 0.0 && least > -sharpest : least > 0.0 && most < sharpest;
    if (!oneWay || std::abs(std::abs(turned) - 2.0 * M_PI) > 1e-3)
        context.error(at, pointer, "the polygon is not convex", "vertices in order around a convex outline");
    else if (std::abs(area) * scale * scale < box2dArea)
        context.error(at, pointer, "the polygon has almost no area", "more area, or a larger \"lengthScale\"");
    checkReach(context, at, pointer, reachOf(v), scale);
}

void readCircle(Context& context, const Node& node, const std::string& pointer, FixtureDefinition& f, double scale) {
    ObjectReader circle(context, node, pointer, true);
    f.shape = ShapeKind::Circle;
    f.centre = circle.vector("center", Vec2::Zero());
    circle.require("radius", "a number > 0, m");
    f.radius = circle.number("radius", 1.0, {1e-3 / scale, farthest / scale});
    circle.finish();
    checkReach(context, node, pointer, f.centre.norm(), scale);
}

void readEdge(Context& context, const Node& node, const std::string& pointer, FixtureDefinition& f, double scale) {
    ObjectReader edge(context, node, pointer, true);
    f.shape = ShapeKind::Chain;
    f.twoSided = true;
    edge.require("vertex1", "{\"x\": ..., \"y\": ...}");
    edge.require("vertex2", "{\"x\": ..., \"y\": ...}");
    f.vertices = {edge.vector("vertex1", Vec2::Zero()), edge.vector("vertex2", Vec2::UnitX())};
    edge.ignore(
        {"hasVertex0", "hasVertex3", "vertex0", "vertex3"}); // ghost vertices of Box2D; contact of shells needs none
    edge.finish();
    checkEdges(context, node, pointer, f.vertices, false, box2dSlop / scale);
    checkReach(context, node, pointer, reachOf(f.vertices), scale);
}

void readChain(Context& context, const Node& node, const std::string& pointer, FixtureDefinition& f, bool loop,
               double scale) {
    ObjectReader chain(context, node, pointer, true);
    f.shape = loop ? ShapeKind::Loop : ShapeKind::Chain;
    const std::size_t before = context.errors();
    f.vertices = readVertices(context, chain);
    chain.ignore({"hasNextVertex", "hasPrevVertex", "nextVertex", "prevVertex"});
    chain.finish();
    if (context.errors() != before)
        return;
    // R.U.B.E. writes a loop as a chain that comes back to its first vertex.
    if (f.vertices.size() >= 4 && f.vertices.front() == f.vertices.back()) {
        f.vertices.pop_back();
        f.shape = ShapeKind::Loop;
    }
    const bool closed = f.shape == ShapeKind::Loop;
    const std::size_t fewest = closed ? 3 : 2;
    if (f.vertices.size() < fewest)
        context.error(node, pointer, "only " + std::to_string(f.vertices.size()) + " vertices",
                      "at least " + std::to_string(fewest));
    else
        checkEdges(context, node, pointer, f.vertices, closed, box2dSlop / scale);
    checkReach(context, node, pointer, reachOf(f.vertices), scale);
}

void readShape(Context& context, ObjectReader& reader, FixtureDefinition& f, double scale) {
    const char* keys[] = {"circle", "polygon", "chain", "loop", "edge"};
    std::optional<Node> shape;
    int count = 0;
    for (const char* key : keys) {
        if (const std::optional<Node> node = reader.find(key)) {
            shape = node;
            ++count;
        }
    }
    if (!reader.valid())
        return;
    if (count != 1) {
        context.error(reader.node(), reader.pointer(), count == 0 ? "a fixture without a shape" : "several shapes",
                      "one of \"circle\", \"polygon\", \"chain\", \"loop\", \"edge\"");
        return;
    }
    const std::string pointer = reader.pointerTo(shape->key());
    if (shape->key() == "circle") {
        readCircle(context, *shape, pointer, f, scale);
    } else if (shape->key() == "edge") {
        readEdge(context, *shape, pointer, f, scale);
    } else if (shape->key() == "polygon") {
        ObjectReader polygon(context, *shape, pointer, true);
        const std::size_t before = context.errors();
        f.vertices = readVertices(context, polygon);
        polygon.finish();
        if (context.errors() == before)
            checkPolygon(context, *shape, pointer, f.vertices, scale);
    } else {
        readChain(context, *shape, pointer, f, shape->key() == "loop", scale);
    }
}

FixtureDefinition readFixture(Context& context, const ArrayItem& place, double scale) {
    ObjectReader reader(context, place.node, place.pointer, true);
    FixtureDefinition f;
    if (context.rubeExport)
        f.density = f.friction = 0.0;
    f.name = reader.string("name", "");
    f.density = reader.number("density", f.density, notNegative);
    f.friction = reader.number("friction", f.friction, notNegative);
    f.restitution = reader.number("restitution", f.restitution, notNegative);
    f.sensor = reader.boolean("sensor", false);
    f.filterCategoryBits = static_cast<std::uint16_t>(reader.integer("filter-categoryBits", 1, 0, 65535));
    f.filterMaskBits = static_cast<std::uint16_t>(reader.integer("filter-maskBits", 65535, 0, 65535));
    f.filterGroupIndex = static_cast<std::int16_t>(reader.integer("filter-groupIndex", 0, -32768, 32767));
    readShape(context, reader, f, scale);
    reader.ignore({"customProperties", "path"});
    reader.finish();
    return f;
}

void readMassData(ObjectReader& reader, BodyDefinition& body) {
    const bool given = reader.find("massData-mass").has_value();
    step::MassData data;
    data.mass = reader.number("massData-mass", 0.0, notNegative);
    data.centre = reader.vector("massData-center", Vec2::Zero());
    data.inertia = reader.number("massData-I", 0.0, notNegative);
    if (given && data.mass > 0.0) // exports give 0 for bodies without mass
        body.massData = data;
}

BodyDefinition readBody(Context& context, const ArrayItem& place, double scale) {
    ObjectReader reader(context, place.node, place.pointer, true);
    BodyDefinition b;
    b.awake = !context.rubeExport;
    b.name = reader.string("name", "");
    if (const std::optional<Node> type = reader.find("type"); type && type->kind() == Node::Kind::String)
        context.error(*type, reader.pointerTo("type"), "this is a text", "0 (static), 1 (kinematic) or 2 (dynamic)");
    else
        b.type = static_cast<BodyType>(reader.integer("type", 0, 0, 2));
    b.position = reader.vector("position", b.position);
    if (const std::optional<Node> position = reader.find("position"))
        checkReach(context, *position, reader.pointerTo("position"), b.position.norm(), scale);
    b.angle = reader.number("angle", b.angle);
    b.linearVelocity = reader.vector("linearVelocity", b.linearVelocity);
    b.angularVelocity = reader.number("angularVelocity", b.angularVelocity);
    b.linearDamping = reader.number("linearDamping", b.linearDamping, notNegative);
    b.angularDamping = reader.number("angularDamping", b.angularDamping, notNegative);
    b.gravityScale = reader.number("gravityScale", b.gravityScale);
    b.bullet = reader.boolean("bullet", b.bullet);
    b.fixedRotation = reader.boolean("fixedRotation", b.fixedRotation);
    b.allowSleep = reader.boolean("allowSleep", b.allowSleep);
    b.awake = reader.boolean("awake", b.awake);
    b.active = reader.boolean("active", b.active);
    readMassData(reader, b);
    for (const ArrayItem& fixture : reader.array("fixture"))
        b.fixtures.push_back(readFixture(context, fixture, scale));
    reader.ignore({"customProperties", "path"});
    reader.finish();
    return b;
}

} // namespace

void readRigid(Context& context, ObjectReader& top, step::RigidWorldDefinition& out) {
    if (context.rubeExport)
        out.gravity.setZero();
    if (const std::optional<Node> gravity = top.find("gravity"))
        out.gravity = readVector(context, *gravity, "/gravity", true).value_or(out.gravity);
    for (const ArrayItem& place : top.array("body"))
        out.bodies.push_back(readBody(context, place, out.lengthScale));
    if (!top.boolean("allowSleep", true))
        for (BodyDefinition& body : out.bodies)
            body.allowSleep = false;
    readJoints(context, top, out);
    top.ignore({"image", "customProperties", "collisionbitplanes"});
    for (const char* key : {"velocityIterations", "positionIterations", "stepsPerSecond", "autoClearForces",
                            "warmStarting", "continuousPhysics", "subStepping"})
        if (const std::optional<Node> node = top.find(key))
            context.note(*node, top.pointerTo(key), std::string("\"") + key + "\" of R.U.B.E. has no effect here");
}

} // namespace supercircle::scene
