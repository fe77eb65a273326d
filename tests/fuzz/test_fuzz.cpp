// Random calls: nothing crashes, leaks, hangs or lies. Under the sanitizers (cmake --preset asan) this is the test of
// memory safety; a short session belongs to the normal tests, the long one has the tag [slow].

#include "tests/fuzz/monkey.h"

#include <rapidcheck/catch.h>

using namespace supercircle;

namespace {

/// A tape of `length` bytes; it shrinks to the shortest one that still breaks a promise.
rc::Gen<std::vector<std::uint8_t>> tapes(int length) {
    return rc::gen::container<std::vector<std::uint8_t>>(static_cast<std::size_t>(length),
                                                         rc::gen::arbitrary<std::uint8_t>());
}

} // namespace

TEST_CASE("random calls break no promise", "[fuzz]") {
    rc::prop("short sessions", [] {
        const auto tape = *tapes(4000);
        const fuzz::Tally t = fuzz::play(tape);
        RC_ASSERT(t.broken == "");
        RC_ASSERT(t.calls > 0u);
    });
}

TEST_CASE("a million random calls", "[fuzz][slow]") {
    fuzz::Tally all;
    std::uint64_t seed = 1;
    while (all.calls < 1000000 && all.broken.empty()) {
        std::vector<std::uint8_t> tape(20000);
        for (std::uint8_t& byte : tape) { // Marsaglia's xorshift: the same calls on every machine
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            byte = static_cast<std::uint8_t>(seed >> 32);
        }
        INFO("calls so far: " << all.calls);
        all += fuzz::play(tape);
        REQUIRE(all.broken == "");
    }
    WARN(all.calls << " calls, " << all.refused << " refused, " << all.frames << " frames, " << all.events
                   << " events");
}
