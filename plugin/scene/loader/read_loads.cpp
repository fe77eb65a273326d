#include "plugin/scene/loader/sections.h"
#include "supercircle/support/names.h"

#include <algorithm>

namespace supercircle::scene {

void readLoads(Context& context, ObjectReader& top, Scene& scene) {
    scene.starts_at_rest = top.choice("start", {"as_placed", "at_rest"}, 0) == 1;
    std::vector<std::string> names;
    for (const ShellDef& d : scene.shells)
        if (!d.name.empty())
            names.push_back(d.name);
    for (const ArrayItem& place : top.array("load")) {
        ObjectReader reader(context, place.node, place.pointer);
        if (!reader.valid())
            continue;
        PointLoad load;
        reader.require("shell", "the name of a shell");
        load.shell = reader.string("shell", "");
        load.arc_fraction = reader.number("arc_fraction", load.arc_fraction, {0.0, 1.0});
        const Eigen::Vector2d force = reader.vector("force_N", Eigen::Vector2d::Zero());
        load.force = {force.x(), force.y()};
        load.moment = reader.number("moment_N_m", 0.0);
        load.released = reader.boolean("released", false);
        reader.finish();
        const std::optional<Node> shell = reader.find("shell");
        if (shell && shell->kind() == Node::Kind::String &&
            std::find(names.begin(), names.end(), load.shell) == names.end())
            context.error(*shell, reader.pointerTo("shell"), "there is no shell named \"" + load.shell + "\"",
                          names.empty() ? "a shell with a name" : "", nearestName(load.shell, names));
        if (load.released && !scene.starts_at_rest)
            context.error(place.node, reader.pointerTo("released"), "there is nothing from which it is released",
                          "\"start\": \"at_rest\"");
        scene.loads.push_back(std::move(load));
    }
}

} // namespace supercircle::scene
