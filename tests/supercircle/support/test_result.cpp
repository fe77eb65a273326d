// Results and assertions: a broken promise reaches the handler, with its place.

#include "supercircle/support/failure.h"
#include "supercircle/support/result.h"

#include <catch2/catch.hpp>
#include <stdexcept>
#include <string>

using namespace supercircle;

namespace {

struct Broken : std::runtime_error {
    using std::runtime_error::runtime_error;
};

[[noreturn]] void throwing(const char* file, int line, std::string_view message) {
    throw Broken(std::string(file) + ":" + std::to_string(line) + ": " + std::string(message));
}

/// Replaces the handler for the life of a test.
struct Handler {
    FailureHandler before = set_failure_handler(throwing);
    ~Handler() { set_failure_handler(before); }
};

} // namespace

TEST_CASE("a result holds a value or the reason why there is none") {
    const Result<int> good = 3;
    CHECK(good);
    CHECK(*good == 3);
    CHECK(good.error().empty());
    const auto bad = Result<int>::failure("the radius is negative");
    CHECK_FALSE(bad);
    CHECK(bad.error() == "the radius is negative");
    Result<std::string> text = std::string("abc");
    CHECK(text->size() == 3);
    *text += "d";
    CHECK(std::move(text).value() == "abcd");
    CHECK(Status());
    CHECK(Status::failure("").error().empty());
    CHECK_FALSE(Status::failure(""));
}

TEST_CASE("reading the value of a failed result calls the handler with the reason") {
    const Handler handler;
    const auto bad = Result<std::string>::failure("the radius is negative");
    CHECK_THROWS_WITH(bad.value(), Catch::Contains("the radius is negative"));
    CHECK_THROWS_AS(*bad, Broken);
    CHECK_THROWS_AS(bad->size(), Broken);
    CHECK_THROWS_WITH(bad.or_fail(), Catch::Contains("test_result.cpp:") && Catch::Contains("the radius is negative"));
    CHECK_NOTHROW(Result<int>(3).or_fail());
}

TEST_CASE("an assertion that does not hold calls the handler with its place") {
    const Handler handler;
    const int n = 2;
    CHECK_NOTHROW([&] { SC_ASSERT(n == 2, "two"); }());
    CHECK_THROWS_WITH([&] { SC_ASSERT(n == 3, "there are three"); }(), Catch::Contains("test_result.cpp:") &&
                                                                           Catch::Contains("n == 3") &&
                                                                           Catch::Contains("there are three"));
}

TEST_CASE("the handler can be taken back") {
    const FailureHandler first = set_failure_handler(throwing);
    CHECK(set_failure_handler(first) == throwing);
}
