#include "plugin/scene/loader/loader.h"

#include "plugin/scene/loader/sections.h"

#include <algorithm>
#include <filesystem>

namespace supercircle::scene {

namespace {

constexpr const char* schemaName = "supercircle-scene/1";

/// A rigid world without "schema" is an export of R.U.B.E. or b2dJson, which leave out what is zero.
void recogniseExport(Context& context, ObjectReader& top) {
    const std::optional<Node> world = top.find("body") ? top.find("body") : top.find("joint");
    context.rubeExport = world && !top.find("schema");
    const auto keys = {"shell", "hold", "drop", "protocol", "game", "parameters", "constants", "lengthScale"};
    if (context.rubeExport &&
        std::any_of(keys.begin(), keys.end(), [&](const char* key) { return top.find(key).has_value(); }))
        context.note(*world, top.pointerTo(world->key()),
                     "no \"schema\": absent keys of bodies and \"gravity\" are zeros, as R.U.B.E. exports mean them; "
                     "a scene has \"schema\": \"" +
                         std::string(schemaName) + "\"");
}

void checkSchema(Context& context, ObjectReader& top) {
    const std::optional<Node> node = top.find("schema");
    if (!node)
        return;
    const std::string name = top.string("schema", schemaName);
    if (name != schemaName)
        context.error(*node, "/schema", "this is \"" + name + "\", not a scene of this version",
                      std::string("\"") + schemaName + "\"");
}

/// Shells bounce by their own elasticity: the same key of fixtures is a property of bodies among themselves.
void noteRestitution(Context& context, ObjectReader& top, const Scene& scene) {
    const auto bounces = [](const step::BodyDefinition& b) {
        return std::any_of(b.fixtures.begin(), b.fixtures.end(), [](const step::FixtureDefinition& f) {
            return f.restitution > 0.0 && !f.sensor && f.filterMaskBits != 0;
        });
    };
    const bool shells = !scene.shells.empty() || scene.drop;
    const std::optional<Node> bodies = top.find("body");
    if (shells && bodies && std::any_of(scene.rigid.bodies.begin(), scene.rigid.bodies.end(), bounces))
        context.note(*bodies, "/body",
                     "shells ignore \"restitution\" of fixtures; it acts between bodies only "
                     "(docs/how-to/rigid_bodies_and_limits.md)");
}

void readTop(Context& context, const std::vector<Override>& overrides, std::optional<double> fragmentOf, Scene& scene) {
    ObjectReader top(context, context.document.root(), "");
    if (!top.valid())
        return;
    if (const std::optional<Node> project = top.find("metaworld")) {
        context.keyError(*project, "/metaworld", "this is a R.U.B.E. project",
                         "a scene: open the project in R.U.B.E., export it as JSON and load that file");
        return;
    }
    checkSchema(context, top);
    recogniseExport(context, top);
    const std::optional<Node> parameters = top.find("parameters");
    context.scope.declare(context, parameters, top.find("constants"), overrides);
    scene.name = top.string("name", std::filesystem::path(scene.file).stem().string());
    if (context.document.root().find("about"))
        scene.about = top.string("about", "");
    scene.rigid.lengthScale = top.number("lengthScale", fragmentOf.value_or(scene.rigid.lengthScale), positive);
    readRigid(context, top, scene.rigid);
    readShells(context, top, scene.shells);
    readHolds(context, top, scene.shells, scene.holds);
    readLoads(context, top, scene);
    readDrop(context, top, scene.drop);
    readProtocol(context, top, scene, scene.protocol);
    readObservations(context, top, scene);
    readEffects(context, top, scene);
    readNumerics(context, top, scene.numerics);
    readReport(context, top, scene.report);
    readGame(context, top, scene, scene.game);
    scene.duration = top.number("duration", scene.duration, notNegative);
    noteRestitution(context, top, scene);
    top.finish();
    if (!fragmentOf && !scene.protocol && !scene.game && scene.duration == 0.0)
        context.note(context.document.root(), "", "neither \"protocol\" nor \"duration\": no time is simulated");
    scene.parameters = context.scope.parameters();
}

} // namespace

Result<Scene> loadText(const std::string& text, const std::string& file, const std::vector<Override>& overrides,
                       std::vector<Problem>& problems, std::optional<double> fragmentOf) {
    std::vector<Problem> found;
    Scene scene;
    if (const auto document = parseDocument(text, file, found)) {
        Scope scope;
        Context context{*document, found, scope};
        scene.file = file;
        readTop(context, overrides, fragmentOf, scene);
    }
    problems.insert(problems.end(), found.begin(), found.end());
    return anyError(found) ? Result<Scene>::failure(errorText(found)) : Result<Scene>(std::move(scene));
}

bool isMechanism(const Scene& scene) {
    return std::any_of(scene.rigid.joints.begin(), scene.rigid.joints.end(),
                       [](const step::JointDefinition& j) { return j.spring.on() || j.friction.sticking > 0.0; });
}

Result<Scene> load(const std::string& path, const std::vector<Override>& overrides, std::vector<Problem>& problems) {
    const auto text = readFile(path, problems);
    return text ? loadText(*text, path, overrides, problems) : Result<Scene>::failure(text.error());
}

} // namespace supercircle::scene
