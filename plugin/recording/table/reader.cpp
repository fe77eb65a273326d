#include "plugin/recording/table/reader.h"

#include <filesystem>
#include <limits>

#include <nlohmann/json.hpp>

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"

namespace supercircle::record {

namespace {

using Json = nlohmann::ordered_json;

/// A JSON value with its place, so that every wrong type names its pointer. Throws only inside this file.
class Node {
public:
    Node(const Json& value, std::string place) : json(value), pointer(std::move(place)) {}

    [[noreturn]] void fail(const std::string& expected) const {
        throw std::runtime_error((pointer.empty() ? "/" : pointer) + ": expected " + expected + ", got " +
                                 json.type_name());
    }
    [[nodiscard]] Node at(const char* key) const {
        if (!json.is_object())
            fail("an object");
        const auto found = json.find(key);
        if (found == json.end())
            throw std::runtime_error((pointer.empty() ? "/" : pointer) + ": no '" + key + "'");
        return {*found, pointer + "/" + key};
    }
    [[nodiscard]] Node at(std::size_t i) const {
        if (!json.is_array() || i >= json.size())
            fail("a list of at least " + std::to_string(i + 1));
        return {json[i], pointer + "/" + std::to_string(i)};
    }
    [[nodiscard]] std::size_t size() const {
        if (!json.is_array())
            fail("a list");
        return json.size();
    }
    [[nodiscard]] double number() const {
        if (json.is_null())
            return std::numeric_limits<double>::quiet_NaN();
        if (!json.is_number())
            fail("a number or null");
        return json.get<double>();
    }
    [[nodiscard]] std::int64_t integer() const {
        if (!json.is_number_integer())
            fail("a whole number");
        return json.get<std::int64_t>();
    }
    [[nodiscard]] bool boolean() const {
        if (!json.is_boolean())
            fail("true or false");
        return json.get<bool>();
    }
    [[nodiscard]] std::string string() const {
        if (!json.is_string())
            fail("a string");
        return json.get<std::string>();
    }
    template <typename T>
    [[nodiscard]] std::vector<T> numbers() const {
        std::vector<T> values(size());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<T>(at(i).number());
        return values;
    }
    const Json& json;
    std::string pointer;
};

template <typename Use>
void each(const Node& list, Use use) {
    for (std::size_t i = 0, n = list.size(); i < n; ++i)
        use(list.at(i));
}

std::array<double, 2> point(const Node& node) {
    return {node.at(std::size_t{0}).number(), node.at(1).number()};
}

void readShell(const Node& node, Recording& recording) {
    ShellInfo shell;
    shell.name = node.at("name").string();
    shell.length = node.at("length_m").number();
    shell.thickness = node.at("thickness_m").number();
    shell.bending_modulus = node.at("bending_modulus_N_m2").number();
    shell.closed = node.at("closed").boolean();
    shell.element_length = node.at("element_length_m").numbers<double>();
    shell.natural_curvature = node.at("natural_curvature_per_m").numbers<double>();
    recording.shells.push_back(std::move(shell));
}

void readOutline(const Node& node, Recording& recording) {
    OutlineInfo outline;
    const std::string kind = node.at("kind").string();
    if (kind == "polyline")
        outline.kind = OutlineInfo::Kind::Polyline;
    else if (kind == "circle")
        outline.kind = OutlineInfo::Kind::Circle;
    else if (kind != "polygon")
        node.at("kind").fail("polyline, polygon or circle");
    outline.body = static_cast<std::int32_t>(node.at("body").integer());
    outline.driven = node.at("driven").boolean();
    outline.radius = node.at("radius_m").number();
    each(node.at("points_m"), [&](const Node& p) { outline.points.push_back(point(p)); });
    recording.outlines.push_back(std::move(outline));
}

void readFrame(const Node& node, const std::vector<std::string>& phases, Recording& recording) {
    Frame frame;
    frame.time = node.at("t").number();
    frame.displacement = node.at("d").number();
    frame.force = node.at("f").number();
    const Node phase = node.at("phase");
    const std::int64_t index = phase.integer();
    if (index < 0 || index >= static_cast<std::int64_t>(phases.size()))
        phase.fail("the number of a phase below " + std::to_string(phases.size()));
    frame.phase = phases[static_cast<std::size_t>(index)];
    const Node shells = node.at("shells");
    if (shells.size() > recording.shells.size())
        shells.fail("at most " + std::to_string(recording.shells.size()) + " shells");
    each(shells, [&](const Node& s) {
        ShellPose pose;
        pose.start = point(s);
        pose.angle = s.at(2).number();
        pose.bending_energy = s.at(3).number();
        pose.curvature = s.at(4).numbers<float>();
        frame.shells.push_back(std::move(pose));
    });
    each(node.at("bodies"), [&](const Node& b) {
        frame.bodies.push_back({b.at(std::size_t{0}).number(), b.at(1).number(), b.at(2).number()});
    });
    each(node.at("contacts"), [&](const Node& c) {
        frame.contacts.push_back({c.at(std::size_t{0}).number(), c.at(1).number(), c.at(2).number(), c.at(3).number(),
                                  c.at(4).integer() != 0});
    });
    recording.frames.push_back(std::move(frame));
}

Recording readTrajectory(const Node& root) {
    Recording recording;
    if (root.at("schema").string() != "supercircle-trajectory/1")
        throw std::runtime_error("/schema: expected \"supercircle-trajectory/1\", got \"" + root.at("schema").string() +
                                 "\"");
    recording.scene = root.at("scene").string();
    recording.about = root.at("about").string();
    recording.R = root.at("R_m").number();
    recording.B = root.at("B_N_m2").number();
    for (std::size_t i = 0; i < recording.keyFrames.size(); ++i)
        recording.keyFrames[i] = static_cast<std::int32_t>(root.at("key_frames").at(i).integer());
    each(root.at("shells"), [&](const Node& n) { readShell(n, recording); });
    each(root.at("outlines"), [&](const Node& n) { readOutline(n, recording); });
    each(root.at("events"), [&](const Node& n) {
        recording.events.push_back(
            {n.at("t").number(), n.at("d").number(), n.at("f").number(), n.at("kind").string(), n.at("text").string()});
    });
    std::vector<std::string> phases;
    each(root.at("phases"), [&](const Node& n) { phases.push_back(n.string()); });
    each(root.at("frames"), [&](const Node& n) { readFrame(n, phases, recording); });
    return recording;
}

Value scalar(const Node& node) {
    if (node.json.is_string())
        return node.string();
    if (node.json.is_boolean())
        return node.boolean();
    if (node.json.is_number_integer())
        return node.integer();
    return node.number();
}

void readNumbers(const Node& object, std::vector<std::pair<std::string, double>>& numbers) {
    if (!object.json.is_object())
        object.fail("an object");
    for (const auto& [name, value] : object.json.items())
        numbers.emplace_back(name, Node(value, object.pointer + "/" + name).number());
}

void readSummary(const Node& root, Recording& recording) {
    if (!root.json.is_object())
        root.fail("an object");
    for (const auto& [name, value] : root.json.items()) {
        const Node node(value, "/" + name);
        if (name == "parameters")
            readNumbers(node, recording.parameters);
        else if (name == "timing")
            readNumbers(node, recording.timing);
        else if (name == "energy")
            readNumbers(node, recording.energy);
        else if (name == "cycles")
            each(node, [&](const Node& n) {
                recording.cycles.push_back({n.at("delta_max_over_R").number(), n.at("dissipation_ratio").number(),
                                            static_cast<int>(n.at("snap_fits").integer()),
                                            n.at("dissipated_J").number()});
            });
        else
            recording.summary.emplace_back(name, scalar(node));
    }
}

/// Line and column of a byte, both from 1.
std::string place(std::string_view text, std::size_t byte) {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
        line += text[i] == '\n' ? 1 : 0;
        column = text[i] == '\n' ? 1 : column + 1;
    }
    return std::to_string(line) + ":" + std::to_string(column);
}

/// Runs `use` on the parsed text and turns whatever goes wrong into a message.
template <typename Use>
Status guarded(std::string_view text, const std::string& source, Use use) {
    try {
        const Json json = parseJson(text);
        use(Node(json, ""));
        return {};
    } catch (const Json::parse_error& error) {
        return Status::failure(source + ":" + place(text, error.byte) + ": not valid JSON");
    } catch (const std::exception& error) {
        return Status::failure(source + ": " + error.what());
    }
}

} // namespace

