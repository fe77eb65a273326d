// Random calls: no crash, no leak, no endless loop, no violated guarantee. With the sanitizers (cmake --preset asan)
// this tests memory safety. The short test plays fixed sessions; the one tagged [slow] plays sessions up to a million
// calls. A failure names its seed and the call; to repeat it, or to try others:
//
//     SUPERCIRCLE_FUZZ_SEED=N SUPERCIRCLE_FUZZ_CALLS=1 tests/test_fuzz '[slow]'            the session of seed N only
//     SUPERCIRCLE_FUZZ_SEED=N SUPERCIRCLE_FUZZ_CALLS=200000 tests/test_fuzz '[slow]'       from seed N on

#include "tests/fuzz/api_fuzzer.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <random>

using namespace supercircle;

namespace {

/// Equal bytes on every system (the standard specifies this generator).
std::vector<std::uint8_t> randomBytes(std::uint64_t seed, std::size_t length) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(length);
    for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>(random() >> 56);
    return bytes;
}

std::uint64_t fromEnvironment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text && *text ? std::strtoull(text, nullptr, 10) : otherwise;
}

void play(std::uint64_t seed, fuzz::Statistics& all) {
    INFO("seed " << seed << ", after " << all.calls << " calls of other sessions");
    all += fuzz::runSession(randomBytes(seed, 10000));
    REQUIRE(all.violation == "");
}

std::string summary(const fuzz::Statistics& t) {
    return std::to_string(t.calls) + " calls, " + std::to_string(t.failed) + " failed, " + std::to_string(t.frames) +
           " frames, " + std::to_string(t.events) + " events, " + std::to_string(t.replays) + " replays compared, " +
           std::to_string(t.alarms) + " energy alarms";
}

} // namespace

TEST_CASE("random calls violate no guarantee", "[fuzz]") {
    fuzz::Statistics all;
    for (std::uint64_t seed = 10; seed < 40; ++seed)
        play(seed, all);
    INFO(summary(all));
    CHECK(all.frames > 1000); // otherwise they test little
    CHECK(all.failed < all.calls * 2 / 3);
    CHECK(all.replays >= 5);
    CHECK(all.alarms == 0);
}

TEST_CASE("a million random calls", "[fuzz][slow]") {
    fuzz::Statistics all;
    const std::uint64_t wanted = fromEnvironment("SUPERCIRCLE_FUZZ_CALLS", 1000000);
    for (std::uint64_t seed = fromEnvironment("SUPERCIRCLE_FUZZ_SEED", 1000); all.calls < wanted; ++seed)
        play(seed, all);
    WARN(summary(all));
    CHECK(all.alarms <= all.calls / 100000);
}
