#include "tests/reference_simulator/description.h"
#include "tests/reference_simulator/json_text.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace supercircle::reference_simulator {

namespace {

using Json = nlohmann::ordered_json;

Vec2 vec(const Json& j) {
    return {j.at(0).get<double>(), j.at(1).get<double>()};
}

Json list(const Vec2& v) {
    return {v.x(), v.y()};
}

const char* carrier(bool onCrosshead) {
    return onCrosshead ? "machine_head" : "ground";
}

Specimen specimenOf(const Json& j) {
    Specimen s;
    s.length = j.at("arc_length_m");
    s.curvature = j.at("natural_curvature_1_m");
    s.thickness = j.at("thickness_m");
    s.modulus = j.at("bending_modulus_N_m2");
    s.linearMass = j.at("linear_mass_kg_m");
    s.stretchModulus = j.value("stretch_modulus_N", 1.1e4);
    const Json& c = j.at("clamp");
    const std::string where = c.at("where");
    s.clamp = where == "middle" ? ClampAt::Middle : where == "first_end" ? ClampAt::FirstEnd : ClampAt::None;
    if (s.clamp != ClampAt::None) {
        s.onCrosshead = c.at("carried_by") == "machine_head";
        s.point = vec(c.at("initial_point_m"));
        s.angle = c.at("initial_tangent_angle_rad");
    }
    return s;
}

Obstacle obstacleOf(const Json& j) {
    Obstacle o;
    o.cylinder = j.at("type") == "cylinder";
    o.point = vec(j.at(o.cylinder ? "center_m" : "point_m"));
    if (o.cylinder)
        o.radius = j.at("radius_m");
    else
        o.normal = vec(j.at("normal_towards_specimen"));
    o.onCrosshead = j.at("carried_by") == "machine_head";
    return o;
}

Json clampOf(const Specimen& s) {
    if (s.clamp == ClampAt::None)
        return {{"where", "none"}, {"initial_placement", "stands on the floor, apex at x=0, apex tangent horizontal"}};
    return {{"where", s.clamp == ClampAt::Middle ? "middle" : "first_end"},
            {"arc_position_m", s.clamp == ClampAt::Middle ? 0.5 * s.length : 0.0},
            {"clamped_length_m", 0.0},
            {"carried_by", carrier(s.onCrosshead)},
            {"initial_point_m", list(s.point)},
            {"initial_tangent_angle_rad", s.angle}};
}

Json specimensOf(const Description& d) {
    Json all = Json::array();
    for (std::size_t i = 0; i < d.nominal.specimens.size(); ++i) {
        const Specimen& s = d.nominal.specimens[i];
        const double h = s.thickness;
        all.push_back({{"id", std::string(1, char('A' + i))},
                       {"arc_length_m", s.length},
                       {"natural_curvature_1_m", s.curvature},
                       {"natural_curvature_rel_unc", d.curvatureRelUnc},
                       {"thickness_m", h},
                       {"thickness_unc_m", d.thicknessUnc},
                       {"width_m", d.width},
                       {"young_modulus_Pa", 12.0 * s.modulus / (d.width * h * h * h)},
                       {"bending_modulus_N_m2", s.modulus},
                       {"bending_modulus_rel_unc", d.modulusRelUnc},
                       {"stretch_modulus_N", s.stretchModulus},
                       {"linear_mass_kg_m", s.linearMass},
                       {"linear_mass_rel_unc", d.massRelUnc},
                       {"clamp", clampOf(s)}});
    }
    return all;
}

Json obstaclesOf(const Description& d) {
    Json all = Json::array();
    for (const Obstacle& o : d.nominal.obstacles) {
        Json j = {{"type", o.cylinder ? "cylinder" : "plane"}};
        if (o.cylinder) {
            j["center_m"] = list(o.point);
            j["radius_m"] = o.radius;
        } else {
            j["point_m"] = list(o.point);
            j["normal_towards_specimen"] = list(o.normal);
        }
        j["carried_by"] = carrier(o.onCrosshead);
        all.push_back(j);
    }
    return all;
}

Json runsOf(const Description& d) {
    Json all = Json::array();
    for (const RunPlan& r : d.runs) {
        Json millimetres = Json::array();
        for (const double x : r.drive.displacement)
            millimetres.push_back(std::round(1e9 * x) / 1e6);
        Json j = {{"file", r.file},
                  {"drive_time_s", r.drive.time},
                  {"drive_displacement_mm", millimetres},
                  {"sampling_hz", r.sampling},
                  {"specimen_state_at_start", "fresh specimen of the same batch, unloaded and rested"}};
        if (r.specimenReversed)
            j["specimen_turned"] = true;
        if (!d.markers.empty() && r.markersTracked) {
            j["markers_file"] = r.markersFile;
            j["markers_sampling_hz"] = r.markersSampling;
        }
        all.push_back(j);
    }
    return all;
}

} // namespace

