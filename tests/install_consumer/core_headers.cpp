// A program that looks behind the facade: the core's headers see the state as the library laid it out, and inline
// functions give the library's numbers.
#include <supercircle/rod/arc.h>
#include <supercircle/shells.hpp>
#include <supercircle/step/world.h>
#include <supercircle/support/elementary.h>
#include <utility>

int main() {
    supercircle::Shells shells(nullptr);
    supercircle::ShellDef def;
    def.position = {0.25, -0.5};
    const auto shell = shells.create(def);
    const supercircle::step::World& world = std::as_const(shells).world();
    const auto pose = shells.pose(*shell);
    const bool state = world.gravity.norm() == 0.0 && world.rods.size() == 1 && world.nextKey == 2 &&
                       world.crossheadTravel.norm() == 0.0 && world.nextPart == 1 && world.stopped.empty();
    const supercircle::rod::Arc arc{{0.0, 0.0}, 0.5, 2.0, 1.0};
    const bool numbers =
        (arc.tangentAt(0.0) - supercircle::rod::Vec2(supercircle::math::cos(0.5), supercircle::math::sin(0.5)))
            .norm() == 0.0;
    return shell && pose && state && numbers && alignof(supercircle::rod::Vec2) == alignof(double) ? 0 : 1;
}
