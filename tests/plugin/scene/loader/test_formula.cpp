// Formulas outside of scenes.

#include "plugin/scene/loader/formula.h"

#include <catch2/catch.hpp>
#include <cmath>

using supercircle::scene::Formula;

TEST_CASE("a formula names what it needs and is evaluated over one of it", "[scene]") {
    const auto f = Formula::parse("mu*(1 + a*log(1 + v/v0)) - 1e-3*sin(pi) + max(v, a)");
    INFO(f.error());
    REQUIRE(f);
    CHECK(f->names() == std::vector<std::string>{"mu", "a", "v", "v0"});
    const std::vector<double> at{0.0, 1e-3, 2.0};
    const std::vector<double> values = f->values({{"mu", 0.3}, {"a", 0.1}, {"v0", 1e-3}}, "v", at);
    REQUIRE(values.size() == at.size());
    for (std::size_t i = 0; i < at.size(); ++i)
        CHECK(values[i] ==
              Approx(0.3 * (1.0 + 0.1 * std::log(1.0 + at[i] / 1e-3)) + std::max(at[i], 0.1)).epsilon(1e-14));
    CHECK(std::isnan(f->values({{"mu", 0.3}}, "v", {1.0}).front())); // without a and v0
}

TEST_CASE("formulas that cannot be read are refused at their place", "[scene]") {
    for (const char* text : {"", "1 +", "mu*(1+v", "2 mu", "a = 3", "f(x)", "1, 2", "mu $ 3"}) {
        CAPTURE(text);
        const auto f = Formula::parse(text);
        CHECK_FALSE(f);
        CHECK_FALSE(f.error().empty());
    }
    CHECK_FALSE(Formula::parse(std::string(3000, '1')));
}
