// Several worlds at the same time, and long-lived worlds.

#include "tests/plugin/api/support.h"

#include <thread>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Three shells that fall on each other; their coordinates at the end.
std::vector<double> story(double seconds) {
    auto host = groundHost(0.4);
    Shells shells(host);
    std::vector<double> coordinates;
    for (int i = 0; i < 3; ++i) {
        ShellDef d;
        d.phi_bar = 0.5;
        d.angle = M_PI + 0.1 * i;
        d.position = {0.002 * i, 0.03 + 0.025 * i};
        if (!shells.create(d))
            return {};
    }
    for (int i = 0; i < static_cast<int>(60.0 * seconds); ++i) {
        const FrameReport r = shells.pre_step(1.0 / 60.0);
        if (!r.failure.empty())
            return {};
        host->step(r.advanced);
        if (!shells.post_step())
            return {};
    }
    for (const step::Rod& r : shells.world().rods)
        coordinates.insert(coordinates.end(), r.q.data(), r.q.data() + r.q.size());
    return coordinates;
}

} // namespace

TEST_CASE("worlds on several threads do not influence each other", "[plugin]") {
    const std::vector<double> alone = story(0.5);
    REQUIRE_FALSE(alone.empty());
    std::vector<double> results[3];
    std::vector<std::thread> threads;
    for (auto& r : results)
        threads.emplace_back([&r] { r = story(0.5); });
    for (std::thread& t : threads)
        t.join();
    for (const auto& r : results)
        CHECK(r == alone); // bitwise
}

TEST_CASE("a million shells may be created and destroyed", "[plugin]") {
    auto host = groundHost(0.4);
    Shells shells(host);
    const auto low = [&](double x) {
        ShellDef d = strip(0.05, {x, 0.00025 + 1e-6}, 0.0, 100.0, 3);
        return *shells.create(d);
    };
    const ShellHandle first = low(0.0);
    shells.world().nextKey = (1u << 20) - 2; // as if nearly all keys had been used
    std::vector<ShellHandle> others;
    for (int i = 1; i < 6; ++i) {
        others.push_back(low(0.1 * i));
        advance(shells, host.get(), 0.01, 1); // contact detection wants distinct keys below 2^20
        if (i % 2 == 0) {
            REQUIRE(shells.destroy(others.front()));
            others.erase(others.begin());
        }
    }
    advance(shells, host.get(), 0.01, 20);
    CHECK(shells.size() == 1 + others.size());
    CHECK(shells.valid(first));
    for (const ShellHandle h : others)
        CHECK(shells.valid(h));
    for (const step::Rod& r : shells.world().rods)
        CHECK(r.kin.middle().y() == Approx(0.00025).margin(2e-6)); // all lie on the ground
}
