// Exports that look like others and are not: what they hold is read, or asked for, never guessed in silence.

#include "tests/plugin/recording/import/support.h"

using namespace importingtest;
using Catch::Contains;

TEST_CASE("velocities beside an angle are averaged and cut with it", "[importing]") {
    std::string text = "time_s,angle_deg,position_mm,velocity_mm_s\n";
    for (int i = 0; i < 5000; ++i)
        text +=
            printed(1e-3 * i, 3) + "," + printed(30.0 * std::cos(0.01 * i), 6) + "," + printed(0.01 * i, 6) + ",10\n";
    importing::Hints hints;
    hints.average = 100;
    CHECK_THAT(accountOf(text, hints),
               Contains("understood the velocities add up to a way of 49 mm, the displacement to 49 mm"));
    hints.fromTurningPoint = 1;
    CHECK_THAT(accountOf(text, hints), Contains("understood the velocities add up to a way of 4"));
}
