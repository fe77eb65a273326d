// The closed-form law of one contact against enumeration of its statuses.

#include "supercircle/coulomb/law.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace supercircle::coulomb;

namespace {

struct Block {
    double nn, nt, tt;
};

/// Every solution of the law, by trying each status.
std::vector<LocalImpulse> enumerate(const Block& W, double qn, double qt, double mu) {
    std::vector<LocalImpulse> found;
    if (qn >= 0.0)
        found.push_back({0.0, 0.0, ContactStatus::Open});
    const double det = W.nn * W.tt - W.nt * W.nt;
    const double n = -(W.tt * qn - W.nt * qt) / det;
    const double t = -(W.nn * qt - W.nt * qn) / det;
    if (n >= 0.0 && std::abs(t) <= mu * n)
        found.push_back({n, t, ContactStatus::Stick});
    for (const double sign : {1.0, -1.0}) {
        const double slope = W.nn - sign * mu * W.nt;
        const double rn = -qn / slope;
        const double ut = qt + (W.nt - sign * mu * W.tt) * rn;
        if (slope != 0.0 && rn >= 0.0 && sign * ut >= 0.0)
            found.push_back({rn, -sign * mu * rn, sign > 0.0 ? ContactStatus::SlipPlus : ContactStatus::SlipMinus});
    }
    return found;
}

/// Distance of `x` from the nearest of `all`, relative to its size.
double nearest(const LocalImpulse& x, const std::vector<LocalImpulse>& all) {
    double best = 1e300;
    for (const LocalImpulse& y : all)
        best = std::min(best, std::hypot(x.n - y.n, x.t - y.t) / (1e-300 + std::hypot(y.n, y.t)));
    return best;
}

} // namespace

TEST_CASE("closed form equals enumeration of the statuses") {
    generator::Random random(1);
    for (int k = 0; k < 20000; ++k) {
        // coupling up to 0.999 of the singular value: the solution keeps at least 12 digits
        const double nn = std::pow(10.0, random.uniform(-3.0, 3.0));
        const double tt = nn * std::pow(10.0, random.uniform(-1.0, 1.0));
        const Block W{nn, random.uniform(-0.999, 0.999) * std::sqrt(nn * tt), tt};
        const double choices[] = {0.0, 0.1, 0.35, 1.0, 30.0};
        const double mu = choices[random.index(5)];
        const double qn = random.uniform(-1.0, 1.0);
        const double qt = random.uniform(-1.0, 1.0);
        const LocalImpulse x = LocalLaw(W.nn, W.nt, W.tt, mu).solve(qn, qt);
        const auto all = enumerate(W, qn, qt, mu);
        REQUIRE_FALSE(all.empty());
        if (qn < 0.0)
            REQUIRE(all.size() == 1); // unique where it must close, whatever W and mu
        if (qn >= 0.0)
            REQUIRE((x.n == 0.0 && x.t == 0.0 && x.status == ContactStatus::Open));
        else
            REQUIRE(nearest(x, all) < 1e-11);
    }
}

TEST_CASE("a nearly singular block still satisfies the law") {
    generator::Random random(2);
    for (int k = 0; k < 2000; ++k) {
        const double angle = random.uniform(0.0, 6.283);
        const double c = std::cos(angle), s = std::sin(angle);
        const double small = std::pow(10.0, random.uniform(-12.0, -6.0));
        const Block W{c * c + small, c * s, s * s + small};
        const double mu = random.uniform(0.0, 2.0);
        const double qn = random.uniform(-1.0, 0.0), qt = random.uniform(-1.0, 1.0);
        const LocalImpulse x = LocalLaw(W.nn, W.nt, W.tt, mu).solve(qn, qt);
        const double un = qn + W.nn * x.n + W.nt * x.t;
        const double ut = qt + W.nt * x.n + W.tt * x.t;
        const double size = 1.0 + std::hypot(x.n, x.t); // round-off of W r
        CHECK(std::abs(x.t) <= mu * x.n * (1.0 + 1e-12));
        CHECK(std::abs(un) <= 1e-13 * size);
        if (x.status == ContactStatus::Stick) // a stick impulse of size 1/small carries an error of 1e-16/small in u_t
            CHECK(std::abs(ut) <= 1e-15 / small * size);
        else
            CHECK(slipSign(x.status) * ut >= -1e-15 / small * size);
    }
}

TEST_CASE("blocks that cannot move") {
    CHECK(LocalLaw(0.0, 0.0, 1.0, 0.5).solve(-1.0, 1.0).n == 0.0);
    const LocalImpulse x = LocalLaw(2.0, 0.0, 0.0, 0.5).solve(-1.0, 1.0); // tangent driven: full friction against it
    CHECK(x.n == Approx(0.5).epsilon(1e-15));
    CHECK(x.t == Approx(-0.25).epsilon(1e-15));
}

TEST_CASE("without friction the tangential impulse is exactly zero") {
    CHECK(LocalLaw(2.0, 0.7, 1.0, 0.0).solve(-1.0, 0.3).t == 0.0);
    CHECK(LocalLaw(2.0, 0.7, 1.0, 0.0).solve(-1.0, -3.0).t == 0.0);
}
