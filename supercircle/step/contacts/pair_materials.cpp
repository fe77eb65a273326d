#include "supercircle/step/contacts/pair_materials.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

double mixedFriction(double a, double b) {
    return std::sqrt(std::max(0.0, a) * std::max(0.0, b));
}

} // namespace

std::uint32_t materialOf(const World& world, BodyId id) {
    const auto it = std::lower_bound(world.bodyMaterials.begin(), world.bodyMaterials.end(), id,
                                     [](const BodyMaterial& b, BodyId want) { return b.body < want; });
    return it != world.bodyMaterials.end() && it->body == id ? it->material : 0;
}

double surfaceSpeedOf(const World& world, const BodyOutline& piece) {
    const auto before = [](const SurfaceSpeed& s, const SurfaceSpeed& want) {
        return s.body != want.body ? s.body < want.body : s.fixture < want.fixture;
    };
    for (const std::uint32_t fixture : {piece.fixture, kAllFixtures}) {
        const auto it = std::lower_bound(world.surfaceSpeeds.begin(), world.surfaceSpeeds.end(),
                                         SurfaceSpeed{piece.body, fixture, 0.0}, before);
        if (it != world.surfaceSpeeds.end() && it->body == piece.body && it->fixture == fixture)
            return it->speed;
    }
    return 0.0;
}

double frictionOf(const World& world, std::uint32_t a, double muA, std::uint32_t b, double muB) {
    if (a != 0 && b != 0) {
        const PairFriction want{std::min(a, b), std::max(a, b), 0.0};
        const auto it = std::lower_bound(
            world.pairFriction.begin(), world.pairFriction.end(), want,
            [](const PairFriction& x, const PairFriction& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
        if (it != world.pairFriction.end() && it->a == want.a && it->b == want.b)
            return it->mu;
    }
    return mixedFriction(muA, muB);
}

} // namespace supercircle::step
