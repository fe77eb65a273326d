#include "plugin/scene/loader/sections.h"
#include "supercircle/rod/model.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>

namespace supercircle::scene {

namespace {

constexpr int minElements = 3, maxElements = 1000;

/// One curvature for all elements, or one for each.
std::vector<double> readCurvatures(Context& context, ObjectReader& reader, const std::string& key, int elements) {
    const std::optional<Node> node = reader.find(key);
    if (!node)
        return {};
    if (node->kind() != Node::Kind::Array)
        return std::vector<double>(static_cast<std::size_t>(elements), reader.number(key, 0.0));
    std::vector<double> values = reader.numbers(key);
    if (values.size() != static_cast<std::size_t>(elements)) {
        context.error(*node, reader.pointerTo(key), std::to_string(values.size()) + " curvatures",
                      "one number, or one for each of the " + std::to_string(elements) + " elements");
        values.clear();
    }
    return values;
}

/// Natural radius, m; "infinite" means a straight strip.
double readRadius(Context& context, ObjectReader& reader, double fallback) {
    const std::optional<Node> node = reader.find("radius");
    if (node && node->kind() == Node::Kind::String) {
        if (node->text() == "infinite")
            return std::numeric_limits<double>::infinity();
        context.error(*node, reader.pointerTo("radius"), "unknown value \"" + node->text() + "\"",
                      "a number > 0 in m, or \"infinite\"", nearestName(node->text(), {"infinite"}));
        return fallback;
    }
    return reader.number("radius", fallback, positive);
}

double lengthOf(const ShellDef& d) {
    return d.length > 0.0 ? d.length : 2.0 * M_PI * d.phi_bar * d.radius;
}

/// Points of the centre line at the element ends, starting anywhere.
std::vector<Eigen::Vector2d> nodesOf(const ShellDef& d) {
    const auto& curvature = d.curvature.empty() ? d.natural_curvature : d.curvature;
    std::vector<Eigen::Vector2d> nodes{Eigen::Vector2d::Zero()};
    const std::vector<double> lengths = rod::gradedLengths(lengthOf(d), d.elements, d.tip_refinement);
    rod::Arc arc;
    for (int i = 0; i < d.elements; ++i) {
        arc.length = lengths[static_cast<std::size_t>(i)];
        arc.start = nodes.back();
        arc.curvature = curvature.empty() ? 1.0 / d.radius : curvature[static_cast<std::size_t>(i)];
        nodes.push_back(arc.pointAt(arc.length));
        arc.angle = arc.angleAt(arc.length);
    }
    return nodes;
}

/// Refuses a shell whose two ends overlap at the start. Other self-overlaps are found by the check of the start state.
/// A ring without curvatures is made round; given curvatures must close it.
void checkEnds(Context& context, const ObjectReader& reader, const ShellDef& d) {
    if (d.closed && d.curvature.empty())
        return;
    const auto nodes = nodesOf(d);
    const double apart = (nodes.back() - nodes.front()).norm();
    if (d.closed && apart > 1e-6 * lengthOf(d))
        context.error(reader.node(), reader.pointer(), "a closed shell whose ends do not meet",
                      "a \"curvature\" that closes, or none: a ring is round");
    if (d.closed || d.elements < 3 || apart >= d.thickness)
        return;
    char text[96];
    std::snprintf(text, sizeof text, "the ends of the shell overlap (centre lines %.4g mm apart)", 1e3 * apart);
    context.error(reader.node(), reader.pointer(), text,
                  "at least the thickness apart: a smaller phi_bar or thickness");
}

/// A touching shell moves by about its thickness in a step.
void noteThin(Context& context, ObjectReader& reader, const ShellDef& d) {
    constexpr double usual = 1e-3; // of the radius: below it, the thickness alone sets the number of steps
    const double ratio = d.thickness / (std::isinf(d.radius) ? lengthOf(d) / (2.0 * M_PI) : std::abs(d.radius));
    if (ratio >= 0.5 * usual)
        return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "a thickness of 1/%.0f of the radius takes about %.0f times the steps of a shell of 1/1000",
                  1.0 / ratio, usual / ratio);
    const std::optional<Node> thickness = reader.find("thickness");
    context.note(thickness ? *thickness : reader.node(), reader.pointerTo("thickness"), text);
}

/// The model is that of a thin rod.
void noteThick(Context& context, ObjectReader& reader, const ShellDef& d) {
    constexpr double most = 0.2 * (1.0 + 1e-9); // of the radius; a formula may round
    const double ratio = d.thickness / (std::isinf(d.radius) ? lengthOf(d) / (2.0 * M_PI) : std::abs(d.radius));
    if (ratio <= most)
        return;
    char text[200];
    std::snprintf(text, sizeof text,
                  "a thickness of %.2g of the radius, more than 0.2: shells are computed as thin rods, whose forces "
                  "are off by about that share",
                  ratio);
    const std::optional<Node> thickness = reader.find("thickness");
    context.note(thickness ? *thickness : reader.node(), reader.pointerTo("thickness"), text);
}

void readMaterial(ObjectReader& reader, ShellDef& d) {
    d.thickness = reader.number("thickness", d.thickness, positive);
    d.width = reader.number("width", d.width, positive);
    d.density = reader.number("density", d.density, positive);
    d.young_modulus = reader.number("young_modulus", d.young_modulus, positive);
    d.mu = reader.number("mu", d.mu, notNegative);
    d.damping_ratio = reader.number("damping_ratio", d.damping_ratio, notNegative);
}

void readPointMasses(Context& context, ObjectReader& reader, ShellDef& d) {
    const double length = lengthOf(d);
    for (const ArrayItem& place : reader.array("mass_at")) {
        ObjectReader item(context, place.node, place.pointer);
        PointMassDef m;
        m.arc_fraction = item.number("arc_fraction", m.arc_fraction, {0.0, 1.0});
        item.require("mass", "kg");
        m.mass = item.number("mass", m.mass, notNegative);
        m.inertia = item.number("inertia", m.inertia, notNegative);
        if (const std::optional<Node> inertia = item.find("inertia"); m.inertia > m.mass * length * length)
            context.error(inertia ? *inertia : place.node, item.pointerTo("inertia"),
                          "the body is larger than the shell",
                          "at most the mass times the square of the shell's length");
        item.finish();
        d.mass_at.push_back(m);
    }
}

void readPose(Context& context, ObjectReader& reader, ShellDef& d) {
    const Eigen::Vector2d position = reader.vector("position", {d.position.x, d.position.y});
    d.position = {position.x(), position.y()};
    d.angle = reader.number("angle", d.angle);
    if (const std::optional<Node> angle = reader.find("angle"); angle && std::abs(d.angle) > 4.0 * M_PI)
        context.note(*angle, reader.pointerTo("angle"),
                     "angles are in rad: this one makes more than two turns; {\"expr\": \"pi\"} is half a turn");
    const Eigen::Vector2d velocity = reader.vector("velocity", {d.velocity.x, d.velocity.y});
    d.velocity = {velocity.x(), velocity.y()};
    d.spin = reader.number("spin", d.spin);
}

} // namespace

