// Cached runs: torn files, full disks, other programs.

#include "toy.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>

using namespace supercircle::diagnosis;

TEST_CASE("cached runs are restored bitwise, torn entries are dropped", "[diagnosis]") {
    const std::string file = std::string(SC_BINARY_DIR) + "/simulations.cache";
    std::filesystem::remove(file);
    Response r;
    r.force = Eigen::VectorXd::LinSpaced(7, 0.0, 1.0 / 3.0);
    r.markers.resize(0);
    {
        SimulationCache cache;
        REQUIRE(cache.open(file, "a").empty());
        cache.insert("one", r);
        cache.insert("two", r);
    }
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
    {
        SimulationCache cache;
        REQUIRE(cache.open(file, "a").empty());
        REQUIRE(cache.find("one").has_value());
        CHECK(cache.find("one")->force == r.force);
        CHECK_FALSE(cache.find("two").has_value());
        cache.insert("two", r);
    }
    SimulationCache cache;
    REQUIRE(cache.open(file, "a").empty());
    CHECK(cache.loadedFromFile() == 2);
    SimulationCache other;
    REQUIRE(other.open(file, "another experiment").empty());
    CHECK(other.loadedFromFile() == 0);
}

TEST_CASE("a full disk loses later entries only and is reported", "[diagnosis]") {
    const std::string file = std::string(SC_BINARY_DIR) + "/full.cache";
    std::filesystem::remove(file);
    Response r;
    r.force = Eigen::VectorXd::LinSpaced(100, 0.0, 1.0);
    {
        SimulationCache cache;
        REQUIRE(cache.open(file, "a").empty());
        cache.insert("one", r);
        // A file size limit represents a full disk; its signal would end the program.
        struct rlimit before {};
        REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
        const auto handler = std::signal(SIGXFSZ, SIG_IGN);
        struct rlimit full = before;
        full.rlim_cur = std::filesystem::file_size(file) + 300;
        REQUIRE(setrlimit(RLIMIT_FSIZE, &full) == 0);
        cache.insert("two", r);
        REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
        std::signal(SIGXFSZ, handler);
        CHECK(cache.failure().find("full.cache: cannot be written: ") != std::string::npos);
        cache.insert("three", r);
        CHECK(cache.find("two").has_value()); // in memory
        CHECK(cache.find("three").has_value());
    }
    SimulationCache cache;
    REQUIRE(cache.open(file, "a").empty());
    CHECK(cache.loadedFromFile() == 1);
    cache.insert("four", r);
    CHECK(cache.failure().empty());
    SimulationCache again;
    REQUIRE(again.open(file, "a").empty());
    CHECK(again.loadedFromFile() == 2);
}

TEST_CASE("runs cached by another program are discarded", "[diagnosis]") {
    /// A spring whose last run has a marker, at another position in another program.
    struct Marked final : toy::Spring {
        double at;
        Marked(const RecordedData& data, double place) : Spring(data), at(place) {}
        void alter(std::size_t r, const ParameterPoint&, Response& out) const override {
            if (r == 2)
                out.markers = Eigen::Vector4d(at, std::nan(""), 0.0, 0.0);
        }
    };
    const RecordedData data = toy::recordings(17), longer = toy::recordings(17, {}, 0.0, 40.0);
    REQUIRE(data.runs.size() == 3);
    const Marked here(data, 0.25), elsewhere(data, 0.5), slower(longer, 0.25);
    const ParameterPoint point{{100.0, 0.1}, {}};
    const SimulationRequest last{2, point, Fidelity::Coarse};
    const auto checked = [&](const Model& later) {
        SimulationCache cache;
        Evaluator(here, 3, {}, cache).simulateAllRuns({point}, Fidelity::Coarse);
        Evaluator again(later, 3, {}, cache);
        again.checkCache(point, Fidelity::Coarse);
        return again.simulate({last}).front();
    };
    CHECK(checked(here).markers[0] == 0.25);
    CHECK(checked(elsewhere).markers[0] == 0.5);
    CHECK(checked(slower).force.size() == longer.runs[2].force.size());
}
