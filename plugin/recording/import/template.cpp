#include "plugin/recording/import/template.h"

#include "plugin/recording/import/derive.h"
#include "plugin/recording/import/free_run.h"
#include "plugin/recording/import/reading/metadata.h"
#include "plugin/recording/import/scene_run.h"
#include "plugin/recording/import/specimen_file.h"
#include "plugin/recording/table/json_text.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace supercircle::importing {

namespace {

using Json = nlohmann::ordered_json;

const Json kNothing = nullptr;

Json clampOf(const std::string& protocol, bool lower) {
    if (protocol == "arch_between_plates")
        return {{"where", "none"}, {"initial_placement", "stands on the floor, apex at x=0, apex tangent horizontal"}};
    if (protocol == "ring_between_plates")
        return {{"where", "none"}, {"initial_placement", "a ring on the floor"}};
    if (protocol == "tethered_strip")
        return {{"where", "middle"},
                {"clamped_length_m", 0.0},
                {"carried_by", "ground"},
                {"initial_point_m", {0.0, 0.0}},
                {"initial_tangent_angle_rad", 0.0}};
    const bool strip = protocol == "strip_on_rigid_floor";
    return {{"where", strip ? "first_end" : "middle"},
            {"clamped_length_m", 0.0},
            {"carried_by", lower ? "ground" : "machine_head"},
            {"initial_point_m", {0.0, lower ? Json(0.0) : kNothing}},
            {"initial_tangent_angle_rad", strip ? -M_PI / 2.0 : M_PI}};
}

Json specimenOf(const std::string& id, const std::string& protocol, bool lower) {
    return {{"id", id},
            {"arc_length_m", kNothing},
            {"natural_curvature_1_m", kNothing},
            {"natural_curvature_rel_unc", 0.01},
            {"thickness_m", kNothing},
            {"thickness_unc_m", 1e-5},
            {"width_m", kNothing},
            {"young_modulus_Pa", kNothing},
            {"bending_modulus_N_m2", kNothing},
            {"bending_modulus_rel_unc", 0.1},
            {"linear_mass_kg_m", kNothing},
            {"linear_mass_rel_unc", 0.05},
            {"clamp", protocol.empty() ? kNothing : clampOf(protocol, lower)}};
}

Json plane(double ny, const Json& y, const char* carrier) {
    return {{"type", "plane"}, {"point_m", {0.0, y}}, {"normal_towards_specimen", {0.0, ny}}, {"carried_by", carrier}};
}

Json obstaclesOf(const std::string& protocol) {
    if (protocol.empty())
        return kNothing;
    Json all = Json::array();
    if (protocol == "shell_on_rigid_cylinder")
        all.push_back(
            {{"type", "cylinder"}, {"center_m", {0.0, 0.0}}, {"radius_m", kNothing}, {"carried_by", "ground"}});
    else if (protocol != "two_shells" && protocol != "tethered_strip")
        all.push_back(plane(1.0, 0.0, "ground"));
    if (protocol == "arch_between_plates" || protocol == "ring_between_plates")
        all.push_back(plane(-1.0, kNothing, "machine_head"));
    return all;
}

/// To a power of ten below 2e-7 of the range: below the resolution of a machine.
double rounded(double value, double range) {
    const double digits = -std::floor(math::log10(2e-7 * range)); // a whole number; its power of ten is exact
    const double scale = math::pow(10.0, std::abs(digits));
    const double r = digits >= 0.0 ? std::round(value * scale) / scale : std::round(value / scale) * scale;
    return r == 0.0 || !std::isfinite(r) ? 0.0 : r;
}

/// Break points as written: exact dwells; first and last include all samples.
Json runOf(const ImportedRun& run, const std::string& specimen) {
    Json times = Json::array(), ways = Json::array();
    std::vector<double> d = run.drive.displacement;
    if (!d.empty() && std::abs(d[0]) < run.drive.tolerance)
        d[0] = 0.0;
    for (std::size_t i = 1; i < d.size(); ++i)
        if (std::abs(d[i] - d[i - 1]) < run.drive.tolerance)
            d[i] = d[i - 1];
    double travel = 0.0;
    for (const double v : d)
        travel = std::max(travel, 1e3 * std::abs(v));
    for (std::size_t i = 0; i < d.size(); ++i) {
        times.push_back(rounded(run.drive.time[i], run.drive.time.back()));
        ways.push_back(rounded(1e3 * d[i], travel));
    }
    Json json = {{"file", run.file},
                 {"drive_time_s", times},
                 {"drive_displacement_mm", ways},
                 {"sampling_hz", rounded(run.rate, run.rate)},
                 {"specimen_state_at_start", "(fresh or used, rested or not)"}};
    if (!specimen.empty())
        json["about"] = specimen;
    if (!run.markersFile.empty()) {
        const std::vector<double>& t = *run.markers.find(Quantity::Time);
        json["markers_file"] = run.markersFile;
        const double rate = static_cast<double>(t.size() - 1) / (t.back() - t.front());
        json["markers_sampling_hz"] = rounded(rate, rate);
    }
    return json;
}

Json frameOf(const Imported& all, const std::string& protocol) {
    Json runs = Json::array(), markers = Json::array(), specimens = Json::array();
    double noise = 0.0, window = all.runs.empty() ? 0.0 : all.runs.front().forceZeroWindow, displacementNoise = 0.0;
    for (const ImportedRun& run : all.runs) {
        runs.push_back(runOf(run, all.sources[run.source].table.specimen));
        noise = std::max(noise, run.forceNoise);
        displacementNoise = std::max(displacementNoise, run.drive.noise);
        window = std::min(window, run.forceZeroWindow);
    }
    for (const std::string& name : all.markerNames)
        markers.push_back({{"name", name}, {"specimen", "A"}, {"arc_fraction", kNothing}});
    const bool two = protocol == "two_shells";
    specimens.push_back(specimenOf("A", protocol, two));
    if (two)
        specimens.push_back(specimenOf("B", protocol, false));
    Json json = {
        {"schema", "rod-recordings/1"},
        {"protocol", protocol.empty() ? kNothing : Json(protocol)},
        {"description", "(describe the set-up)"},
        {"gravity_m_s2", {0.0, -9.81}},
        {"uncertainty_meaning", "half-width of a uniform interval"},
        {"specimens", specimens},
        {"obstacles", obstaclesOf(protocol)},
        {"friction", {{"coefficient", kNothing}, {"coefficient_unc", 0.1}}},
        {"initial_gap_unc_m", 1e-4},
        {"runs", runs},
        {"sensors",
         {{"force_noise_std_N_approx", noise},
          {"force_zero",
           window > 0.0 ? Json("the mean reading of the first " + shown(window) + " s is subtracted") : Json("none")},
          {"displacement_channel", "as the machine reports it"},
          {"displacement_noise_std_mm_approx", 1e3 * displacementNoise},
          {"marker_noise_std_mm_approx", 0.0}}},
        {"markers", markers}};
    if (all.forceUnitConfirmed)
        json["sensors"]["force_unit_confirmed"] = true;
    for (int end = 0; end < 2 && protocol == "tethered_strip"; ++end)
        json["strings"].push_back(
            {{"arc_fraction", end}, {"to_point_m", {0.0, kNothing}}, {"carried_by", "machine_head"}});
    return json;
}

/// Values of `from` replace those of `into`. Lists of objects of equal length are merged by item, and a list of one
/// specimen applies to all.
void merge(Json& into, const Json& from) {
    if (into.is_object() && from.is_object()) {
        for (const auto& [key, value] : from.items())
            if (value.is_null())
                continue; // not stated there either
            else if (into.contains(key))
                merge(into[key], value);
            else
                into[key] = value;
    } else if (into.is_array() && from.is_array() && into.size() == from.size() && !into.empty() &&
               into[0].is_object()) {
        for (std::size_t i = 0; i < into.size(); ++i)
            merge(into[i], from[i]);
    } else {
        into = from;
    }
}

/// Whether a file describes one specimen and nothing else: it has members of the frame's specimens at its top.
bool isSpecimen(const Json& own, const Json& frame) {
    const Json& specimen = frame["specimens"][0];
    return std::any_of(own.items().begin(), own.items().end(),
                       [&](const auto& member) { return member.key() != "id" && specimen.contains(member.key()); });
}

void addOwn(Json& json, const Json& own) {
    if (!isSpecimen(own, json)) {
        merge(json, own);
        return;
    }
    for (Json& specimen : json["specimens"]) {
        const Json id = specimen["id"];
        merge(specimen, own);
        specimen["id"] = id;
    }
}

bool states(const Json& own, const std::string& pointer) {
    const Json::json_pointer at(pointer);
    return own.contains(at) && !own[at].is_null();
}

/// Assumptions of the template that the user did not replace.
std::vector<std::string> assumed(const Json& json, const Json& own, bool one) {
    std::vector<std::string> all;
    const auto look = [&](const std::string& pointer, const std::string& inOwn) {
        if (!states(own, inOwn))
            all.push_back(pointer + ": " + record::jsonText(json[Json::json_pointer(pointer)], -1));
    };
    look("/gravity_m_s2", "/gravity_m_s2");
    for (std::size_t i = 0; json["specimens"].is_array() && i < json["specimens"].size(); ++i)
        for (const char* key :
             {"natural_curvature_rel_unc", "thickness_unc_m", "bending_modulus_rel_unc", "linear_mass_rel_unc"}) {
            const std::string in = "/specimens/" + std::to_string(i) + "/" + key;
            look(in, one ? "/" + std::string(key) : in);
        }
    look("/friction/coefficient_unc", "/friction/coefficient_unc");
    look("/initial_gap_unc_m", "/initial_gap_unc_m");
    return all;
}

std::string text(const Json& json) {
    return record::jsonText(json);
}

const char* expectedAt(const std::string& key) {
    static const std::vector<std::pair<const char*, const char*>> kWords = {
        {"scene", "the scene file with the bodies and joints, beside this file; --scene FILE gives it"},
        {"body", "name of the body whose angle was recorded"},
        {"protocol",
         "shell_on_rigid_cylinder, two_shells, strip_on_rigid_floor, arch_between_plates, ring_between_plates, "
         "tethered_strip, free_scene or scene"},
        {"arc_length_m", "length along the strip, m"},
        {"natural_curvature_1_m", "1 / radius of the unloaded specimen, 1/m; 0: straight"},
        {"thickness_m", "m"},
        {"width_m", "m (take the line out if unknown)"},
        {"young_modulus_Pa",
         "Pa (with width and thickness it gives the bending modulus; take the line out if unknown)"},
        {"bending_modulus_N_m2", "E w h^3 / 12, N m^2; import computes it if --specimen gives E, w and h"},
        {"linear_mass_kg_m", "mass / length, kg/m"},
        {"clamp", "how the specimen is clamped; set by --protocol NAME"},
        {"obstacles", "obstacles; set by --protocol NAME"},
        {"radius_m", "m"},
        {"coefficient", "friction coefficient"},
        {"arc_fraction", "where on the specimen: 0 first end, 1 last end"},
        {"1", "height at displacement 0, m (derived from first contact once the specimen is known)"}};
    for (const auto& [name, words] : kWords)
        if (key == name)
            return words;
    return "";
}

/// Pointers to what is null, with what is expected there. A member beside it that `frame` does not have may be the same
/// with a slip of the pen.
void collectTodo(const Json& json, const Json& frame, const std::string& pointer, std::vector<std::string>& todo) {
    if (json.is_object()) {
        std::vector<std::string> strange;
        for (const auto& [key, value] : json.items())
            if (!frame.contains(key) && !value.is_null())
                strange.push_back(key);
        for (const auto& [key, value] : json.items()) {
            collectTodo(value, frame.contains(key) ? frame[key] : kNothing, pointer + "/" + key, todo);
            if (const std::string near = value.is_null() ? nearestName(key, strange) : ""; !near.empty())
                todo.back() += "; is it what is called \"" + near + "\" there?";
        }
    } else if (json.is_array()) {
        for (std::size_t i = 0; i < json.size(); ++i)
            collectTodo(json[i], frame.is_array() && i < frame.size() ? frame[i] : kNothing,
                        pointer + "/" + std::to_string(i), todo);
    } else if (json.is_null()) {
        const std::string key = pointer.substr(pointer.rfind('/') + 1), words = expectedAt(key);
        todo.push_back(pointer + (words.empty() ? "" : ": " + words));
    }
}

/// Sizes that the header of an export states and the user does not.
void addSizes(Json& json, const Imported& all, std::vector<std::string>& remarks) {
    if (all.sources.size() != 1 || json["specimens"].size() != 1)
        return; // which specimen is meant?
    for (const auto& [key, what] :
         {std::pair{"width_m", MetadataKey::Width}, {"thickness_m", MetadataKey::Thickness}}) {
        Json& size = json["specimens"][0][key];
        const auto stated = metadataValue(all.sources[0].table.layout.metadata, what);
        if (!size.is_null() || !stated)
            continue;
        size = stated->value;
        remarks.push_back("/specimens/0/" + std::string(key) + " is " + shown(stated->value) + ", from line " +
                          std::to_string(stated->line) + " of the export");
    }
}

Description fillIn(const Imported& all, const std::string& protocol, const Json& own) {
    Description result;
    const Json frame = frameOf(all, protocol);
    Json json = frame, taken = own;
    if (own.contains("runs") && own["runs"].size() != all.runs.size()) {
        taken.erase("runs");
        result.remarks.push_back("the runs of the file with the specimen are not taken: there are " +
                                 std::to_string(own["runs"].size()) + ", here " + std::to_string(all.runs.size()));
    }
    addOwn(json, taken);
    addSizes(json, all, result.remarks);
    json = record::parseJson(withDerivedValues(text(json), all, result.remarks));
    collectTodo(json, frame, "", result.todo);
    result.assumed = assumed(json, own, isSpecimen(own, frame));
    result.json = text(json) + "\n";
    return result;
}

/// With the user's own values.
Result<Description> filled(Result<Description>&& result, const Json& own) {
    if (!result)
        return result;
    const Json frame = record::parseJson(result->json);
    Json json = frame;
    merge(json, own);
    std::erase_if(result->assumed, [&](const std::string& s) { return states(own, s.substr(0, s.find(':'))); });
    std::string exact;
    for (const auto& [name, value] : frame["scene_parameters"].items())
        if (states(own, "/scene_parameters/" + name))
            json["scene_parameters"][name] =
                own["scene_parameters"][name]; // whole: a width of another kind may stand there
        else
            exact += (exact.empty() ? "" : ", ") + name;
    if (!exact.empty())
        result->assumed.push_back("/scene_parameters: the scene's own values, exact, of " + exact);
    collectTodo(json, frame, "", result->todo);
    result->json = text(json) + "\n";
    return std::move(result);
}

/// Whether a recording with forces belongs to a scene, and to which: that of the option, or of the user's own file.
Status chooseScene(const Json& own, std::string& protocol, TemplateOptions& options) {
    if (protocol.empty() && !options.sceneFile.empty())
        protocol = "scene";
    if (protocol != "scene")
        return options.sceneFile.empty() ? Status()
                                         : Status::failure("--scene is for the protocol scene, and this is " +
                                                           protocol + "; expected one of the two");
    if (!options.sceneFile.empty())
        return {};
    if (!own.contains("scene") || !own["scene"].is_string())
        return Status::failure("the protocol scene needs a scene; give its file or its name with --scene");
    options.sceneFile = own["scene"];
    std::error_code missing;
    const auto beside = std::filesystem::path(options.specimenFile).parent_path() / options.sceneFile;
    if (std::filesystem::is_regular_file(beside, missing))
        options.sceneFile = beside.string();
    return {};
}

} // namespace

