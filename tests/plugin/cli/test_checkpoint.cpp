// `run --checkpoint` and `--resume`.

#include "tests/plugin/cli/program.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <regex>

using namespace supercircle::test;
using Catch::Contains;

namespace {

/// summary.json without its machine-dependent values.
std::string withoutTiming(const std::string& summary) {
    return std::regex_replace(summary, std::regex("\"timing\": *\\{[^}]*\\}"), "");
}

} // namespace

TEST_CASE("an interrupted run continues to the same bytes", "[cli][checkpoint]") {
    const Folder folder;
    const std::vector<std::string> common = {"run",     scene("stack30"), "--param",     "shells=4",
                                             "--param", "max_force=0.5",  "--no-report", "--quiet"};
    const auto with = [&](const std::string& out, const std::vector<std::string>& more) {
        std::vector<std::string> all = common;
        all.insert(all.end(), {"--out", folder / out});
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    REQUIRE(start(with("whole", {})).code == 0);
    CommandResult r;
    for (const int signal : {SIGINT, SIGTERM}) {
        Start how;
        how.signal = signal;
        how.signalAfter = 0.2;
        r = start(with("parts", {"--checkpoint", "0.01", "--resume"}), how);
        if (signal == SIGINT)
            CHECK_THAT(r.err, Contains("there is no checkpoint") && Contains("starts from the beginning"));
        CAPTURE(r.err);
        REQUIRE((r.code == 130 || r.code == 0)); // a fast machine may be done
        if (r.code == 130)
            CHECK_THAT(r.err, Contains("--resume continues"));
    }
    if (r.code == 130) {
        CHECK(std::filesystem::exists(folder / "parts/checkpoint.state"));
        // Neither a new run nor another one touches it.
        r = start(with("parts", {"--checkpoint", "1"}));
        CHECK(r.code == 2);
        CHECK_THAT(r.err, Contains("continue it with --resume"));
        r = start(with("parts", {"--param", "mu=0.3", "--seed", "2", "--resume"}));
        CHECK(r.code == 2);
        CHECK_THAT(r.err, Contains("--seed (1 there, 2 here)") && Contains("parameter mu (0.35 there, 0.3 here)"));
        r = start(with("parts", {"--resume"}));
        CAPTURE(r.err);
        REQUIRE(r.code == 0);
    }
    CHECK_FALSE(std::filesystem::exists(folder / "parts/checkpoint.state"));
    CHECK((contentOf(folder / "parts/series.csv") == contentOf(folder / "whole/series.csv")));
    CHECK((contentOf(folder / "parts/trajectory.json") == contentOf(folder / "whole/trajectory.json")));
    CHECK(withoutTiming(contentOf(folder / "parts/summary.json")) ==
          withoutTiming(contentOf(folder / "whole/summary.json")));
}
