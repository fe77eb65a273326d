// The envelope LU against Eigen's dense LU with pivoting.

#include "supercircle/coulomb/pivoting/envelope_lu.h"
#include "tests/supercircle/coulomb/generator.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::coulomb;

namespace {

/// Random rows of random width; nearly symmetric and diagonally dominant, like the contacts of a heap.
struct Banded {
    Banded(int n, int width, generator::Random& random) : first(n), full(Eigen::MatrixXd::Zero(n, n)) {
        for (int i = 0; i < n; ++i) {
            first[i] = std::max(0, i - random.index(width + 1));
            for (int j = first[i]; j < i; ++j) {
                full(i, j) = random.uniform(-1.0, 1.0);
                full(j, i) = full(i, j) + random.uniform(-0.3, 0.3);
            }
        }
        for (int i = 0; i < n; ++i)
            full(i, i) = 0.7 * full.row(i).cwiseAbs().sum() + 0.1;
        lu.shape(first);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                if (full(i, j) != 0.0)
                    lu.at(i, j) += full(i, j);
    }
    std::vector<std::int32_t> first;
    Eigen::MatrixXd full;
    EnvelopeLu lu;
};

} // namespace

TEST_CASE("an envelope LU solves what the dense one solves") {
    generator::Random random(5);
    for (const int n : {1, 2, 3, 10, 40, 97})
        for (const int width : {0, 1, 5, 30}) {
            Banded a(n, width, random);
            REQUIRE(a.lu.factor());
            REQUIRE(a.lu.size() == static_cast<std::size_t>(n));
            Eigen::VectorXd x(n);
            for (int i = 0; i < n; ++i)
                x[i] = random.uniform(-1.0, 1.0);
            const Eigen::VectorXd expected = a.full.partialPivLu().solve(x);
            a.lu.solve(x.data());
            // 1e-12: round-off times a condition of some hundred
            CHECK((x - expected).norm() <= 1e-12 * (1.0 + expected.norm()) * (1.0 + a.full.norm()));
        }
}

TEST_CASE("a local right-hand side has a local solution, the same but for round-off") {
    generator::Random random(6);
    Banded a(400, 6, random);
    REQUIRE(a.lu.factor());
    for (const int at : {0, 1, 170, 398, 399}) {
        Eigen::VectorXd x = Eigen::VectorXd::Zero(400);
        for (int i = at; i < std::min(400, at + 3); ++i)
            x[i] = random.uniform(-1.0, 1.0);
        Eigen::VectorXd y = x;
        a.lu.solve(x.data());
        const EnvelopeLu::IndexRange range = a.lu.solveLocal(y.data(), static_cast<std::size_t>(at));
        CHECK((x - y).norm() <= 1e-13 * x.norm()); // 400 entries of 1e-16 each, passed on
        CHECK(range.begin <= static_cast<std::size_t>(at));
        for (std::size_t i = 0; i < 400; ++i)
            if (i < range.begin || i >= range.end)
                CHECK(y[static_cast<Eigen::Index>(i)] == 0.0);
        if (at == 170) // the matrix is dominated by its diagonal: the solution decays to both sides
            CHECK(range.end - range.begin < 390);
    }
}

TEST_CASE("an envelope LU refuses singular and broken matrices") {
    const std::vector<std::int32_t> first{0, 0};
    EnvelopeLu lu;
    lu.shape(first);
    lu.at(0, 0) = lu.at(0, 1) = lu.at(1, 0) = lu.at(1, 1) = 1.0;
    CHECK_FALSE(lu.factor());
    lu.shape(first); // clears
    CHECK(lu.at(0, 1) == 0.0);
    CHECK_FALSE(lu.factor());
    lu.at(0, 0) = std::numeric_limits<double>::quiet_NaN();
    lu.at(1, 1) = 1.0;
    CHECK_FALSE(lu.factor());
    CHECK(EnvelopeLu::cost(first) == 1.0);
}
