#pragma once
// Recording of a run: series of named columns, frames of the motion, events and the flat summary.

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace supercircle::record {

/// Equal-length columns; names carry their unit as suffix (`force_N`). The first column of a run is `time_s`.
struct Series {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
    /// Column by name, nullptr if there is none.
    [[nodiscard]] const std::vector<double>* find(const std::string& name) const {
        for (std::size_t i = 0; i < names.size(); ++i)
            if (names[i] == name)
                return &columns[i];
        return nullptr;
    }
};

/// What does not change about a shell, for drawing.
struct ShellInfo {
    std::string name;
    double length = 0.0;          ///< m
    double thickness = 0.0;       ///< m
    double bending_modulus = 0.0; ///< N m^2
    bool closed = false;
    std::vector<double> element_length;    ///< m
    std::vector<double> natural_curvature; ///< 1/m
};

/// An outline for drawing, in its body's frame.
struct OutlineInfo {
    enum class Kind : std::uint8_t { Polyline, Polygon, Circle } kind = Kind::Polygon;
    std::vector<std::array<double, 2>> points; ///< m
    double radius = 0.0;                       ///< m, circle
    std::int32_t body = 0;                     ///< index into Frame::bodies
    bool driven = false;                       ///< carried by the crosshead: drawn darker
};

struct ShellPose {
    std::array<double, 2> start{}; ///< first end, m
    double angle = 0.0;            ///< tangent angle at the first end, rad
    std::vector<float> curvature;  ///< per element, 1/m
    double bending_energy = 0.0;   ///< J
};

struct BodyPose {
    double x = 0.0, y = 0.0, angle = 0.0; ///< centre of mass frame, m, rad
};

struct ContactMark {
    double x = 0.0, y = 0.0;   ///< m
    double fx = 0.0, fy = 0.0; ///< mean force over the step on side A, N
    bool slips = false;
};

struct Frame {
    double time = 0.0;             ///< s
    double displacement = 0.0;     ///< m
    double force = 0.0;            ///< N
    std::string phase;             ///< "drop", "settle", "load 1", "unload 1", ...
    std::vector<ShellPose> shells; ///< shells not dropped yet are absent: size may grow
    std::vector<BodyPose> bodies;
    std::vector<ContactMark> contacts;
};

struct Event {
    double time = 0.0;
    double displacement = 0.0; ///< m
    double force = 0.0;        ///< N
    std::string kind;          ///< "snap_fit", "peak", "first_contact", "reversal", "unconverged", ...
    std::string text;
};

struct Cycle {
    double delta_max_over_R = 0.0;
    double dissipation_ratio = 0.0; ///< dissipated work over peak force times delta_max
    int snap_fits = 0;
    double dissipated_J = 0.0;
};

using Value = std::variant<double, std::int64_t, bool, std::string>;

struct Recording {
    std::string scene;
    std::string about;
    std::vector<std::pair<std::string, Value>> summary; ///< flat, in the order to be written
    std::vector<std::pair<std::string, double>> parameters;
    std::vector<std::string> parameterUnits;                    ///< beside `parameters`, for the report; may be empty
    std::vector<std::pair<std::string, double>> timing, energy; ///< work_in_J, elastic_J, ... final balance
    std::vector<Cycle> cycles;
    Series series; ///< time_s, displacement_m, force_N, then the energy balance over time (J), step size, ...
    std::vector<ShellInfo> shells;
    std::vector<OutlineInfo> outlines;
    std::vector<Frame> frames;
    std::vector<Event> events;
    std::array<std::int32_t, 3> keyFrames{-1, -1, -1}; ///< before, at the peak, after (indices into frames; -1: none)
    double R = 0.0192, B = 0.0;                        ///< scales for the second axes
};

} // namespace supercircle::record
