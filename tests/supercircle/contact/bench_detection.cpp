#include "shells.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>

using namespace contact_test;

namespace {

double milliseconds(std::chrono::steady_clock::time_point from) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
}

void measure(int count, int nest) {
    std::vector<RodCurve> curves = makePile(count, nest);
    std::vector<Outline> outlines;
    for (int i = 0; i < 3; ++i) {
        Outline wall;
        wall.key = static_cast<std::uint32_t>(i);
        wall.points = {Vec2(-0.03, -0.02), i == 0 ? Vec2(0.5, -0.02) : Vec2(-0.03 - 0.001 * i, 0.5)};
        outlines.push_back(wall);
    }
    std::vector<Candidate> out;
    DetectionOptions options;
    double cold = 1e300;
    for (int r = 0; r < 5; ++r) {
        Detector fresh;
        const auto t = std::chrono::steady_clock::now();
        fresh.detect(curves, outlines, options, out);
        cold = std::min(cold, milliseconds(t));
    }
    Detector detector;
    detector.detect(curves, outlines, options, out);
    const auto run = [&](double shift, int steps) {
        for (RodCurve& curve : curves)
            curve.motion = shift;
        double best = 1e300;
        double sum = 0.0;
        for (int r = 0; r < steps; ++r) {
            for (std::size_t i = 0; i < curves.size(); ++i)
                move(curves[i], shift * (r % 2 == 0 ? 1.0 : -1.0) * Vec2(i % 2 == 0 ? 0.3 : -0.3, 0.2));
            const auto t = std::chrono::steady_clock::now();
            detector.detect(curves, outlines, options, out);
            const double ms = milliseconds(t);
            best = std::min(best, ms);
            sum += ms;
        }
        std::printf("   motion %8.1e m: best %.4f ms, mean %.4f ms, %zu candidates\n", shift, best, sum / steps,
                    out.size());
    };
    std::printf("%d shells in nests of %d, cold: %.3f ms, %zu candidates\n", count, nest, cold, out.size());
    run(1e-9, 200);
    run(1e-5, 200);
    run(2e-4, 200);
    // Every rod moves steadily by 0.1 mm a step, alternate ones in opposite directions.
    double sum = 0.0;
    for (int r = 0; r < 100; ++r) {
        for (std::size_t i = 0; i < curves.size(); ++i) {
            curves[i].motion = 1e-4;
            move(curves[i], Vec2(i % 2 == 0 ? 1e-4 : -1e-4, 0.0));
        }
        const auto t = std::chrono::steady_clock::now();
        detector.detect(curves, outlines, options, out);
        sum += milliseconds(t);
    }
    std::printf("   steady 0.1 mm a step: mean %.4f ms\n", sum / 100.0);
}

} // namespace

TEST_CASE("timings of detection", "[.bench]") {
    for (const int nest : {2, 4})
        for (const int count : {30, 300, 1000})
            measure(count, nest);
}
