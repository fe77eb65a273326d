// The interval from an observed switch, against switches in closed form.

#include "plugin/identification/calibration/switching.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::calibration;
using Catch::Contains;

namespace {

/// Shell on a cylinder of its own radius (supplement, equations 1 to 4): mu* falls with the opening angle.
double cylinder(double phiBar) {
    const double phi = phiBar * std::acos(-1.0), c = std::cos(phi), s = std::sin(phi);
    const double cxx = phi / 2.0 - 1.5 * s * c + phi * c * c;
    const double cxy = 0.5 - 1.5 * c * c + c - phi * s * c;
    const double angle = std::acos(-1.0) - phi + std::atan(cxy / cxx);
    return angle < 0.5 * std::acos(-1.0) ? std::tan(angle) : HUGE_VAL; // beyond: smooth whatever the friction
}

std::optional<Snap> exact(double phiBar, double mu) {
    return mu < cylinder(phiBar) ? Snap::Smooth : Snap::Abrupt;
}

Trial smooth(double phiBar) {
    return {phiBar, Snap::Smooth};
}
Trial abrupt(double phiBar) {
    return {phiBar, Snap::Abrupt};
}

} // namespace

TEST_CASE("the deepest smooth and the shallowest abrupt shell bound the coefficient") {
    SwitchSettings settings;
    settings.tolerance = 1e-4;
    const auto r = frictionFromSwitch({smooth(0.75), abrupt(0.9), smooth(0.83), abrupt(0.85)}, exact, settings);
    REQUIRE(r);
    CHECK(r->low == Approx(cylinder(0.85)).margin(1e-4));  // .3632 (physics of the cylinder)
    CHECK(r->high == Approx(cylinder(0.83)).margin(1e-4)); // .4826
    CHECK(r->low <= cylinder(0.85));                       // the bracket's outer ends: the interval holds mu
    CHECK(r->high >= cylinder(0.83));
}

TEST_CASE("an uncertain angle widens the interval to both sides, and it still holds the coefficient") {
    SwitchSettings settings, sharp;
    settings.angleUncertainty = 0.01;
    const std::vector<Trial> trials = {smooth(0.80), abrupt(0.87)};
    const auto wide = frictionFromSwitch(trials, exact, settings);
    const auto narrow = frictionFromSwitch(trials, exact, sharp);
    REQUIRE(wide);
    REQUIRE(narrow);
    CHECK(wide->low < narrow->low);
    CHECK(wide->high > narrow->high);
    for (const double mu : {0.3, 0.4, 0.5, 0.6}) { // what a laboratory with this coefficient would have seen
        std::vector<Trial> seen;
        for (const double phiBar : {0.74, 0.78, 0.80, 0.83, 0.85, 0.88, 0.91})
            seen.push_back({phiBar, *exact(phiBar + 0.008, mu)}); // every angle is off by less than stated
        const auto r = frictionFromSwitch(seen, exact, settings);
        REQUIRE(r);
        CHECK(r->low <= mu);
        CHECK(r->high >= mu);
    }
}

TEST_CASE("one outcome alone bounds the coefficient from one side") {
    const auto below = frictionFromSwitch({smooth(0.8)}, exact, {});
    REQUIRE(below);
    CHECK(below->low == 0.0);
    CHECK(below->high == Approx(cylinder(0.8)).margin(0.003));
    const auto above = frictionFromSwitch({abrupt(0.8)}, exact, {});
    REQUIRE(above);
    CHECK(std::isinf(above->high));
    const auto always = frictionFromSwitch({smooth(0.6)}, exact, {}); // smooth whatever the friction
    REQUIRE(always);
    CHECK(std::isinf(always->high));
}

TEST_CASE("contradictory trials and failed simulations are reported") {
    CHECK_THAT(frictionFromSwitch({smooth(0.9), abrupt(0.8)}, exact, {}).error(), Contains("contradict"));
    CHECK_THAT(frictionFromSwitch({}, exact, {}).error(), Contains("no trials"));
    CHECK_THAT(frictionFromSwitch({abrupt(0.6)}, exact, {}).error(), Contains("takes more friction"));
    const auto never = [](double, double) { return std::optional<Snap>(); };
    CHECK_THAT(frictionFromSwitch({smooth(0.8)}, never, {}).error(), Contains("ended in no snap"));
}
