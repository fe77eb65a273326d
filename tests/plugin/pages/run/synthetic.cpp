#include "tests/plugin/pages/run/synthetic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supercircle::test {

namespace {

using namespace record;
constexpr double pi = std::numbers::pi;
constexpr double R = 0.0192, h = 0.5e-3, B = 2.29e-4, fall = 6.0, rest = 1.0, branch = 12.0;
constexpr int elements = 15, snapFits = 9;

/// Repeatable numbers in 0 .. 1 from a pair of integers.
double chance(int i, int k) {
    auto x = static_cast<std::uint32_t>(i * 7919 + k * 104729 + 12345);
    x ^= x << 13;
    x ^= x >> 17;
    x ^= x << 5;
    x *= 2654435761U;
    return (x >> 8) / 16777216.0;
}

struct Stack {
    int shells, cycles, columns;
    double width, height, travel;
    [[nodiscard]] double end() const { return fall + rest + 2.0 * branch * cycles; }
};

Stack layout(int shells, int cycles) {
    const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(shells * 0.9))));
    const int rows = (shells + columns - 1) / columns;
    const double height = rows * 1.9 * R + 0.2 * R;
    return {shells, cycles, columns, columns * 2.1 * R, height, 0.36 * height};
}

struct CrossheadState {
    double displacement, force;
    std::string phase;
    bool load;
    int cycle;
};

double loadingForce(double u) {
    double f = 5.0 * std::pow(u, 2.4);
    for (int k = 1; k <= snapFits; ++k) {
        const double at = 0.2 + 0.7 * (k - 0.5 + 0.4 * chance(k, 1)) / snapFits;
        if (u > at)
            f -= (0.25 + 0.3 * chance(k, 2)) * std::pow(at, 1.5) * std::exp(-(u - at) / 0.035);
    }
    return std::max(f, 0.0);
}

CrossheadState crossheadAt(const Stack& stack, double t) {
    const double start = fall + rest;
    if (t < start)
        return {0.0, 0.0, t < fall ? "drop" : "settle", true, 0};
    const int half = std::min(static_cast<int>((t - start) / branch), 2 * stack.cycles - 1);
    const double s = std::min((t - start) / branch - half, 1.0);
    const bool load = half % 2 == 0;
    const double u = load ? s : 1.0 - s;
    const int cycle = half / 2 + 1;
    const double set = 0.12 * (1.0 - 1.0 / cycle);
    const double back = u < 0.14 ? 0.0 : 5.0 * std::pow((u - 0.14) / 0.86, 3.6);
    const double force = !load        ? back
                         : cycle == 1 ? loadingForce(u)
                                      : 5.0 * std::pow(std::max(u - set, 0.0) / (1.0 - set), 2.8);
    return {u * stack.travel, force, (load ? "load " : "unload ") + std::to_string(cycle), load, cycle};
}

ShellPose poseOf(const Stack& stack, int i, double t, double squeeze) {
    const double x = (i % stack.columns + 0.5) * stack.width / stack.columns;
    const double y = (1.0 * (i / stack.columns) + 0.5) * 1.9 * R + 0.1 * R;
    const double landed = fall * (i + 1.0) / (stack.shells + 1.0), late = t - landed;
    const double drop = late < 0.0 ? std::min(1.0, late * late * 6.0) * 0.25 * stack.height : 0.0;
    const double start = 2.0 * pi * chance(i, 3) + (late < 0.0 ? 2.0 * late : 0.0);
    ShellPose pose;
    double angle = start;
    std::vector<double> lengths(elements, 1.5 * pi * R / elements);
    double cx = 0.0, cy = 0.0, px = 0.0, py = 0.0;
    for (int k = 0; k < elements; ++k) {
        const double theta = angle + 0.5 * lengths[k] / R;
        const double kappa = (1.0 + squeeze * (0.5 + chance(i, 4)) * 0.5 * std::cos(2.0 * theta)) / R;
        pose.curvature.push_back(static_cast<float>(kappa));
        pose.bending_energy += 0.5 * B * lengths[k] * (kappa - 1.0 / R) * (kappa - 1.0 / R);
        px += lengths[k] * std::cos(angle + 0.5 * kappa * lengths[k]);
        py += lengths[k] * std::sin(angle + 0.5 * kappa * lengths[k]);
        angle += kappa * lengths[k];
        cx += px / elements;
        cy += py / elements;
    }
    pose.start = {x - cx, y * (1.0 - 0.36 * squeeze) + drop - cy};
    pose.angle = start;
    return pose;
}