Result<Recording> parseTrajectory(std::string_view text, const std::string& source) {
    Recording recording;
    const Status read = guarded(text, source, [&](const Node& root) { recording = readTrajectory(root); });
    return read ? Result<Recording>(std::move(recording)) : Result<Recording>::failure(read.error());
}

Status parseSummary(std::string_view text, const std::string& source, Recording& recording) {
    return guarded(text, source, [&](const Node& root) { readSummary(root, recording); });
}

Result<Recording> readFiles(const std::string& directory) {
    const std::string trajectory = directory + "/trajectory.json";
    const Result<std::string> text = readText(trajectory);
    if (!text)
        return Result<Recording>::failure(text.error());
    Result<Recording> result = parseTrajectory(*text, trajectory);
    if (!result)
        return result;
    std::error_code ignored;
    if (const std::string path = directory + "/series.csv"; std::filesystem::exists(path, ignored)) {
        Result<Series> series = readCsv(path);
        if (!series)
            return Result<Recording>::failure(series.error());
        result->series = *std::move(series);
    }
    if (const std::string path = directory + "/summary.json"; std::filesystem::exists(path, ignored)) {
        const Result<std::string> summary = readText(path);
        if (!summary)
            return Result<Recording>::failure(summary.error());
        if (const Status read = parseSummary(*summary, path, *result); !read)
            return Result<Recording>::failure(read.error());
    }
    return result;
}

} // namespace supercircle::record
