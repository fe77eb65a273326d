// All worlds of the process.

#include "bridge/c/world.h"

#include <array>
#include <atomic>

namespace supercircle::c {

namespace {

struct Registry {
    std::mutex lock;
    std::array<std::shared_ptr<World>, kMostWorlds> worlds; ///< slot 0 stays empty
};

/// Never destroyed: programs may call during their end.
Registry& registry() {
    static auto* const all = new Registry;
    return *all;
}

std::shared_ptr<World> at(std::uint32_t slot) {
    Registry& all = registry();
    const std::lock_guard lock(all.lock);
    return slot < kMostWorlds ? all.worlds[slot] : nullptr;
}

[[noreturn]] void failAsException(const char* file, int line, std::string_view message) {
    throw AssertionFailed(std::string(file) + ":" + std::to_string(line) + ": " + std::string(message) +
                          " (an error of the library: please report it; destroy this world)");
}

/// Once a process, before anything can fail.
void installFailureHandler() {
    static const FailureHandler before = set_failure_handler(
        [](const char* file, int line, std::string_view message) { failAsException(file, line, message); });
    (void)before;
}

constexpr const char* kStaleWorld = "the world handle is null or stale: there is no such world, or it was destroyed";

std::unique_ptr<b2World> newWorld(const sc_world_def& d) {
    const double s = d.units_per_metre;
    return std::make_unique<b2World>(b2Vec2(static_cast<float>(d.gravity.x * s), static_cast<float>(d.gravity.y * s)));
}

void requireUsable(const sc_world_def& d) {
    requireChoice(d.quality, 2, "quality");
    if (!(d.units_per_metre > 1e-3 && d.units_per_metre < 1e5))
        refuse(SC_BAD_INPUT, "units_per_metre must lie between 0.001 and 100000");
    requireFinite(d.gravity, "gravity");
    if (std::abs(d.gravity.x) > 1e6 || std::abs(d.gravity.y) > 1e6)
        refuse(SC_BAD_INPUT, "gravity is above 1e6 m/s^2");
    if (d.velocity_iterations < 1 || d.velocity_iterations > 1000 || d.position_iterations < 1 ||
        d.position_iterations > 1000)
        refuse(SC_BAD_INPUT, "iterations of Box2D must be 1 to 1000");
}

} // namespace

std::uint32_t nextGeneration() noexcept {
    static std::atomic<std::uint32_t> last{0};
    std::uint32_t next = 0;
    while (next == 0)
        next = ++last;
    return next;
}

World::World(std::uint32_t slot, std::unique_ptr<b2World> owned, b2World& world, double unitsPerMetre)
    : own(std::move(owned)), box2d(&world), scale(unitsPerMetre), attachment(bridge::attach(world, {unitsPerMetre})),
      shells(attachment), shellNames(slot), holdNames(slot), jointNames(slot), forceNames(slot), bodyNames(slot),
      springs(slot), zones(slot), scenes(slot) {}

sc_world enlist(const sc_world_def* def, b2World* host) {
    installFailureHandler();
    const sc_world_def d = versioned(def, sc_world_def_init, sizeof(sc_world_def), "sc_world_def_init");
    requireUsable(d);
    std::unique_ptr<b2World> own = host == nullptr ? newWorld(d) : nullptr;
    b2World& world = host == nullptr ? *own : *host;
    Registry& all = registry();
    const std::lock_guard lock(all.lock);
    for (std::uint32_t slot = 1; slot < kMostWorlds; ++slot) {
        if (all.worlds[slot])
            continue;
        auto made = std::make_shared<World>(slot, std::move(own), world, d.units_per_metre);
        done(made->shells.set_quality(static_cast<Quality>(d.quality)));
        done(made->shells.set_threads(d.threads));
        made->velocityIterations = d.velocity_iterations;
        made->positionIterations = d.position_iterations;
        made->id = makeId(slot, 0, nextGeneration());
        all.worlds[slot] = std::move(made);
        return {all.worlds[slot]->id};
    }
    refuse(SC_REFUSED, "there are " + std::to_string(kMostWorlds - 1) + " worlds already: destroy some");
}

Inside::Inside(std::uint32_t slot, std::uint64_t id) : world_(at(slot)) {
    if (!world_ || (id != 0 && world_->id != id))
        refuse(SC_STALE, kStaleWorld);
    lock_ = std::unique_lock(world_->busy, std::try_to_lock);
    if (!lock_)
        refuse(SC_BUSY, "another thread is in this world: use a world in one thread at a time");
    if (world_->gone)
        refuse(SC_STALE, kStaleWorld);
    if (!world_->broken.empty())
        refuse(SC_FAILED, world_->broken);
}

void strike(sc_world w) {
    const std::shared_ptr<World> world = at(worldSlot(w.id));
    if (!world || world->id != w.id)
        refuse(SC_STALE, kStaleWorld);
    const std::unique_lock lock(world->busy, std::try_to_lock);
    if (!lock)
        refuse(SC_BUSY, "another thread is in this world: destroy it when that thread has left");
    if (world->gone)
        refuse(SC_STALE, kStaleWorld);
    if (world->own == nullptr && world->box2d->IsLocked())
        refuse(SC_REFUSED, "the host's world is inside its step");
    world->gone = true;
    Registry& all = registry();
    const std::lock_guard guard(all.lock);
    all.worlds[worldSlot(w.id)] = nullptr;
}

} // namespace supercircle::c
