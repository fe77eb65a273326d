#include "plugin/scene/loader/sections.h"
#include "supercircle/support/names.h"

#include <algorithm>

namespace supercircle::scene {

namespace {

/// In the order of Observation::Quantity.
const std::vector<std::string> quantities = {"angle", "x",  "y",  "spin",  "vx",    "vy",
                                             "alpha", "ax", "ay", "force", "travel"};

/// The name of a body or shell under `key`.
std::string readTarget(Context& context, ObjectReader& reader, const char* key, const std::vector<std::string>& names) {
    reader.require(key, "the name of what is observed");
    const std::string target = reader.string(key, "");
    const std::optional<Node> node = reader.find(key);
    if (node && node->kind() == Node::Kind::String && std::find(names.begin(), names.end(), target) == names.end())
        context.error(*node, reader.pointerTo(key), "there is no " + std::string(key) + " named \"" + target + "\"", {},
                      nearestName(target, names));
    return target;
}

Observation readObservation(Context& context, const ArrayItem& place, const Scene& scene) {
    using Of = Observation::Of;
    using Quantity = Observation::Quantity;
    ObjectReader reader(context, place.node, place.pointer);
    Observation o;
    if (!reader.valid())
        return o;
    reader.require("name", "the name under which experiments refer to it");
    o.name = reader.string("name", "");
    reader.require("of", "\"body\", \"shell\" or \"machine\"");
    const std::vector<std::string> objects = {"body", "shell", "machine"};
    const std::size_t of = reader.choice("of", objects, objects.size());
    if (of == objects.size()) // the other keys depend on it
        return o;
    o.of = static_cast<Of>(of);
    reader.require("quantity", "what is observed");
    o.quantity = static_cast<Quantity>(reader.choice("quantity", quantities, 1));
    std::vector<std::string> names;
    if (o.of == Of::Body) {
        for (const step::BodyDefinition& b : scene.rigid.bodies)
            names.push_back(b.name);
        o.target = readTarget(context, reader, "body", names);
        const Eigen::Vector2d local = reader.vector("local_point_m", Eigen::Vector2d::Zero());
        o.local = {local.x(), local.y()};
    } else if (o.of == Of::Shell) {
        for (const ShellDef& d : scene.shells)
            names.push_back(d.name);
        o.target = readTarget(context, reader, "shell", names);
        o.arc_fraction = reader.number("arc_fraction", o.arc_fraction, {0.0, 1.0});
    }
    reader.finish();
    const bool ofPose = o.quantity == Quantity::Angle || o.quantity == Quantity::X || o.quantity == Quantity::Y;
    if (const std::optional<Node> node = reader.find("quantity"); node && o.of == Of::Shell && !ofPose) {
        context.error(*node, reader.pointerTo("quantity"), "of a shell only its place and direction are observed",
                      "\"x\", \"y\" or \"angle\"");
        return o;
    }
    const bool ofMachine = o.quantity == Quantity::Force || o.quantity == Quantity::Travel;
    if (const std::optional<Node> node = reader.find("quantity"); node && ofMachine != (o.of == Of::Machine))
        context.error(*node, reader.pointerTo("quantity"),
                      o.of == Of::Machine ? "a machine has no such quantity" : "only a machine has this quantity",
                      o.of == Of::Machine ? "\"force\" or \"travel\"" : "\"of\": \"machine\"");
    if (o.of == Of::Machine && !scene.protocol)
        context.error(place.node, place.pointer, "the scene has no machine", "a \"protocol\" that moves a body");
    return o;
}

} // namespace

void readObservations(Context& context, ObjectReader& top, Scene& scene) {
    for (const ArrayItem& place : top.array("observe")) {
        scene.observe.push_back(readObservation(context, place, scene));
        for (std::size_t i = 0; i + 1 < scene.observe.size(); ++i)
            if (scene.observe[i].name == scene.observe.back().name)
                context.error(place.node, place.pointer,
                              "there are two observations named \"" + scene.observe[i].name + "\"");
    }
}

} // namespace supercircle::scene