Frame frameOf(const Stack& stack, double t) {
    const CrossheadState crosshead = crossheadAt(stack, t);
    Frame frame{t, crosshead.displacement, crosshead.force, crosshead.phase, {}, {}, {}};
    const double squeeze = crosshead.displacement / stack.travel;
    const int there =
        t >= fall ? stack.shells : std::min(stack.shells, 1 + static_cast<int>(t / fall * (stack.shells + 1)));
    for (int i = 0; i < there; ++i)
        frame.shells.push_back(poseOf(stack, i, t, squeeze));
    frame.bodies.push_back({});
    frame.bodies.push_back({0.5 * stack.width, stack.height - crosshead.displacement, 0.0});
    for (int i = 0; i + stack.columns < there; ++i) {
        const double f = (0.05 + crosshead.force / stack.columns) * (0.2 + 1.6 * chance(i, 5)),
                     a = 2.0 * chance(i, 6) - 1.0;
        const double x = (i % stack.columns + 0.5) * stack.width / stack.columns;
        frame.contacts.push_back({x, (1.0 * (i / stack.columns) + 1.0) * 1.9 * R * (1.0 - 0.36 * squeeze),
                                  f * std::sin(a), f * std::cos(a), chance(i, 7) > 0.7});
    }
    return frame;
}

void addOutlines(Recording& recording, const Stack& stack) {
    const double w = stack.width, top = 1.25 * stack.height, wall = 0.005;
    const auto box = [&](double x0, double y0, double x1, double y1, int body, bool driven) {
        recording.outlines.push_back(
            {OutlineInfo::Kind::Polygon, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, 0.0, body, driven});
    };
    box(-1.0, -0.5, w + 1.0, 0.0, 0, false); // a floor much larger than the stack
    box(-wall, 0.0, 0.0, top, 0, false);
    box(w, 0.0, w + wall, top, 0, false);
    box(-0.5 * w, 0.0, 0.5 * w, 0.008, 1, true);
}

void addSeries(Recording& recording, const Stack& stack, int rows) {
    recording.series.names = {"time_s",
                              "displacement_m",
                              "force_N",
                              "work_in_J",
                              "elastic_J",
                              "gravity_J",
                              "kinetic_J",
                              "friction_J",
                              "impact_J",
                              "effects_J",
                              "numerical_dissipation_J",
                              "position_correction_J",
                              "residual_J",
                              "step_s"};
    recording.series.columns.resize(recording.series.names.size());
    double work = 0.0, lost = 0.0;
    CrossheadState before = crossheadAt(stack, 0.0);
    for (int i = 0; i < rows; ++i) {
        const double t = stack.end() * i / std::max(rows - 1, 1);
        const CrossheadState now = crossheadAt(stack, t);
        const double dw = 0.5 * (now.force + before.force) * (now.displacement - before.displacement);
        work += dw;
        lost += now.load ? 0.45 * dw : 0.0;
        const double fallen = std::min(t / fall, 1.0),
                     gravity = 0.036 * fallen - 0.009 * now.displacement / stack.travel;
        const double kinetic = t < fall ? 4e-4 * chance(i, 8) : now.load && now.force < before.force ? 2e-3 : 1e-5;
        const double values[] = {t,
                                 now.displacement,
                                 now.force,
                                 work,
                                 std::max(work - lost, 0.0) * 0.97,
                                 gravity,
                                 kinetic,
                                 lost + 0.006 * fallen,
                                 0.02 * fallen,
                                 0.0,
                                 1.5e-3 * fallen,
                                 -6e-4 * fallen,
                                 3e-7 * (chance(i, 9) - 0.5) + 2e-7 * t / stack.end(),
                                 1e-4 + 4e-4 * chance(i, 10)};
        for (std::size_t k = 0; k < std::size(values); ++k)
            recording.series.columns[k].push_back(values[k]);
        before = now;
    }
}

