// Kept runs: torn files, full disks, other programs.

#include "toy.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>

using namespace supercircle::diagnosis;

TEST_CASE("kept runs come back bit for bit, torn ones do not", "[diagnosis]") {
    const std::string file = std::string(SC_BINARY_DIR) + "/store.cache";
    std::filesystem::remove(file);
    Response r;
    r.force = Eigen::VectorXd::LinSpaced(7, 0.0, 1.0 / 3.0);
    r.markers.resize(0);
    {
        Store store;
        REQUIRE(store.open(file, "a").empty());
        store.keep("one", r);
        store.keep("two", r);
    }
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
    {
        Store store;
        REQUIRE(store.open(file, "a").empty());
        REQUIRE(store.find("one").has_value());
        CHECK(store.find("one")->force == r.force);
        CHECK_FALSE(store.find("two").has_value());
        store.keep("two", r);
    }
    Store store;
    REQUIRE(store.open(file, "a").empty());
    CHECK(store.fromFile() == 2);
    Store other;
    REQUIRE(other.open(file, "another experiment").empty());
    CHECK(other.fromFile() == 0);
}

TEST_CASE("a full disk costs what comes after it, and says so", "[diagnosis]") {
    const std::string file = std::string(SC_BINARY_DIR) + "/full.cache";
    std::filesystem::remove(file);
    Response r;
    r.force = Eigen::VectorXd::LinSpaced(100, 0.0, 1.0);
    {
        Store store;
        REQUIRE(store.open(file, "a").empty());
        store.keep("one", r);
        // A limit on the size of files stands for the disk; the signal that comes with it would end the program.
        struct rlimit before {};
        REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
        const auto handler = std::signal(SIGXFSZ, SIG_IGN);
        struct rlimit full = before;
        full.rlim_cur = std::filesystem::file_size(file) + 300;
        REQUIRE(setrlimit(RLIMIT_FSIZE, &full) == 0);
        store.keep("two", r);
        REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
        std::signal(SIGXFSZ, handler);
        CHECK(store.failure().find("full.cache: cannot be written: ") != std::string::npos);
        store.keep("three", r);
        CHECK(store.find("two").has_value()); // in memory
        CHECK(store.find("three").has_value());
    }
    Store store;
    REQUIRE(store.open(file, "a").empty());
    CHECK(store.fromFile() == 1);
    store.keep("four", r);
    CHECK(store.failure().empty());
    Store again;
    REQUIRE(again.open(file, "a").empty());
    CHECK(again.fromFile() == 2);
}

TEST_CASE("runs kept by another program are not believed", "[diagnosis]") {
    /// A spring whose last run has a marker, elsewhere in another program.
    struct Marked final : toy::Spring {
        double at;
        Marked(const Data& data, double place) : Spring(data), at(place) {}
        void alter(std::size_t r, const Point&, Response& out) const override {
            if (r == 2)
                out.markers = Eigen::Vector4d(at, std::nan(""), 0.0, 0.0);
        }
    };
    const Data data = toy::recordings(17), longer = toy::recordings(17, {}, 0.0, 40.0);
    REQUIRE(data.runs.size() == 3);
    const Marked here(data, 0.25), elsewhere(data, 0.5), slower(longer, 0.25);
    const Point point{{100.0, 0.1}, {}};
    const Question last{2, point, Fineness::Coarse};
    const auto checked = [&](const Model& later) {
        Store store;
        Evaluator(here, 3, {}, store).everywhere({point}, Fineness::Coarse);
        Evaluator again(later, 3, {}, store);
        again.checkStore(point, Fineness::Coarse);
        return again.ask({last}).front();
    };
    CHECK(checked(here).markers[0] == 0.25);
    CHECK(checked(elsewhere).markers[0] == 0.5);
    CHECK(checked(slower).force.size() == longer.runs[2].force.size());
}
