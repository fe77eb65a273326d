#include "plugin/recording/experiment/load.h"

#include "plugin/recording/experiment/free_scene.h"
#include "plugin/recording/experiment/recording_quality.h"
#include "plugin/recording/experiment/scene_specimens.h"
#include "plugin/recording/experiment/values.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace supercircle::experiment {

namespace {

using scene::notNegative;
using scene::positive;

constexpr std::array kProtocolNames = {
    "shell_on_rigid_cylinder", "two_shells",     "strip_on_rigid_floor", "arch_between_plates",
    "ring_between_plates",     "tethered_strip", "free_scene",           "scene"};
const std::vector<std::string> kCarriers = {"ground", "machine_head"};
constexpr Limits kShare{0.0, 1.0, false};

Carrier readCarrier(Object& object) {
    return object.choice("carried_by", kCarriers) == 1 ? Carrier::Crosshead : Carrier::Ground;
}

/// `NAME` and its relative half-width `REL`.
Stated readRelative(Object& object, const std::string& name, const std::string& relative, const Limits& limits) {
    const double value = object.number(name, limits);
    return {value, std::abs(value) * object.number(relative, 0.0, notNegative)};
}

Clamp readClamp(Context& context, const Node& node, const std::string& pointer, double length) {
    Object object(context, node, pointer);
    Clamp clamp;
    if (!object.valid())
        return clamp;
    static const std::vector<std::string> places = {"none", "middle", "first_end"};
    const std::size_t where = object.choice("where", places);
    if (where == places.size()) // the other keys depend on it
        return clamp;
    clamp.where = static_cast<ClampPlace>(where);
    if (clamp.where == ClampPlace::None) {
        clamp.initialPlacement = object.text("initial_placement", "");
        for (const char* key :
             {"arc_position_m", "clamped_length_m", "carried_by", "initial_point_m", "initial_tangent_angle_rad"})
            object.find(key);
        object.finish();
        return clamp;
    }
    const double usual = clamp.where == ClampPlace::Middle ? 0.5 * length : 0.0;
    clamp.arcPosition = object.number("arc_position_m", usual, notNegative);
    if (clamp.arcPosition > length * (1.0 + 1e-9))
        object.error("arc_position_m", "the clamp lies beyond the end of the specimen", "at most arc_length_m");
    else if (std::abs(clamp.arcPosition - usual) > 1e-6 * length)
        object.note("arc_position_m", "this is not where \"where\" says; the arc position is taken");
    clamp.clampedLength = object.number("clamped_length_m", 0.0, notNegative);
    if (clamp.clampedLength > 0.0)
        object.note("clamped_length_m", "the clamp is taken as holding one section, not a length");
    clamp.carriedBy = readCarrier(object);
    clamp.initialPoint = object.pair("initial_point_m");
    clamp.initialTangentAngle = object.number("initial_tangent_angle_rad", scene::anyNumber);
    object.find("initial_placement");
    object.finish();
    return clamp;
}

Specimen readSpecimen(Context& context, const ArrayItem& place) {
    Object object(context, place);
    Specimen s;
    if (!object.valid())
        return s;
    s.id = object.text("id");
    s.length = object.number("arc_length_m", positive);
    s.naturalCurvature = readRelative(object, "natural_curvature_1_m", "natural_curvature_rel_unc", scene::anyNumber);
    s.thickness = {object.number("thickness_m", positive), object.number("thickness_unc_m", 0.0, notNegative)};
    s.width = object.number("width_m", 0.0, notNegative);
    s.youngModulus = object.number("young_modulus_Pa", 0.0, notNegative);
    s.bendingModulus = readRelative(object, "bending_modulus_N_m2", "bending_modulus_rel_unc", positive);
    s.stretchModulus = object.number("stretch_modulus_N", 0.0, notNegative);
    s.linearMass = readRelative(object, "linear_mass_kg_m", "linear_mass_rel_unc", positive);
    if (const std::optional<Node> clamp = object.required("clamp", "an object"))
        s.clamp = readClamp(context, *clamp, object.pointerTo("clamp"), s.length);
    if (s.thickness.lower() <= 0.0 && s.thickness.value > 0.0)
        object.error("thickness_unc_m", "the thickness may be zero within this", "less than thickness_m");
    object.finish();
    return s;
}

std::vector<Specimen> readSpecimens(Context& context, Object& top) {
    std::vector<Specimen> all;
    for (const ArrayItem& place : top.array("specimens", true)) {
        all.push_back(readSpecimen(context, place));
        for (std::size_t i = 0; i + 1 < all.size(); ++i)
            if (all[i].id == all.back().id)
                context.error(place.node, place.pointer + "/id", "there are two specimens \"" + all[i].id + "\"");
    }
    return all;
}

Obstacle readObstacle(Context& context, const ArrayItem& place) {
    Object object(context, place);
    Obstacle o;
    if (!object.valid())
        return o;
    const std::vector<std::string> types = {"cylinder", "plane"};
    const std::size_t type = object.choice("type", types);
    if (type == types.size()) // the other keys depend on it
        return o;
    o.kind = type == 1 ? ObstacleKind::Plane : ObstacleKind::Cylinder;
    if (o.kind == ObstacleKind::Cylinder) {
        o.point = object.pair("center_m");
        o.radius = object.number("radius_m", positive);
    } else {
        o.point = object.pair("point_m");
        o.normal = object.pair("normal_towards_specimen");
        const double size = math::hypot(o.normal.x, o.normal.y);
        if (size > 0.0)
            o.normal = {o.normal.x / size, o.normal.y / size};
        else if (object.find("normal_towards_specimen"))
            object.error("normal_towards_specimen", "a direction of length 0",
                         "a vector from the plane to the specimen");
    }
    o.carriedBy = readCarrier(object);
    object.finish();
    return o;
}

/// The drive; a free scene has a time only. A scene without a time lasts as long as its rows.
void readDrive(Object& object, Protocol protocol, Run& run) {
    if (protocol == Protocol::FreeScene) {
        run.driveTime = {0.0, object.number("duration_s", positive)};
        run.driveDisplacement = {0.0, 0.0};
        return;
    }
    if (protocol == Protocol::Scene && !object.find("drive_time_s")) {
        run.driveTime = {0.0, object.number("duration_s", 0.0, positive)};
        return;
    }
    run.driveTime = object.numbers("drive_time_s", scene::anyNumber);
    const char* key =
        protocol == Protocol::Scene && object.find("drive_value") ? "drive_value" : "drive_displacement_mm";
    const bool displacement = key[6] == 'd';
    for (const double value : object.numbers(key, scene::anyNumber))
        run.driveDisplacement.push_back((displacement ? 1e-3 : 1.0) * value);
    const std::size_t points = run.driveTime.size();
    if (run.driveDisplacement.size() != points)
        object.error(key, std::to_string(run.driveDisplacement.size()) + " break points",
                     std::to_string(points) + " as in drive_time_s");
    else if (points == 1)
        object.error("drive_time_s", "one break point", "at least two: start and end");
    for (std::size_t i = 1; i < points; ++i)
        if (!(run.driveTime[i] > run.driveTime[i - 1])) {
            object.error("drive_time_s", "break point " + std::to_string(i) + " is not later than the one before it",
                         "increasing times");
            break;
        }
}

/// `ignore_s`: pairs of times.
void readIgnored(Context& context, Object& object, Run& run) {
    if (!object.find("ignore_s"))
        return;
    for (const ArrayItem& item : object.array("ignore_s", false)) {
        std::vector<double> ends;
        for (const Node& end : item.node.children())
            ends.push_back(numberAt(context, end, item.pointer + "/" + std::to_string(ends.size()), scene::anyNumber));
        if (item.node.kind() != Node::Kind::Array || ends.size() != 2) {
            context.error(item.node, item.pointer, "not a part of the recording", "[from, to], s");
            continue;
        }
        const double from = ends[0], to = ends[1];
        if (!(to > from))
            context.error(item.node, item.pointer, "it ends before it begins", "[from, to], s");
        run.ignored.emplace_back(from, to);
    }
}

Run readRun(Context& context, const ArrayItem& place, const Experiment& e) {
    const Protocol protocol = e.protocol;
    const bool free = e.scene.has_value();
    Object object(context, place);
    Run run;
    if (!object.valid())
        return run;
    run.file = object.text("file");
    readDrive(object, protocol, run);
    readIgnored(context, object, run);
    if (free)
        run.parameters = readSceneParameters(context, object, "parameters");
    if (protocol == Protocol::Scene) {
        run.specimen = readSpecimenOfRun(object, run, *e.scene);
        run.start = object.number("start_s", 0.0, scene::anyNumber);
        run.samplingRate = object.number("sampling_hz", 0.0, positive);
    } else {
        run.samplingRate = object.number("sampling_hz", positive);
    }
    run.specimenState = object.text("specimen_state_at_start", "");
    if (!free)
        run.specimenReversed = object.flag("specimen_turned", false);
    run.markersFile = object.text("markers_file", "");
    run.markersSamplingRate = object.number("markers_sampling_hz", 0.0, notNegative);
    object.finish();
    return run;
}

/// The number of seconds in "the mean reading of the first 0.5 s is subtracted".
double zeroWindow(Object& object, const std::string& words) {
    if (words.empty() || words == "none")
        return 0.0;
    const std::size_t first = words.find("first ");
    double seconds = 0.0;
    if (first != std::string::npos) {
        const char* begin = words.data() + first + 6;
        const char* end = words.data() + words.size();
        const auto [rest, error] = std::from_chars(begin, end, seconds);
        if (error == std::errc{} && rest + 1 < end && rest[0] == ' ' && rest[1] == 's' && seconds > 0.0)
            return seconds;
    }
    object.note("force_zero", "not understood, nothing is subtracted; \"the mean reading of the first 0.5 s is "
                              "subtracted\" would be");
    return 0.0;
}

Sensors readSensors(Context& context, const Node& node, const std::string& pointer, const Experiment& e) {
    Object object(context, node, pointer);
    Sensors s;
    if (!object.valid())
        return s;
    const Channel& c = channel(e);
    s.forceNoise = e.sensors.forceNoise;
    if (e.protocol != Protocol::Scene) // whose channel says it
        s.forceNoise = object.number(c.name + "_noise_std_" + c.unit + "_approx", 0.0, notNegative) / c.perUnit;
    s.forceZeroWindow = zeroWindow(object, object.text("force_zero", ""));
    s.forceZeroHalfWidth = object.number("force_zero_unc_N", 0.0, notNegative);
    if (s.forceZeroHalfWidth > 0.0 && e.scene)
        object.note("force_zero_unc_N",
                    "free scenes have no force; /observed/zero_unc_deg or zero_unc_mm is the pose's");
    s.forceUnitConfirmed = object.flag("force_unit_confirmed", false);
    s.displacementChannel = object.text("displacement_channel", "");
    s.displacementNoise = 1e-3 * object.number("displacement_noise_std_mm_approx", 0.0, notNegative);
    s.markerNoise = 1e-3 * object.number("marker_noise_std_mm_approx", 0.0, notNegative);
    object.finish();
    return s;
}

std::vector<Marker> readMarkers(Context& context, Object& top, const std::vector<Specimen>& specimens, bool free) {
    std::vector<Marker> all;
    std::vector<std::string> ids;
    for (const Specimen& s : specimens)
        ids.push_back(s.id);
    if (!top.find("markers"))
        return all;
    for (const ArrayItem& place : top.array("markers", false)) {
        Object object(context, place);
        if (!object.valid())
            continue;
        Marker m;
        m.name = object.text("name");
        if (free && object.find("shell")) {
            m.body = object.text("shell");
            m.arcFraction = object.number("arc_fraction", kShare);
            object.finish();
            all.push_back(std::move(m));
            continue;
        }
        if (free) {
            m.body = object.text("body");
            m.local = object.find("local_point_m") ? object.pair("local_point_m") : Point{};
            object.finish();
            all.push_back(std::move(m));
            continue;
        }
        const std::string id = object.text("specimen");
        const auto found = std::find(ids.begin(), ids.end(), id);
        if (found == ids.end() && object.find("specimen"))
            object.error("specimen", "there is no specimen \"" + id + "\"", {}, nearestName(id, ids));
        m.specimen = found == ids.end() ? 0 : static_cast<std::size_t>(found - ids.begin());
        m.arcFraction = object.number("arc_fraction", kShare);
        object.finish();
        all.push_back(std::move(m));
    }
    return all;
}

bool tiedToBothEnds(const std::vector<Bowstring>& s) {
    return s.size() == 2 && std::abs(s[0].arcFraction - s[1].arcFraction) == 1.0 && s[0].point.x == s[1].point.x &&
           s[0].point.y == s[1].point.y && s[0].carriedBy == s[1].carriedBy;
}

/// Requirements of a protocol beyond the schema.
void checkProtocol(Context& context, Object& top, const Experiment& e) {
    const auto need = [&](bool good, const char* key, const std::string& expected) {
        if (!good)
            top.error(key, std::string("does not fit the protocol ") + name(e.protocol), expected);
    };
    if (e.scene)
        return;
    const bool moved =
        std::any_of(e.specimens.begin(), e.specimens.end(),
                    [](const Specimen& s) {
                        return s.clamp.where != ClampPlace::None && s.clamp.carriedBy == Carrier::Crosshead;
                    }) ||
        std::any_of(e.obstacles.begin(), e.obstacles.end(),
                    [](const Obstacle& o) { return o.carriedBy == Carrier::Crosshead; }) ||
        std::any_of(e.strings.begin(), e.strings.end(),
                    [](const Bowstring& s) { return s.carriedBy == Carrier::Crosshead; });
    if (!moved)
        context.error(context.document.root(), "", "the crosshead carries nothing",
                      "a clamp, an obstacle or a string carried by \"machine_head\"");
    need(e.specimens.size() == (e.protocol == Protocol::TwoShells ? 2U : 1U), "specimens",
         e.protocol == Protocol::TwoShells ? "two specimens" : "one specimen");
    const bool plates = e.protocol == Protocol::ArchBetweenPlates || e.protocol == Protocol::RingBetweenPlates;
    const bool bow = e.protocol == Protocol::TetheredStrip;
    const std::size_t obstacles = e.protocol == Protocol::TwoShells || bow ? 0 : plates ? 2 : 1;
    need(e.obstacles.size() == obstacles, "obstacles",
         obstacles == 0   ? "no obstacle"
         : obstacles == 1 ? "one obstacle"
                          : "a floor and a plate");
    need(bow == !e.strings.empty(), "strings", bow ? "strings from the specimen to the crosshead" : "no strings");
    need(!bow || (e.specimens.size() == 1 && e.specimens.front().clamp.where == ClampPlace::Middle), "specimens",
         "a strip clamped at its middle");
    need(!bow || tiedToBothEnds(e.strings), "strings", "one string from each end (arc_fraction 0 and 1) to one point");
    need(e.protocol != Protocol::RingBetweenPlates || e.specimens.front().clamp.where == ClampPlace::None, "specimens",
         "a ring without a clamp");
    const bool standing = std::any_of(e.specimens.begin(), e.specimens.end(),
                                      [](const Specimen& s) { return s.clamp.where == ClampPlace::None; });
    const bool floor = std::any_of(e.obstacles.begin(), e.obstacles.end(), [](const Obstacle& o) {
        return o.kind == ObstacleKind::Plane && o.carriedBy == Carrier::Ground && o.normal.y > 0.5;
    });
    need(!standing || floor, "obstacles", "a plane on the ground, facing up, for a specimen without a clamp");
}

/// Node of a JSON pointer; the deepest existing one.
Node nodeAt(const Node& root, const std::string& pointer) {
    Node at = root;
    for (std::size_t from = 1; from <= pointer.size();) {
        const std::size_t to = std::min(pointer.find('/', from), pointer.size());
        const std::string token = pointer.substr(from, to - from);
        std::optional<Node> next;
        if (at.kind() == Node::Kind::Array) {
            const std::size_t size = at.children().size();
            std::size_t index = size;
            std::from_chars(token.data(), token.data() + token.size(), index);
            if (index < size) {
                auto child = at.children().begin();
                while (index-- > 0)
                    ++child;
                next = *child;
            }
        } else {
            next = at.find(token);
        }
        if (!next)
            break;
        at = *next;
        from = to + 1;
    }
    return at;
}

void readTop(Context& context, Experiment& e) {
    Object top(context, context.document.root(), "");
    if (!top.valid())
        return;
    if (const std::string schema = top.text("schema"); schema != schemaName && top.find("schema"))
        top.error("schema", "this is \"" + schema + "\", not an experiment of this version",
                  std::string("\"") + schemaName + "\"");
    const std::size_t protocol =
        top.choice("protocol", std::vector<std::string>(kProtocolNames.begin(), kProtocolNames.end()));
    const std::optional<Node> word = top.find("protocol");
    if (protocol == kProtocolNames.size() && word && word->kind() == Node::Kind::String)
        return;                                                           // what the other keys are depends on it
    e.protocol = static_cast<Protocol>(protocol % kProtocolNames.size()); // null: what is to be filled in is listed
    e.description = top.text("description", "");
    const bool scene = e.protocol == Protocol::Scene;
    e.gravityOfScene = scene && !top.find("gravity_m_s2");
    if (!e.gravityOfScene)
        e.gravity = top.pair("gravity_m_s2");
    for (const char* words : {"frame", "arc_convention", "contact_thickness"})
        top.text(words, "");
    const std::string meaning = top.text("uncertainty_meaning", "half-width of a uniform interval");
    if (meaning != "half-width of a uniform interval")
        top.note("uncertainty_meaning", "interpreted as the half-width of a uniform interval");
    const bool free = scene || e.protocol == Protocol::FreeScene;
    if (free) {
        e.scene = scene ? readScene(context, top, e.sensors) : readFreeScene(context, top);
    } else {
        e.specimens = readSpecimens(context, top);
        for (const ArrayItem& place : top.array("obstacles", false))
            e.obstacles.push_back(readObstacle(context, place));
        e.strings = readStrings(context, top);
    }
    if (const std::optional<Node> node = free ? std::nullopt : top.required("friction", "an object")) {
        Object friction(context, *node, top.pointerTo("friction"));
        if (friction.valid())
            e.friction = {friction.number("coefficient", notNegative),
                          friction.number("coefficient_unc", 0.0, notNegative)};
        friction.finish();
    }
    e.initialGapHalfWidth = top.number("initial_gap_unc_m", 0.0, notNegative);
    for (const ArrayItem& place : top.array("runs", true))
        e.runs.push_back(readRun(context, place, e));
    if (const std::optional<Node> node = top.find("sensors"))
        e.sensors = readSensors(context, *node, top.pointerTo("sensors"), e);
    if (free)
        noteUnusedSpecimens(e, top);
    e.markers = readMarkers(context, top, e.specimens, free);
    top.finish();
    if (!scene::anyError(context.problems))
        checkProtocol(context, top, e);
    if (scene::anyError(context.problems))
        return;
    for (const Contradiction& r : contradictions(e)) {
        const Node node = nodeAt(context.document.root(), r.pointer);
        if (r.error)
            context.error(node, r.pointer, r.what, r.expected);
        else
            context.note(node, r.pointer, r.what);
    }
}

} // namespace

