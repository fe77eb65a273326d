// The testbed is in examples/testbed, because it shares the framework of the games. A build without examples has none.

#include "plugin/cli/input.h"
#include "plugin/cli/subcommands.h"

#ifdef SC_HAS_TESTBED
#include "examples/testbed/testbed.h"
#endif

#include <cstdio>

namespace supercircle::cli {

int view(const ViewArguments& a) {
#ifdef SC_HAS_TESTBED
    std::vector<scene::Override> overrides;
    if (!readOverrides(a.parameters, overrides))
        return kBadInput;
    testbed::Arguments t;
    t.scene = a.scene;
    for (const scene::Override& o : overrides)
        t.parameters.emplace_back(o.name, o.value);
    t.game = a.game;
    t.headless = a.headless;
    t.frames = a.frames;
    t.png = a.png;
    t.wav = a.wav;
    t.script = a.script;
    t.show = a.show;
    t.record = a.record;
    t.interrupt = &interrupted;
    return testbed::view(t);
#else
    std::fprintf(stderr, "%s: this build has no testbed (examples were left out, or libimgui-dev is missing)\n",
                 a.scene.c_str());
    return kBadInput;
#endif
}

} // namespace supercircle::cli
