// Random calls of the C interface: no crash, no exception, each refusal with a status and a sentence and without a
// change, no energy that nobody gave. The test tagged [slow] makes a million calls; with the sanitizers it tests
// memory. A failure names its seed; to repeat it: SUPERCIRCLE_FUZZ_SEED=N SUPERCIRCLE_FUZZ_CALLS=1 tests/test_c
// '[slow]'.

#include "tests/bridge/c/caller.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <limits>
#include <random>

using namespace supercircle::fuzz;

namespace {

constexpr std::int32_t kMostShells = 5, kMostBodies = 8; ///< of a world, to bound the time
constexpr std::size_t kMostWorlds = 3;

struct Totals {
    std::uint64_t calls = 0, refused = 0, frames = 0, alarms = 0, restored = 0;
    std::string violation;
};

class Session {
public:
    explicit Session(const std::vector<std::uint8_t>& data) : bytes_(data), caller_(bytes_) {}
    ~Session() {
        for (const std::uint64_t id : caller_.pool(Kind::World))
            sc_world_destroy({id});
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    Totals play() {
        caller_.call("sc_world_create", sc_world_create);
        while (!bytes_.empty() && caller_.violation.empty() && totals_.violation.empty())
            act();
        totals_.calls += caller_.calls;
        totals_.refused += caller_.refused;
        if (totals_.violation.empty())
            totals_.violation = caller_.violation;
        if (!totals_.violation.empty())
            totals_.violation += " (the last calls" + caller_.history + ")";
        return totals_;
    }

private:
    void act() {
        const std::uint32_t choice = bytes_.below(16);
        if (choice < 3)
            step();
        else if (choice < 4)
            caller_.call("sc_shell_create", sc_shell_create);
        else if (choice < 5)
            saveOrRestore();
        else
            any();
        limit();
    }

    sc_world world() { return {caller_.handle(Kind::World)}; }

    /// Any call. One that is refused may not change the world it names; that is asked of some.
    void any() {
        struct Call {
            const char* name;
            void (*make)(Caller&);
        };
        static const Call kCalls[] = {
#define CALL(name) {#name, [](Caller& c) { c.call(#name, name); }},
#include "tests/bridge/c/calls.inc"
#undef CALL
        };
        const Call& call = kCalls[bytes_.below(static_cast<std::uint32_t>(std::size(kCalls)))];
        const std::string name = call.name;
        // Frames are made by step(); threads beyond the cores and frames of a second only take time.
        if (name == "sc_world_step" || name == "sc_scene_step" || name == "sc_world_set_threads")
            return;
        const bool asked = bytes_.chance(60) && !caller_.pool(Kind::World).empty();
        const sc_world w{asked ? caller_.pool(Kind::World).front() : 0};
        const std::uint64_t before = asked ? sc_world_hash(w) : 0;
        call.make(caller_);
        const bool refused = *sc_error() != 0;
        // What was made of a scene before its last part was refused is taken back: another history, not another world.
        if (asked && refused && name != "sc_world_add" && name != "sc_scene_load" && sc_world_hash(w) != before)
            totals_.violation = name + " was refused, but the state has changed";
    }

    void step() {
        static constexpr double kOddTimes[] = {0.0,
                                               -1.0,
                                               1e-12,
                                               5e-324,
                                               1e3,
                                               1e300,
                                               std::numeric_limits<double>::quiet_NaN(),
                                               std::numeric_limits<double>::infinity()};
        const sc_world w = world();
        const std::int32_t quality = sc_world_quality(w);
        if (quality == SC_QUALITY_GAME)
            (void)sc_world_set_frame_budget(w, 1000);
        const double longest = quality == SC_QUALITY_GAME ? 2e-2 : 3e-4;
        const double dt = bytes_.chance(20) ? kOddTimes[bytes_.below(8)] : bytes_.number(1e-5, longest, 0);
        sc_frame frame{};
        const sc_scene scene{caller_.handle(Kind::Scene)};
        const bool plays = bytes_.chance(40) && sc_scene_valid(scene) == 1 && dt < 2e-2;
        const sc_status done = plays ? sc_scene_step(scene, dt, &frame) : sc_world_step(w, dt, &frame);
        ++totals_.calls;
        caller_.remember("frame " + std::to_string(dt));
        totals_.frames += done == SC_OK ? 1 : 0;
        totals_.alarms += frame.energy_gained > 0.0 && frame.unconverged == 0 && !hasEffects(w) ? 1 : 0;
        if (done != SC_OK && *sc_error() == 0)
            totals_.violation = "a frame failed without a sentence";
        sc_energy energy{};
        if (sc_world_energy(w, &energy) == SC_OK && !std::isfinite(energy.kinetic))
            totals_.violation = "the energy has bad numbers";
    }

    /// Presliding springs of effects give back energy that the alarm does not know.
    static bool hasEffects(sc_world w) {
        sc_shell shells[64];
        const std::int32_t count = sc_world_shells(w, shells, 64);
        for (std::int32_t i = 0; i < count; ++i)
            if (const char* effects = sc_shell_effects(w, shells[i]);
                effects != nullptr && std::string(effects) != "[]")
                return true;
        return false;
    }

    void saveOrRestore() {
        const sc_world w = world();
        totals_.calls += 2;
        if (saved_.empty() || bytes_.chance(128)) {
            saved_.resize(static_cast<std::size_t>(std::max(0, sc_world_save(w, nullptr, 0))));
            (void)sc_world_save(w, saved_.data(), static_cast<std::int32_t>(saved_.size()));
            return;
        }
        if (bytes_.chance(60))
            saved_[bytes_.below(static_cast<std::uint32_t>(saved_.size()))] ^= 4;
        const sc_status done = sc_world_restore(w, saved_.data(), static_cast<std::int32_t>(saved_.size()));
        totals_.restored += done == SC_OK ? 1 : 0;
        if (done == SC_FAILED)
            totals_.violation = std::string("restore failed: ") + sc_error();
    }

    /// Keeps worlds small and few.
    void limit() {
        std::vector<std::uint64_t>& worlds = caller_.pool(Kind::World);
        std::erase_if(worlds, [](std::uint64_t id) { return sc_world_valid({id}) == 0; });
        while (worlds.size() > kMostWorlds) {
            sc_world_destroy({worlds.front()});
            worlds.erase(worlds.begin());
        }
        if (worlds.empty())
            caller_.call("sc_world_create", sc_world_create);
        for (const std::uint64_t id : worlds) {
            sc_shell shells[64];
            for (std::int32_t n = sc_world_shells({id}, shells, 64); n > kMostShells; --n)
                sc_shell_destroy({id}, shells[n - kMostShells]);
            sc_body bodies[64];
            for (std::int32_t n = sc_world_bodies({id}, bodies, 64); n > kMostBodies; --n)
                sc_body_destroy({id}, bodies[n - kMostBodies]);
        }
    }

    ByteSource bytes_;
    Caller caller_;
    Totals totals_;
    std::vector<std::uint8_t> saved_;
};

void play(std::uint64_t seed, Totals& all) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(20000);
    for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>(random() >> 56);
    INFO("seed " << seed << ", after " << all.calls << " calls of other sessions");
    const Totals t = Session(bytes).play();
    all.calls += t.calls;
    all.refused += t.refused;
    all.frames += t.frames;
    all.alarms += t.alarms;
    all.restored += t.restored;
    REQUIRE(t.violation == "");
}

std::uint64_t fromEnvironment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text && *text ? std::strtoull(text, nullptr, 10) : otherwise;
}

std::string summary(const Totals& t) {
    return std::to_string(t.calls) + " calls, " + std::to_string(t.refused) + " refused, " + std::to_string(t.frames) +
           " frames, " + std::to_string(t.restored) + " restored, " + std::to_string(t.alarms) + " energy alarms";
}

} // namespace

TEST_CASE("random calls of C violate no guarantee", "[c][fuzz]") {
    Totals all;
    for (std::uint64_t seed = 10; seed < 20; ++seed)
        play(seed, all);
    INFO(summary(all));
    CHECK(all.frames > 500); // otherwise they test little
    CHECK(all.refused < all.calls * 3 / 4);
    CHECK(all.restored > 5);
    CHECK(all.alarms == 0);
}

TEST_CASE("a million random calls of C", "[c][fuzz][slow]") {
    Totals all;
    const std::uint64_t wanted = fromEnvironment("SUPERCIRCLE_FUZZ_CALLS", 1000000);
    for (std::uint64_t seed = fromEnvironment("SUPERCIRCLE_FUZZ_SEED", 1000); all.calls < wanted; ++seed)
        play(seed, all);
    WARN(summary(all));
    CHECK(all.alarms <= all.calls / 100000);
}
