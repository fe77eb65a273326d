// FCP2D files: a bitwise round trip, and an error message for every broken file.

#include "supercircle/coulomb/dump.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstring>
#include <limits>

using namespace supercircle::coulomb;

namespace {

Problem sample(bool warm) {
    generator::Random random(5);
    Problem problem = generator::cloud({.bodies = 4, .contacts = 9, .freedoms = 5, .self = 0.3}, random);
    problem.bodies[1].A = Eigen::MatrixXd::Identity(5, 5);
    problem.bodies[1].vFree[0] = -0.0; // survives as -0
    if (warm)
        problem.r0 = Eigen::VectorXd::LinSpaced(18, -1.0, 1.0);
    return problem;
}

bool sameBits(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols())
        return false;
    for (Eigen::Index j = 0; j < a.cols(); ++j)
        for (Eigen::Index i = 0; i < a.rows(); ++i) {
            const double x = a(i, j), y = b(i, j);
            if (std::memcmp(&x, &y, sizeof x) != 0)
                return false;
        }
    return true;
}

} // namespace

TEST_CASE("a dump is read back bitwise identical") {
    for (const bool warm : {false, true}) {
        const Problem problem = sample(warm);
        const std::string path = std::string(SC_BINARY_DIR) + "/round_trip.fcp";
        REQUIRE(writeDump(path, problem).empty());
        Problem back;
        REQUIRE(readDump(path, back).empty());
        std::remove(path.c_str());
        CHECK(back.dt == problem.dt);
        REQUIRE(back.bodies.size() == problem.bodies.size());
        for (std::size_t b = 0; b < back.bodies.size(); ++b) {
            CHECK(sameBits(back.bodies[b].A, problem.bodies[b].A));
            CHECK(sameBits(back.bodies[b].vFree, problem.bodies[b].vFree));
        }
        REQUIRE(back.contacts.size() == problem.contacts.size());
        for (std::size_t c = 0; c < back.contacts.size(); ++c) {
            const Contact &x = back.contacts[c], &y = problem.contacts[c];
            CHECK((x.a == y.a && x.b == y.b && x.mu == y.mu));
            CHECK((sameBits(x.w, y.w) && sameBits(x.Ha, y.Ha) && sameBits(x.Hb, y.Hb)));
        }
        CHECK(sameBits(back.r0, problem.r0));
    }
}

TEST_CASE("the layout of the header is the published one") {
    std::string bytes;
    REQUIRE(encode(sample(true), bytes).empty());
    CHECK(bytes.substr(0, 8) == std::string("FCP2D\0\0\1", 8));
    std::int32_t header[4];
    std::memcpy(header, bytes.data() + 8, sizeof header);
    CHECK((header[0] == 4 && header[1] == 9 && header[2] == 1 && header[3] == 0));
    double dt = 0.0;
    std::memcpy(&dt, bytes.data() + 24, sizeof dt);
    CHECK(dt == 1e-3);
}

TEST_CASE("a truncated dump is an error that names the offset") {
    std::string bytes;
    REQUIRE(encode(sample(true), bytes).empty());
    Problem target;
    target.dt = 42.0;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        const std::string error = decode(std::string_view(bytes).substr(0, length), target);
        REQUIRE(error.find("byte ") != std::string::npos);
    }
    CHECK(target.dt == 42.0); // untouched
    CHECK(decode(bytes + "x", target).find("1 bytes too many") != std::string::npos);
}

TEST_CASE("invalid files never crash the reader") {
    std::string good;
    REQUIRE(encode(sample(true), good).empty());
    generator::Random random(11);
    for (int k = 0; k < 5000; ++k) {
        std::string bytes = good;
        for (int hit = 0; hit < 1 + random.index(8); ++hit) // early bytes hold the counts: hit them often
            bytes[static_cast<std::size_t>(random.index(random.index(2) == 0 ? 64 : static_cast<int>(bytes.size())))] =
                static_cast<char>(random.index(256));
        Problem target;
        const std::string error = decode(bytes, target);
        REQUIRE((!error.empty() || validate(target).empty()));
    }
    std::string huge = good;
    const std::int32_t most = std::numeric_limits<std::int32_t>::max();
    for (const std::size_t at : {std::size_t{8}, std::size_t{12}, std::size_t{32}}) {
        huge = good;
        std::memcpy(huge.data() + at, &most, sizeof most);
        Problem target;
        CHECK_FALSE(decode(huge, target).empty());
    }
    Problem target;
    CHECK_FALSE(readDump("/no/such/file.fcp", target).empty());
}

TEST_CASE("an invalid problem is not written") {
    Problem problem = sample(false);
    problem.contacts[2].mu = -1.0;
    std::string bytes;
    CHECK(encode(problem, bytes).find("contact 2") != std::string::npos);
}
