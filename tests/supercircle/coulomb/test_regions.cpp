// Regions of a large island, paths inside them, and the large problems they are for.

#include "supercircle/coulomb/pivoting/path.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/regions.h"
#include "tests/supercircle/coulomb/generator.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

using namespace supercircle::coulomb;

namespace {

/// A solved nest a little later: forces and gaps have changed, the solution is the warm start.
Problem warmNest(int shells, std::uint64_t seed) {
    generator::Random random(seed);
    Problem problem = generator::nest({.shells = shells, .perPair = 10, .force = 2.0, .side = 2}, random);
    Solver solver;
    std::vector<Eigen::VectorXd> v;
    REQUIRE(solver.solve(problem, {}, problem.r0, v).converged);
    for (Body& body : problem.bodies)
        body.vFree *= random.uniform(0.95, 1.05);
    for (Contact& contact : problem.contacts)
        contact.w[0] = std::max(0.0, contact.w[0] + 5e-8 / problem.dt * random.uniform(-1.0, 1.0));
    return problem;
}

} // namespace

TEST_CASE("a region holds all contacts of its bodies, inside or outside") {
    generator::Random random(3);
    Whitened problem;
    REQUIRE(problem.build(generator::cloud({.bodies = 80, .contacts = 400, .self = 0.1}, random)).empty());
    Regions regions;
    regions.prepare(problem);
    for (const std::int32_t seed : {0, 17, 399, 200, 17}) {
        const Region region = *regions.grow(problem, seed, 40);
        CHECK(std::is_sorted(region.contacts.begin(), region.contacts.end()));
        CHECK(std::binary_search(region.contacts.begin(), region.contacts.end(), seed));
        CHECK(std::find(region.core.begin(), region.core.end(), seed) != region.core.end());
        std::set<std::int32_t> bodies;
        for (const std::int32_t c : region.contacts)
            for (std::int32_t s = 0; s < problem.contact(c).sides; ++s)
                bodies.insert(problem.contact(c).side[s].body);
        CHECK(bodies.size() < problem.bodyCount());
        std::set<std::int32_t> inside(region.contacts.begin(), region.contacts.end());
        std::set<std::int32_t> outside(region.outside.begin(), region.outside.end());
        CHECK(inside.size() == region.contacts.size());
        CHECK(outside.size() == region.outside.size());
        for (std::size_t c = 0; c < problem.contactCount(); ++c) {
            bool touches = false;
            for (std::int32_t s = 0; s < problem.contact(c).sides; ++s)
                touches = touches || bodies.count(problem.contact(c).side[s].body) > 0;
            const auto index = static_cast<std::int32_t>(c);
            CHECK(inside.count(index) * outside.count(index) == 0);
            if (touches)
                CHECK(inside.count(index) + outside.count(index) == 1);
        }
    }
}

TEST_CASE("a region does not grow into a body that is taken") {
    generator::Random random(13);
    const Problem source = generator::nest({.shells = 12, .perPair = 10}, random);
    Whitened problem;
    REQUIRE(problem.build(source).empty());
    Regions regions;
    regions.prepare(problem);
    const std::vector<std::int32_t> inside = regions.grow(problem, 0, 40)->contacts;
    std::vector<std::uint8_t> busy(source.bodies.size(), 1);
    for (const std::int32_t c : inside)
        for (const std::int32_t body : {source.contacts[c].a, source.contacts[c].b})
            if (body >= 0)
                busy[body] = 0;
    REQUIRE(std::count(busy.begin(), busy.end(), 1) > 0);
    REQUIRE(regions.grow(problem, 0, 40, busy) != nullptr); // its own bodies are free
    CHECK(regions.grow(problem, 0, 40, busy)->contacts == inside);
    CHECK(regions.grow(problem, 0, 400, busy) == nullptr);
    busy[source.contacts[0].a] = 1;
    CHECK(regions.grow(problem, 0, 40, busy) == nullptr);
    CHECK(regions.grow(problem, 0, 40)->contacts == inside); // a refusal leaves nothing behind
}

TEST_CASE("a path in a region solves it and leaves the rest alone") {
    const Problem source = warmNest(6, 4);
    Whitened problem;
    REQUIRE(problem.build(source).empty());
    Iterate x;
    x.start(problem, source.r0);
    const Iterate before = x;
    Regions regions;
    regions.prepare(problem);
    const Region region = *regions.grow(problem, 0, problem.contactCount() / 3);
    REQUIRE_FALSE(region.outside.empty());
    Path path;
    PathCounts counts;
    const double allowed = 1e-20; // J, far below the error at the start
    const Path::Outcome outcome =
        path.run(problem, region.contacts, region.outside, {1e-6, 0.3, 0, 600, 20}, allowed, x, counts);
    CHECK(outcome == Path::Outcome::Solved);
    std::set<std::int32_t> inside(region.contacts.begin(), region.contacts.end());
    for (std::size_t c = 0; c < problem.contactCount(); ++c)
        if (inside.count(static_cast<std::int32_t>(c)) == 0) {
            CHECK(x.r[2 * c] == before.r[2 * c]);
            CHECK(x.r[2 * c + 1] == before.r[2 * c + 1]);
        }
    std::vector<double> w;
    problem.assemble(x.r, w);
    double size = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) {
        size = std::max(size, std::abs(w[i]));
        difference = std::max(difference, std::abs(w[i] - x.w[i]));
    }
    CHECK(difference <= 1e-12 * size); // round-off of sums in another order
    ResidualSum sum;
    for (const std::int32_t c : region.contacts) {
        const Whitened::Contact& contact = problem.contact(c);
        const Whitened::Velocity u = problem.velocity(contact, w.data());
        sum.add(u.n, u.t, contact.qn, contact.qt, x.r[2 * c], x.r[2 * c + 1], contact.mu, contact.d);
    }
    CHECK(sum.error() <= 2.0 * allowed);
}

TEST_CASE("a large warm island is solved without sweeps, the same way twice") {
    const Problem problem = warmNest(40, 5);
    Solver solver;
    Eigen::VectorXd r, again;
    std::vector<Eigen::VectorXd> v;
    const SolveReport report = solver.solve(problem, {}, r, v);
    CHECK(report.loaded > 200); // else the island is not a large one and this tests nothing
    CHECK(report.converged);
    CHECK(report.sweeps == 0);
    CHECK(judge(problem, r).eta <= 1.01e-8);
    Solver other; // another work space at other addresses
    other.solve(problem, {}, again, v);
    CHECK((r.array() == again.array()).all());
}

TEST_CASE("the pieces of a warm start survive a change of the time step") {
    generator::Random random(9);
    Problem problem = generator::nest({.shells = 5, .perPair = 10, .force = 2.0}, random);
    Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
    REQUIRE(solver.solve(problem, {}, r, v).converged);
    Whitened whitened;
    REQUIRE(whitened.build(problem).empty());
    Iterate x, scaled;
    x.start(whitened, r);
    scaled.start(whitened, (r / 3e-4) * 1e-4); // as a simulation hands it on
    CHECK(std::count(x.piece.begin(), x.piece.end(), Piece::Stick) > 0);
    CHECK(x.piece == scaled.piece);
}