ShellDef readShell(Context& context, const Node& node, const std::string& pointer, bool isTemplate) {
    ObjectReader reader(context, node, pointer);
    const std::size_t before = context.errors();
    ShellDef d;
    if (!isTemplate)
        readPose(context, reader, d);
    d.length = reader.number("length", d.length, positive);
    d.closed = reader.boolean("closed", d.closed);
    d.phi_bar = reader.number("phi_bar", d.closed ? 1.0 : d.phi_bar, {0.0, 1.0, true});
    d.radius = readRadius(context, reader, d.radius);
    readMaterial(reader, d);
    d.elements = static_cast<int>(reader.integer("elements", d.elements, minElements, maxElements));
    d.tip_refinement = reader.number("tip_refinement", d.tip_refinement, {0.01, 100.0});
    d.natural_curvature = readCurvatures(context, reader, "natural_curvature", d.elements);
    d.curvature = readCurvatures(context, reader, "curvature", d.elements);
    readPointMasses(context, reader, d);
    d.category = static_cast<std::uint16_t>(reader.integer("category", d.category, 0, 65535));
    d.mask = static_cast<std::uint16_t>(reader.integer("mask", d.mask, 0, 65535));
    d.user_data = static_cast<std::uint64_t>(reader.integer("user_data", 0, 0, std::int64_t{1} << 53));
    d.name = reader.string("name", "");
    reader.finish();
    if (!reader.valid() || context.errors() != before)
        return d;
    if (std::isinf(d.radius) && d.length == 0.0)
        context.error(node, pointer, "a straight strip without \"length\"", "a number > 0, m");
    else if (d.thickness >= 2.0 * d.radius)
        context.error(node, pointer, "the shell is thicker than its diameter", "thickness < 2 radius");
    else if (d.thickness >= lengthOf(d))
        context.error(node, pointer, "the shell is thicker than it is long", "thickness < length");
    else {
        checkEnds(context, reader, d);
        noteThin(context, reader, d);
        noteThick(context, reader, d);
    }
    return d;
}

