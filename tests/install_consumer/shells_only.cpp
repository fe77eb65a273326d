// Shells without Box2D: a shell alone in space stays at rest.
#include <supercircle/shells.hpp>

int main() {
    supercircle::Shells shells(nullptr);
    const auto shell = shells.create(supercircle::ShellDef{});
    const auto report = shells.pre_step(0.01);
    shells.post_step().or_fail();
    return shell && report.failure.empty() && shells.pose(*shell)->bending_energy < 1e-20 ? 0 : 1;
}