const std::vector<std::string>& protocols() {
    static const std::vector<std::string> kAll = {
        "shell_on_rigid_cylinder", "two_shells",     "strip_on_rigid_floor", "arch_between_plates",
        "ring_between_plates",     "tethered_strip", "free_scene",           "scene"};
    return kAll;
}

Result<Description> describe(const Imported& all, const TemplateOptions& options) {
    using Answer = Result<Description>;
    const auto& known = protocols();
    if (!options.protocol.empty() && std::find(known.begin(), known.end(), options.protocol) == known.end()) {
        std::string list;
        for (const std::string& p : known)
            list += (list.empty() ? "" : ", ") + p;
        return Answer::failure("there is no protocol \"" + options.protocol + "\"; expected one of " + list +
                               didYouMean(options.protocol, known));
    }
    Json own = Json::object();
    if (!options.specimenFile.empty()) {
        auto read = readSpecimenFile(options.specimenFile);
        if (!read)
            return Answer::failure(read.error());
        own = record::parseJson(*read);
    }
    const bool angles = std::all_of(all.runs.begin(), all.runs.end(),
                                    [](const ImportedRun& r) { return r.signals.find(Quantity::Force) == nullptr; });
    std::string protocol = options.protocol;
    if (own.contains("protocol") && own["protocol"].is_string()) {
        const std::string said = own["protocol"];
        if (!protocol.empty() && said != protocol)
            return Answer::failure(options.specimenFile + ": /protocol: this is \"" + said +
                                   "\", but --protocol says \"" + protocol + "\"; expected one protocol");
        if (std::find(known.begin(), known.end(), said) != known.end() && !(angles && said == "scene"))
            protocol = said;
    }
    TemplateOptions scene = options;
    if (!angles)
        if (Status chosen = chooseScene(own, protocol, scene); !chosen)
            return Answer::failure(chosen.error());
    if (const bool free = protocol == "free_scene"; free != angles || all.runs.empty()) {
        if (free || !protocol.empty())
            return Answer::failure(free ? "the protocol free_scene is about angles, and there are forces"
                                        : "there are angles only; protocol " + protocol +
                                              " is about forces, expected free_scene");
        for (const ImportedRun& r : all.runs)
            if (!angles && r.signals.find(Quantity::Force) == nullptr)
                return Answer::failure(r.file +
                                       " has an angle and no force, others have forces; expected one kind of run");
    }
    try {
        if (angles)
            return filled(describeFree(all, options), own);
        if (protocol == "scene")
            return filled(describeScene(all, scene, text(frameOf(all, "")["runs"])), own);
        return fillIn(all, protocol, own);
    } catch (const Json::exception& e) { // wrong types
        const std::string what = e.what();
        return Answer::failure(options.specimenFile + ": this is no part of an experiment: " +
                               what.substr(std::min(what.size(), what.find("] ") + 2)));
    }
}

} // namespace supercircle::importing