std::vector<double> RunPlan::times(double rate) const {
    std::vector<double> out;
    for (int i = 0; i / rate < drive.time.back() - 1e-9; ++i)
        out.push_back(i / rate);
    return out;
}

Description readDescription(const std::string& file) {
    std::ifstream in(file);
    if (!in)
        throw std::runtime_error(file + ": cannot be read");
    const Json j = parseOrderedJson(in);
    Description d;
    d.protocol = j.at("protocol");
    d.description = j.value("description", "");
    d.nominal.gravity = vec(j.at("gravity_m_s2"));
    d.nominal.friction = j.at("friction").at("coefficient");
    for (const Json& s : j.at("specimens"))
        d.nominal.specimens.push_back(specimenOf(s));
    for (const Json& o : j.at("obstacles"))
        d.nominal.obstacles.push_back(obstacleOf(o));
    for (const Json& r : j.at("runs")) {
        RunPlan p;
        p.file = r.at("file");
        p.markersFile = r.value("markers_file", "");
        p.drive.time = r.at("drive_time_s").get<std::vector<double>>();
        for (const double x : r.at("drive_displacement_mm"))
            p.drive.displacement.push_back(1e-3 * x);
        p.sampling = r.at("sampling_hz");
        p.markersSampling = r.value("markers_sampling_hz", 5.0);
        p.specimenReversed = r.value("specimen_turned", false);
        p.markersTracked = r.contains("markers_file");
        d.runs.push_back(p);
    }
    if (j.contains("markers"))
        for (const Json& m : j.at("markers"))
            d.markers.push_back({m.at("specimen").get<std::string>()[0] - 'A', m.at("arc_fraction")});
    return d;
}

std::string writeDescription(const Description& d) {
    Json markers = Json::array();
    for (std::size_t m = 0; m < d.markers.size(); ++m)
        markers.push_back({{"name", "m" + std::to_string(m)},
                           {"specimen", std::string(1, char('A' + d.markers[m].specimen))},
                           {"arc_fraction", d.markers[m].arcFraction}});
    Json j = {
        {"schema", "rod-recordings/1"},
        {"protocol", d.protocol},
        {"description", d.description},
        {"frame", "x to the right, y upwards, origin on the axis of symmetry of the set-up; displacement is positive "
                  "when the machine head moves down (-y); force is positive when the specimen resists"},
        {"arc_convention", "arc length runs from the first end; tangent angle from +x, counter-clockwise; positive "
                           "natural curvature turns the tangent counter-clockwise with increasing arc length"},
        {"gravity_m_s2", list(d.nominal.gravity)},
        {"uncertainty_meaning", "half-width of a uniform interval"},
        {"specimens", specimensOf(d)},
        {"obstacles", obstaclesOf(d)},
        {"contact_thickness", "the specimen is a centreline with half-thickness h/2 on each side, also at obstacles"},
        {"friction", {{"coefficient", d.nominal.friction}, {"coefficient_unc", d.frictionUnc}}},
        {"initial_gap_unc_m", d.gapUnc},
        {"runs", runsOf(d)},
        {"sensors",
         {{"force_noise_std_N_approx", d.noise},
          {"force_zero", "the mean reading of the first 0.5 s is subtracted"},
          {"displacement_channel", "commanded cross-head displacement"},
          {"displacement_noise_std_mm_approx", 1e3 * d.displacementNoise},
          {"marker_noise_std_mm_approx", 1e3 * d.markerNoise}}}};
    if (!d.markers.empty())
        j["markers"] = markers;
    return jsonText(j) + "\n";
}

Setup trueSetup(const Description& d, const Offsets& o, const Effects& effects) {
    Setup s = d.nominal;
    for (Specimen& a : s.specimens) {
        a.modulus *= 1.0 + o.modulus * d.modulusRelUnc;
        a.curvature *= 1.0 + o.curvature * d.curvatureRelUnc;
        a.thickness += o.thickness * d.thicknessUnc;
        a.linearMass *= 1.0 + o.mass * d.massRelUnc;
    }
    s.friction += o.friction * d.frictionUnc;
    s.crossheadOffset = o.gap * d.gapUnc;
    s.effects = effects;
    return s;
}

} // namespace supercircle::reference_simulator
