// Random calls: nothing crashes, leaks, hangs or lies. Under the sanitizers (cmake --preset asan) this is the test of
// memory safety. The short test plays the same sessions each time; the long one, tagged [slow], plays sessions until it
// has made a million calls. A failure names its seed; to repeat it, or to try others:
//
//     SUPERCIRCLE_FUZZ_SEED=N SUPERCIRCLE_FUZZ_CALLS=1 tests/test_fuzz '[slow]'            the session of seed N only
//     SUPERCIRCLE_FUZZ_SEED=N SUPERCIRCLE_FUZZ_CALLS=200000 tests/test_fuzz '[slow]'       from seed N on
//
// There is no shrinking: sessions are short, and a failure says at which call of the session it came.

#include "tests/fuzz/monkey.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <random>

using namespace supercircle;

namespace {

/// The same bytes on every machine (the standard fixes what this generator gives).
std::vector<std::uint8_t> tapeOf(std::uint64_t seed, std::size_t length) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> tape(length);
    for (std::uint8_t& byte : tape)
        byte = static_cast<std::uint8_t>(random() >> 56);
    return tape;
}

std::uint64_t fromEnvironment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text && *text ? std::strtoull(text, nullptr, 10) : otherwise;
}

void play(std::uint64_t seed, fuzz::Tally& all) {
    INFO("seed " << seed << ", after " << all.calls << " calls of other sessions");
    all += fuzz::play(tapeOf(seed, 10000));
    REQUIRE(all.broken == "");
}

std::string told(const fuzz::Tally& t) {
    return std::to_string(t.calls) + " calls, " + std::to_string(t.refused) + " refused, " + std::to_string(t.frames) +
           " frames, " + std::to_string(t.events) + " events, " + std::to_string(t.replays) + " replays compared";
}

} // namespace

TEST_CASE("random calls break no promise", "[fuzz]") {
    fuzz::Tally all;
    for (std::uint64_t seed = 10; seed < 40; ++seed)
        play(seed, all);
    INFO(told(all));
    CHECK(all.frames > 1000); // else they try nothing
    CHECK(all.refused < all.calls * 2 / 3);
    CHECK(all.replays >= 5);
}

TEST_CASE("a million random calls", "[fuzz][slow]") {
    fuzz::Tally all;
    const std::uint64_t wanted = fromEnvironment("SUPERCIRCLE_FUZZ_CALLS", 1000000);
    for (std::uint64_t seed = fromEnvironment("SUPERCIRCLE_FUZZ_SEED", 1000); all.calls < wanted; ++seed)
        play(seed, all);
    WARN(told(all));
}