void readShells(Context& context, ObjectReader& top, std::vector<ShellDef>& out) {
    for (const ArrayItem& place : top.array("shell")) {
        ShellDef d = readShell(context, place.node, place.pointer, false);
        const bool taken = std::any_of(out.begin(), out.end(), [&](const ShellDef& o) { return o.name == d.name; });
        if (!d.name.empty() && taken)
            context.error(*place.node.find("name"), place.pointer + "/name",
                          "there is already a shell named \"" + d.name + "\"", "a different name for each shell");
        out.push_back(std::move(d));
    }
}

namespace {

HoldBase readBase(ObjectReader& reader) {
    const std::optional<Node> old = reader.superseded("on_machine", "\"base\": \"moving\"", "base");
    const bool moving = old ? reader.boolean("on_machine", false) : reader.choice("base", {"fixed", "moving"}, 0) == 1;
    return moving ? HoldBase::Moving : HoldBase::Fixed;
}

} // namespace

void readHolds(Context& context, ObjectReader& top, const std::vector<ShellDef>& shells, std::vector<HoldDef>& out) {
    std::vector<std::string> names;
    for (const ShellDef& d : shells)
        if (!d.name.empty())
            names.push_back(d.name);
    for (const ArrayItem& place : top.array("hold")) {
        ObjectReader reader(context, place.node, place.pointer);
        HoldDef h;
        reader.require("shell", "the name of a shell");
        h.shell = reader.string("shell", "");
        h.arc_fraction = reader.number("arc_fraction", h.arc_fraction, {0.0, 1.0});
        h.kind = reader.choice("kind", {"clamp", "pin"}, 0) == 0 ? HoldKind::Clamp : HoldKind::Pin;
        h.base = readBase(reader);
        reader.finish();
        const std::optional<Node> shell = reader.find("shell");
        if (shell && shell->kind() == Node::Kind::String &&
            std::find(names.begin(), names.end(), h.shell) == names.end())
            context.error(*shell, reader.pointerTo("shell"), "there is no shell named \"" + h.shell + "\"",
                          names.empty() ? "a shell with a name" : "", nearestName(h.shell, names));
        out.push_back(std::move(h));
    }
}

void readDrop(Context& context, ObjectReader& top, std::optional<Drop>& out) {
    const std::optional<Node> node = top.find("drop");
    if (!node)
        return;
    ObjectReader reader(context, *node, "/drop");
    reader.renamed("together", "batch_size");
    Drop drop;
    if (reader.require("shell", "the shell to drop"))
        if (const std::optional<Node> shell = reader.find("shell"))
            drop.shell = readShell(context, *shell, "/drop/shell", true);
    drop.count = static_cast<int>(reader.integer("count", drop.count, 1, 100000));
    const std::size_t before = context.errors();
    reader.require("x_min", "a number, m");
    reader.require("x_max", "a number, m");
    drop.batch_size = static_cast<int>(reader.integer("batch_size", drop.batch_size, 1, 100000));
    drop.x_min = reader.number("x_min", drop.x_min);
    drop.x_max = reader.number("x_max", drop.x_max);
    if (context.errors() == before && drop.x_min > drop.x_max)
        context.error(*reader.find("x_min"), "/drop/x_min", "the horizontal range of the drop is empty",
                      "x_min <= x_max");
    drop.clearance = reader.number("clearance", drop.clearance, notNegative);
    drop.settle_speed = reader.number("settle_speed", drop.settle_speed, positive);
    drop.settle_time = reader.number("settle_time", drop.settle_time, positive);
    drop.final_settle_speed = reader.number("final_settle_speed", drop.final_settle_speed, positive);
    drop.final_settle_time = reader.number("final_settle_time", drop.final_settle_time, notNegative);
    drop.adaptive = reader.boolean("adaptive", drop.adaptive);
    reader.finish();
    out = std::move(drop);
}

} // namespace supercircle::scene
