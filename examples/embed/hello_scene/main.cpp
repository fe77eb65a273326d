// Plays a JSON scene in your own loop: hello_scene [SCENE.json [NAME=VALUE ...]]. The scene's bodies are created in
// this program's b2World, its shells in this program's Shells.

#include <box2d/box2d.h>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <supercircle/box2d.hpp>
#include <supercircle/scene.hpp>

int main(int count, char** arguments) {
    const std::string path = count > 1 ? arguments[1] : "scenes/two_shells.json";
    supercircle::SceneOptions options;
    for (int i = 2; i < count; ++i) {
        const std::string text = arguments[i];
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) {
            std::fprintf(stderr, "\"%s\" is not NAME=VALUE\n", text.c_str());
            return 2;
        }
        options.parameters.emplace_back(text.substr(0, equals), std::strtod(text.c_str() + equals + 1, nullptr));
    }

    // Laboratory scenes are some centimetres large, Box2D's tolerances half a centimetre: one unit is 19.2 mm here.
    b2World world(b2Vec2(0.0f, 0.0f));
    supercircle::Shells shells(supercircle::bridge::attach(world, {52.1}));
    const auto loaded = supercircle::load_scene(path, shells, options);
    if (!loaded) {
        std::fprintf(stderr, "%s\n", loaded.error().c_str());
        return 2;
    }

    double largest = 0.0, nextLine = 0.0;
    for (supercircle::ScenePlayer scene = *loaded; !scene.finished();) {
        const auto frame = scene.pre_step(1.0 / 60.0);
        if (!frame.failure.empty()) {
            std::fprintf(stderr, "%s\n", frame.failure.c_str());
            return 3;
        }
        if (frame.advanced > 0.0)
            world.Step(static_cast<float>(frame.advanced), 8, 3);
        scene.post_step().or_fail();
        largest = scene.force() > largest ? scene.force() : largest;
        if (shells.time() < nextLine)
            continue;
        nextLine += 0.5;
        std::printf("t %6.2f s  %-10s %2zu shells  travel %7.2f mm  force %8.4f N\n", shells.time(),
                    scene.phase().c_str(), shells.size(), 1e3 * scene.travel(), scene.force());
    }
    std::printf("largest force %.4f N\n", largest);
    return 0;
}
