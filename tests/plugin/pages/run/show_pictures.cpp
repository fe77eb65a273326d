#include <catch2/catch.hpp>

#include <cstdlib>

#include "plugin/pages/run/report.h"
#include "plugin/recording/table/writer.h"
#include "tests/plugin/pages/run/synthetic.h"

// For visual checks: SC_SHOW=dir test_pages "[.show]" writes the pictures of synthetic runs into dir.
TEST_CASE("pictures to look at", "[.show]") {
    const char* directory = std::getenv("SC_SHOW");
    REQUIRE(directory != nullptr);
    using namespace supercircle;
    const std::string base = directory;
    const auto save = [&](const record::Recording& recording, const std::string& name) {
        CHECK(pages::writeReport(recording, base + "/" + name).empty());
        CHECK(record::writeFiles(recording, base + "/" + name));
    };
    save(test::squeezedStack(30, 1500, 20000), "stack");
    save(test::squeezedStack(30, 240, 20000, 4), "cycles");
    save(test::squeezedStack(1000, 240, 2000), "thousand");
    save(test::squeezedStack(1, 60, 2000), "one");
    save(test::rollingRing(), "ring");
}
