#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "plugin/recording/table/rounded.h"
#include "plugin/recording/table/text.h"

using namespace supercircle::record;

TEST_CASE("every double reads back bit for bit and no text is longer than 17 digits") {
    std::mt19937_64 random(7);
    for (int i = 0; i < 20000; ++i) {
        const auto value = std::bit_cast<double>(random());
        if (!std::isfinite(value))
            continue;
        std::string text;
        appendNumber(text, value);
        double back = 0.0;
        REQUIRE(parseNumber(text, back));
        REQUIRE(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(value));
        REQUIRE(text.size() <= 24); // sign, 17 digits, point, e-308
    }
}

TEST_CASE("the shortest text is chosen") {
    std::string text;
    appendNumber(text, 0.1);
    text += ' ';
    appendNumber(text, 0.1F);
    text += ' ';
    appendNumber(text, -std::nan(""));
    CHECK(text == "0.1 0.1 nan");
}

TEST_CASE("JSON numbers keep their type and are null when not finite") {
    std::string text;
    for (const double value : {5.0, -0.5, 1e22, std::nan(""), HUGE_VAL}) {
        appendJsonNumber(text, value);
        text += ' ';
    }
    CHECK(text == "5.0 -0.5 1e+22 null null ");
}

TEST_CASE("JSON strings escape what must be and replace what is not UTF-8") {
    std::string text;
    appendJsonString(text, std::string("a\"\\\n\x01\xC3\xBC\xFF\xC3", 9));
    CHECK(text == "\"a\\\"\\\\\\n\\u0001\xC3\xBC\\ufffd\\ufffd\"");
}

TEST_CASE("a text is split at every separator") {
    using Parts = std::vector<std::string>;
    CHECK(splitAt("a,b c,", ',') == Parts{"a", "b c", ""});
    CHECK(splitAt("a", ',') == Parts{"a"});
    CHECK(splitAt("", ',') == Parts{""});
}

TEST_CASE("only whole numbers are numbers") {
    double value = 0.0;
    for (const char* bad : {"", " 1", "1 ", "1,5", "0x10", "1e", "--1", "+-1", "1.5m"})
        CHECK_FALSE(parseNumber(bad, value));
    CHECK(parseNumber("+1.5e-3", value));
    CHECK(value == 1.5e-3);
    CHECK(parseNumber("nan", value));
    CHECK(std::isnan(value));
}

TEST_CASE("rounded numbers are what printf prints in the C locale") {
    for (const double v : {0.0, -0.0, 0.1, -2.5e-9, 1234567.0, 0.00012345, 99.95, 1.7976931348623157e308, -1e22,
                           std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        char expected[400];
        for (const int digits : {1, 3, 6}) {
            std::snprintf(expected, sizeof expected, "%.*g", digits, v);
            CHECK(rounded(v, digits) == expected);
            std::snprintf(expected, sizeof expected, "%.*f", digits - 1, v);
            CHECK(fixed(v, digits - 1) == expected);
        }
    }
}