void addEvents(Recording& recording, const Stack& stack) {
    const double start = fall + rest;
    recording.events.push_back({start, 0.0, 0.0, "first_contact", "plate meets the pile"});
    for (int k = 1; k <= snapFits; ++k) {
        const double u = 0.2 + 0.7 * (k - 0.5 + 0.4 * chance(k, 1)) / snapFits;
        recording.events.push_back(
            {start + u * branch, u * stack.travel, loadingForce(u), "snap_fit",
             "shell " + std::to_string(k * 3) + " closes over shell " + std::to_string(k * 3 + 1)});
    }
    recording.events.push_back({start + branch, stack.travel, loadingForce(1.0), "peak", ""});
    recording.events.push_back({start + branch, stack.travel, loadingForce(1.0), "reversal", "force reached 5 N"});
}

void addNumbers(Recording& recording, const Stack& stack) {
    recording.summary = {{"scene", std::string("stack30")},
                         {"seed", std::int64_t{1}},
                         {"simulated_s", stack.end()},
                         {"steps", std::int64_t{30412}},
                         {"threads", std::int64_t{2}},
                         {"H0_over_R", stack.height / R},
                         {"delta_max_over_R", stack.travel / R},
                         {"dissipation_ratio", 0.1342},
                         {"snap_fits", std::int64_t{snapFits}},
                         {"peak_force_N", 5.0},
                         {"peak_force_R2_over_B", 8.05},
                         {"energy_residual_relative", 3.2e-6},
                         {"penetration_max_over_h", 0.031},
                         {"crossings", std::int64_t{0}},
                         {"length_error_max", 0.0},
                         {"contact_residual_max", 8.1e-9},
                         {"unconverged_steps", std::int64_t{0}},
                         {"converged", true}};
    recording.timing = {{"wall_s", 41.7}};
    recording.parameters = {
        {"shells", 1.0 * stack.shells}, {"phi_bar", 0.75},  {"mu", 0.35},      {"cycles", 1.0 * stack.cycles},
        {"plate_speed", 0.005},         {"max_force", 5.0}, {"elements", 15.0}};
    for (std::size_t k = 3; k < 13 && !recording.series.columns[k].empty(); ++k)
        recording.energy.emplace_back(recording.series.names[k], recording.series.columns[k].back());
    for (int c = 1; c <= stack.cycles; ++c)
        recording.cycles.push_back({stack.travel / R, 0.134 / c, c == 1 ? snapFits : 0, 0.042 / c});
}

} // namespace

Recording squeezedStack(int shells, int frames, int rows, int cycles) {
    const Stack stack = layout(shells, cycles);
    Recording recording;
    recording.scene = "stack" + std::to_string(shells);
    recording.about =
        "Shells dropped one by one at random into a container, then squeezed by a plate to 5 N and released.";
    recording.R = R;
    recording.B = B;
    for (int i = 0; i < shells; ++i)
        recording.shells.push_back({"shell " + std::to_string(i + 1), 1.5 * pi * R, h, B, false,
                                    std::vector<double>(elements, 1.5 * pi * R / elements),
                                    std::vector<double>(elements, 1.0 / R)});
    addOutlines(recording, stack);
    for (int i = 0; i < frames; ++i)
        recording.frames.push_back(frameOf(stack, stack.end() * i / std::max(frames - 1, 1)));
    if (frames > 2) {
        const auto at = [&](double t) {
            return static_cast<std::int32_t>(std::lround(t / stack.end() * (frames - 1)));
        };
        recording.keyFrames = {at(fall + rest), at(fall + rest + branch), frames - 1};
    }
    addSeries(recording, stack, rows);
    addEvents(recording, stack);
    addNumbers(recording, stack);
    return recording;
}

Recording rollingRing(int frames) {
    Recording recording;
    recording.scene = "ring";
    recording.shells.push_back({"ring", 2.0 * pi * R, h, B, true, std::vector<double>(8, 2.0 * pi * R / 8), {}});
    recording.outlines.push_back({OutlineInfo::Kind::Polyline, {{-1.0, 0.0}, {1.0, 0.0}}, 0.0, 0, false});
    recording.outlines.push_back({OutlineInfo::Kind::Circle, {}, 0.01, 1, false});
    for (int i = 0; i < frames; ++i) {
        Frame frame;
        frame.time = 0.05 * i;
        const double a = -1.5 * frame.time;
        frame.shells.push_back({{R * std::sin(a) - R * a, R - R * std::cos(a)},
                                a,
                                std::vector<float>(8, static_cast<float>(1.0 / R)),
                                0.0});
        frame.bodies = {{}, {0.08, 0.01, 0.0}};
        recording.frames.push_back(frame);
    }
    return recording;
}

} // namespace supercircle::test
