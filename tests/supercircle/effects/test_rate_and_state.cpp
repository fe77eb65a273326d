// Rate and state friction and the loss factor against their closed forms, by the laws alone.

#include "supercircle/effects/effect.h"
#include "supercircle/effects/surface.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

using namespace supercircle;
using namespace supercircle::effects;

namespace {

Model modelOf(const std::vector<std::string>& texts) {
    std::vector<Setting> settings;
    for (const std::string& text : texts)
        REQUIRE(add(settings, text).empty());
    REQUIRE(validate(settings).empty());
    return modelFor(settings, "all");
}

constexpr double kDirect = 0.02, kEvolution = 0.03, kSlip = 1e-5, kSpeed = 1e-3, kCreep = 1e-9;

FrictionModel rateAndState(const std::string& law) {
    const std::string key = "rate_and_state_friction:";
    return modelOf({key + "law=" + law, key + "a_over_mu=0.02", key + "b_over_mu=0.03", key + "Dc_m=1e-5",
                    key + "V0_m_s=1e-3", key + "creep_m_s=1e-9", key + "rest_s=60"})
        .contact.friction;
}

/// A site after a long way at a steady speed.
Site slidAt(const FrictionModel& m, double speed) {
    Site site;
    site.age = m.stateRest;
    for (int i = 0; i < 100; ++i)
        advance(m, site, speed, kSlip / speed);
    return site;
}

/// Loss and storage modulus over B at a circular frequency.
std::complex<double> modulusOf(const MaterialModel& m, double w) {
    std::complex<double> out = 1.0;
    for (const MaxwellBranch& b : m.branches)
        out += b.stiffness * std::complex<double>(0.0, w * b.time) / std::complex<double>(1.0, w * b.time);
    return out;
}

} // namespace

TEST_CASE("rate and state: friction follows a jump of the speed and comes back over the critical slip") {
    const double slow = 1e-3, fast = 1e-2;
    for (const std::string law : {"ageing", "slip"}) {
        CAPTURE(law);
        const FrictionModel m = rateAndState(law);
        Site site = slidAt(m, slow);
        CHECK(site.age == Approx(kSlip / slow).epsilon(1e-12)); // of contacts that are renewed over Dc
        CHECK(frictionFactor(m, site, slow, 0.0) == Approx(1.0 + kDirect * std::log1p(kCreep / kSpeed)).epsilon(1e-12));
        // The jump itself: the direct effect alone.
        CHECK(frictionFactor(m, site, fast, 0.0) - frictionFactor(m, site, slow, 0.0) ==
              Approx(kDirect * std::log((fast + kCreep) / (slow + kCreep))).epsilon(1e-10));
        // After a slip x, in one step or in seven: both laws are integrated exactly at a steady speed.
        for (const int steps : {1, 7})
            for (const double slip : {0.1, 1.0, 5.0}) { // over Dc
                CAPTURE(steps, slip);
                Site moved = site;
                for (int i = 0; i < steps; ++i)
                    advance(m, moved, fast, slip * kSlip / fast / steps);
                const double left = std::exp(-slip);
                const double age = law == "ageing" ? kSlip / fast + (kSlip / slow - kSlip / fast) * left
                                                   : kSlip / fast * std::pow(fast / slow, left);
                CHECK(moved.age == Approx(age).epsilon(1e-12));
                CHECK(frictionFactor(m, moved, fast, 0.0) == Approx(1.0 + kDirect * std::log((fast + kCreep) / kSpeed) +
                                                                    kEvolution * std::log(age * kSpeed / kSlip))
                                                                 .epsilon(1e-12));
                CHECK(frictionFactor(m, site, fast, slip * kSlip / fast) ==
                      Approx(frictionFactor(m, moved, fast, 0.0)).epsilon(1e-12)); // at the end of a step
            }
        // Steady friction changes by a - b per e-fold of the speed.
        CHECK(frictionFactor(m, slidAt(m, fast), fast, 0.0) - frictionFactor(m, slidAt(m, slow), slow, 0.0) ==
              Approx((kDirect - kEvolution) * std::log(fast / slow)).epsilon(1e-5)); // the creep speed: 1e-6
    }
}

TEST_CASE("rate and state: contacts age at rest by the ageing law only") {
    for (const std::string law : {"ageing", "slip"}) {
        CAPTURE(law);
        const FrictionModel m = rateAndState(law);
        const Site before = slidAt(m, kSpeed);
        Site rested = before;
        for (int i = 0; i < 10; ++i)
            advance(m, rested, 0.0, 1.0);
        const double grown = law == "ageing" ? kEvolution * std::log1p(10.0 * kSpeed / kSlip) : 0.0;
        CHECK(frictionFactor(m, rested, 0.0, 0.0) - frictionFactor(m, before, 0.0, 0.0) ==
              Approx(grown).epsilon(1e-12).margin(1e-15));
    }
}

TEST_CASE("a loss factor is the same at all frequencies, and the modulus rises as causality asks") {
    for (const double loss : {0.005, 0.05, 0.3}) {
        CAPTURE(loss);
        const std::string key = "viscoelastic_bending:";
        const MaterialModel m = modelOf({key + "law=loss_factor", key + "loss_factor=" + std::to_string(loss),
                                         key + "f_low_Hz=0.01", key + "f_high_Hz=1e5"})
                                    .material;
        CHECK(m.branches.size() == 14);
        const double alpha = 2.0 / M_PI * std::atan(loss);
        std::complex<double> last = 0.0;
        for (const double f : {1.0, 10.0, 100.0, 1000.0}) { // two decades inside the band
            CAPTURE(f);
            const std::complex<double> now = modulusOf(m, 2.0 * M_PI * f);
            // The spectrum lacks what is more than two decades away, times of 1 / (1 - alpha) e-folds; ripple 0.2 %.
            const double lacks = 2.0 / M_PI * std::pow(0.01, 1.0 - alpha) / (1.0 - alpha);
            CHECK(now.imag() / now.real() == Approx(loss).epsilon(lacks + 0.002));
            if (last.real() > 0.0)
                CHECK(now.real() / last.real() == Approx(std::pow(10.0, alpha)).epsilon(0.003 * loss + 1e-4));
            last = now;
        }
        CHECK(modulusOf(m, 1e-6).real() == Approx(1.0).epsilon(1e-6)); // B is the modulus at rest
    }
    std::vector<Setting> wrong;
    for (const char* text : {"viscoelastic_bending:law=loss_factor", "viscoelastic_bending:loss_factor=0.1",
                             "viscoelastic_bending:f_low_Hz=10", "viscoelastic_bending:f_high_Hz=1"})
        REQUIRE(add(wrong, text).empty());
    CHECK(validate(wrong).find("f_high_Hz") != std::string::npos);
}
