// How fast gaps close: supercircle/step/contacts/gap_closing.h.

#include "supercircle/step/contacts/gap_closing.h"

#include <catch2/catch.hpp>

using namespace supercircle::step;
using supercircle::rod::Vec2;

TEST_CASE("a gap closes at its speed at most, whatever the step", "[step]") {
    const GapClosing closing{0.02};
    for (const double dt : {1e-9, 1e-6, 1e-3, 1e-2, 1.0})
        for (const double gap : {1e-12, 1e-6, 1e-3, 0.1, 7.0})
            for (const double sign : {1.0, -1.0}) {
                const double left = closing.left(sign * gap, dt);
                CHECK(std::abs(sign * gap - left) <= 0.02 * dt + 1e-15 * gap); // rounding
                CHECK(left * sign >= 0.0);                                     // it never overshoots
                if (gap <= 0.02 * dt)
                    CHECK(left == 0.0); // all of it: a gap of the step's own making
                const Vec2 direction(0.6, -0.8), rest = closing.left(Vec2(sign * gap * direction), dt);
                CHECK((rest - left * direction).norm() <= 1e-15 + 1e-12 * gap);
            }
}
