#pragma once

#include <cmath>
#include <limits>

#include "plugin/recording/table/recording.h"

namespace supercircle::test {

/// A small recording that uses every field, with values that are hard to print.
inline record::Recording smallRecording() {
    using namespace record;
    Recording r;
    r.scene = "hard \"names\"\n\tand </script> ü";
    r.about = "about\\";
    r.summary = {{"scene", r.scene},
                 {"seed", std::int64_t{1} << 62},
                 {"third", 1.0 / 3.0},
                 {"five", 5.0},
                 {"tiny", 5e-324},
                 {"missing", std::numeric_limits<double>::quiet_NaN()},
                 {"endless", std::numeric_limits<double>::infinity()},
                 {"flag", true},
                 {"snap_type", std::string("II")}};
    r.parameters = {{"phi_bar", 0.75}, {"mu", 0.35}, {"shells", 30.0}};
    r.energy = {{"work_in_J", 0.1}, {"residual_J", -1e-17}};
    r.cycles = {{3.35, 0.134, 7, 0.042}, {3.1, 0.1 + 0.2, 0, 1e300}};
    r.series.names = {"time_s", "displacement_m", "force_N"};
    r.series.columns = {
        {0.0, 0.1, 0.2, 0.1 + 0.2},
        {-0.0, 1.0 / 3.0, 5e-324, 1.7976931348623157e308},
        {std::numeric_limits<double>::quiet_NaN(), 1e22, -std::numeric_limits<double>::infinity(), 1.0}};
    r.shells = {{"a", 0.09, 5e-4, 2.29e-4, false, {0.03, 0.03, 0.03}, {52.1, 52.1, 52.1}},
                {"ring", 0.1, 5e-4, 1e-4, true, {0.1}, {62.8}}};
    r.outlines = {{OutlineInfo::Kind::Polyline, {{0.0, 0.0}, {1.0 / 3.0, 0.0}}, 0.0, 0, false},
                  {OutlineInfo::Kind::Polygon, {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, 0.0, 1, true},
                  {OutlineInfo::Kind::Circle, {}, 0.01895, -1, false}};
    Frame empty;
    empty.phase = "drop";
    empty.force = std::numeric_limits<double>::quiet_NaN();
    Frame full{1.0 / 3.0,
               0.01,
               2.5,
               "load 1",
               {},
               {{0.1, 0.2, 0.3}, {}},
               {{0.1, 0.2, -0.3, 0.4, true}, {0.0, 0.0, 1e-20, 0.0, false}}};
    full.shells = {{{0.1, 1.0 / 3.0}, -7.0, {52.0F, 1.0F / 3.0F, -1e-9F}, 1e-3}, {{0.0, 0.0}, 0.0, {62.8F}, 0.0}};
    r.frames = {empty, full};
    r.events = {{0.1, 0.2, 0.3, "snap_fit", "1 over 2"}, {1.0 / 3.0, 0.0, 0.0, "peak", ""}};
    r.keyFrames = {0, 1, -1};
    r.R = 0.0192;
    r.B = 2.29e-4;
    return r;
}

} // namespace supercircle::test
