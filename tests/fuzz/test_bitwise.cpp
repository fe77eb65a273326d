// State hashes of one scene, for comparing compilers, optimisation levels and systems (docs/reference/determinism.md):
//
//     tests/test_fuzz '[bitwise]'
//
// prints one hash a line. The other test compares numbers of threads within one build.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/support/tumble.h"

#include <catch2/catch.hpp>
#include <cstdio>

using namespace supercircle;
using namespace supercircle::test;

namespace {

std::vector<std::uint64_t> tumble(int threads, Quality quality) {
    auto host = tumbleHost();
    Shells shells(host);
    REQUIRE(shells.set_quality(quality));
    shells.stepper().settings().threads = threads;
    addTumblers(shells);
    std::vector<std::uint64_t> hashes;
    for (int f = 1; f <= 300; ++f) {
        REQUIRE(tumbleFrame(shells, *host));
        if (f % 100 == 0)
            hashes.push_back(shells.hash());
    }
    return hashes;
}

} // namespace

TEST_CASE("bitwise identical states from one, two and four threads", "[fuzz]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        const std::vector<std::uint64_t> one = tumble(1, quality);
        CHECK(tumble(2, quality) == one);
        CHECK(tumble(4, quality) == one);
    }
}

TEST_CASE("hashes to compare", "[.bitwise]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game})
        for (const std::uint64_t hash : tumble(1, quality))
            std::printf("%016llx\n", static_cast<unsigned long long>(hash));
}
