// Medians and quantiles of lists that are sorted by eye.

#include "supercircle/support/order_statistics.h"

#include <array>
#include <catch2/catch.hpp>

using namespace supercircle;

TEST_CASE("the upper median is the middle value, of an even number the upper one of two") {
    CHECK(upperMedian(std::vector<double>{5.0, -1.0, 3.0}) == 3.0);
    CHECK(upperMedian(std::vector<double>{4.0, 1.0, 3.0, 2.0}) == 3.0);
    CHECK(upperMedian(std::vector<double>{7.0}) == 7.0);
    CHECK(upperMedian(std::vector<double>{}) == 0.0);
    CHECK(upperMedian(std::array<double, 5>{9.0, 1.0, 8.0, 2.0, 3.0}) == 3.0);
}

TEST_CASE("the lower quantile is an entry of the list") {
    const std::vector<double> four = {40.0, 10.0, 30.0, 20.0};
    CHECK(lowerQuantile(four, 0.0) == 10.0);
    CHECK(lowerQuantile(four, 0.5) == 20.0);
    CHECK(lowerQuantile(four, 0.99) == 30.0);
    CHECK(lowerQuantile(four, 1.0) == 40.0);
    CHECK(lowerQuantile({}, 0.5) == 0.0);
}