const char* name(Protocol protocol) {
    return kProtocolNames[static_cast<std::size_t>(protocol)];
}

Result<Experiment> loadText(const std::string& text, const std::string& file, std::vector<scene::Problem>& problems) {
    std::vector<scene::Problem> found;
    Experiment experiment;
    if (const auto document = scene::parseDocument(text, file, found)) {
        scene::Scope none;
        Context context{*document, found, none};
        experiment.file = file;
        experiment.text = text;
        readTop(context, experiment);
    }
    problems.insert(problems.end(), found.begin(), found.end());
    return scene::anyError(found) ? Result<Experiment>::failure(scene::errorText(found))
                                  : Result<Experiment>(std::move(experiment));
}

Result<Experiment> load(const std::string& path, std::vector<scene::Problem>& problems, Outside outside) {
    const auto text = scene::readFile(path, problems);
    if (!text)
        return Result<Experiment>::failure(text.error());
    Result<Experiment> experiment = loadText(*text, path, problems);
    if (!experiment)
        return experiment;
    const std::size_t before = problems.size();
    if (outside == Outside::Refused)
        refuseOutside(*experiment, problems);
    if (problems.size() > before)
        return Result<Experiment>::failure(scene::errorText(problems, before));
    if (!experiment->scene || readSceneFile(*experiment, problems))
        readRuns(*experiment, problems);
    std::string errors = scene::errorText(problems, before);
    return errors.empty() ? std::move(experiment) : Result<Experiment>::failure(std::move(errors));
}

Result<Experiment> load(const std::string& path) {
    std::vector<scene::Problem> problems;
    return load(path, problems);
}

} // namespace supercircle::experiment
