// The nearest known name: distances counted by hand.

#include "supercircle/support/names.h"

#include <catch2/catch.hpp>

using namespace supercircle;

TEST_CASE("the nearest name is the one with the least typing errors") {
    CHECK(nearestName("frcition", {"friction", "fiction", "fraction"}) == "friction"); // one swap
    CHECK(nearestName("MU", {"nu", "mu"}) == "mu");
    CHECK(nearestName("speed", {"angle", "mu"}).empty());
    CHECK(nearestName("", {"a"}).empty());
    CHECK(nearestName(std::string(100000, 'a'), {std::string(100000, 'b')}).empty());
    CHECK(nearestName("pat", {"bat", "cat"}) == "bat"); // a tie goes to the first
}

TEST_CASE("at most a third of the letters may differ, and of two or three one") {
    CHECK(nearestName("abcdef", {"abcdXY"}) == "abcdXY");
    CHECK(nearestName("abcde", {"abcXY"}).empty());
    CHECK(nearestName("ab", {"ac"}) == "ac");
    CHECK(nearestName("abc", {"aXY"}).empty());
    CHECK(nearestName("a", {"b"}).empty()); // nothing of it is left
    CHECK(nearestName("a", {"b", "A"}) == "A");
    CHECK(nearestName("a", {"bc"}).empty());
}

TEST_CASE("a message ends with the nearest name, or with nothing") {
    CHECK(didYouMean("kye", {"key"}) == "; did you mean \"key\"?");
    CHECK(didYouMean("kye", {"door"}).empty());
}
