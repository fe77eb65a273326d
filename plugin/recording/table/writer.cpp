#include "plugin/recording/table/writer.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>
#include <type_traits>

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"

// Written by hand and not through a JSON tree: a stack of thirty shells leaves a million numbers, a tree of them takes
// a hundred times the memory, and its printer does not promise the shortest digits.

namespace supercircle::record {

namespace {

/// Appends JSON; knows where commas go.
class JsonText {
public:
    std::string text;
    JsonText& open(char bracket) {
        separate();
        text += bracket;
        first = true;
        return *this;
    }
    JsonText& close(char bracket) {
        text += bracket;
        first = false;
        return *this;
    }
    JsonText& key(std::string_view name) {
        separate();
        appendJsonString(text, name);
        text += ':';
        first = true;
        return *this;
    }
    JsonText& string(std::string_view value) {
        separate();
        appendJsonString(text, value);
        return *this;
    }
    JsonText& integer(std::int64_t value) {
        separate();
        text += std::to_string(value);
        return *this;
    }
    JsonText& boolean(bool value) {
        separate();
        text += value ? "true" : "false";
        return *this;
    }
    /// Exact.
    JsonText& number(double value) {
        separate();
        appendJsonNumber(text, value);
        return *this;
    }
    /// Rounded to float.
    template <typename T>
    JsonText& rounded(T value) {
        separate();
        const auto small = static_cast<float>(value);
        if (std::isfinite(small))
            appendNumber(text, small + 0.0F); // -0 is written as 0
        else
            text += "null";
        return *this;
    }
    template <typename Container>
    JsonText& roundedList(const Container& values) {
        open('[');
        for (const auto value : values)
            rounded(value);
        return close(']');
    }

private:
    void separate() {
        if (!first && !text.empty())
            text += ',';
        first = false;
    }
    bool first = true;
};

void appendValue(std::string& out, const Value& value) {
    std::visit(
        [&out](const auto& v) {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, double>)
                appendJsonNumber(out, v);
            else if constexpr (std::is_same_v<T, bool>)
                out += v ? "true" : "false";
            else if constexpr (std::is_same_v<T, std::int64_t>)
                out += std::to_string(v);
            else
                appendJsonString(out, v);
        },
        value);
}

/// The object's members, one a line, so that people and diff can read it.
class Members {
public:
    explicit Members(std::string& target, std::string margin) : out(target), indent(std::move(margin)) { out += '{'; }
    std::string& key(std::string_view name) {
        ((out += first ? "\n" : ",\n") += indent) += "  ";
        first = false;
        appendJsonString(out, name);
        return out += ": ";
    }
    void end() { (first ? out : (out += '\n') += indent) += '}'; }

private:
    std::string& out;
    std::string indent;
    bool first = true;
};

void appendNumbers(std::string& out, const std::vector<std::pair<std::string, double>>& numbers) {
    Members members(out, "  ");
    for (const auto& [name, value] : numbers)
        appendJsonNumber(members.key(name), value);
    members.end();
}

void appendCycles(std::string& out, const std::vector<Cycle>& cycles) {
    out += '[';
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        out += i == 0 ? "\n    " : ",\n    ";
        out += "{\"delta_max_over_R\": ";
        appendJsonNumber(out, cycles[i].delta_max_over_R);
        appendJsonNumber(out += ", \"dissipation_ratio\": ", cycles[i].dissipation_ratio);
        out += ", \"snap_fits\": " + std::to_string(cycles[i].snap_fits);
        appendJsonNumber(out += ", \"dissipated_J\": ", cycles[i].dissipated_J);
        out += '}';
    }
    out += "\n  ]";
}

/// Names of the phases in order of appearance; frames refer to them by number.
std::vector<std::string> phaseNames(const Recording& recording) {
    std::vector<std::string> names;
    for (const Frame& frame : recording.frames)
        if (std::find(names.begin(), names.end(), frame.phase) == names.end())
            names.push_back(frame.phase);
    return names;
}

void writeShells(JsonText& json, const Recording& recording) {
    json.key("shells").open('[');
    for (const ShellInfo& shell : recording.shells) {
        json.open('{').key("name").string(shell.name).key("length_m").number(shell.length);
        json.key("thickness_m").number(shell.thickness).key("bending_modulus_N_m2").number(shell.bending_modulus);
        json.key("closed").boolean(shell.closed).key("element_length_m").open('[');
        for (const double length : shell.element_length)
            json.number(length);
        json.close(']').key("natural_curvature_per_m").open('[');
        for (const double curvature : shell.natural_curvature)
            json.number(curvature);
        json.close(']').close('}');
    }
    json.close(']');
}

void writeOutlines(JsonText& json, const Recording& recording) {
    json.key("outlines").open('[');
    for (const OutlineInfo& outline : recording.outlines) {
        const char* kind = outline.kind == OutlineInfo::Kind::Polyline  ? "polyline"
                           : outline.kind == OutlineInfo::Kind::Polygon ? "polygon"
                                                                        : "circle";
        json.open('{').key("kind").string(kind).key("body").integer(outline.body);
        json.key("driven").boolean(outline.driven).key("radius_m").number(outline.radius).key("points_m").open('[');
        for (const auto& point : outline.points)
            json.open('[').number(point[0]).number(point[1]).close(']');
        json.close(']').close('}');
    }
    json.close(']');
}

void writeFrame(JsonText& json, const Frame& frame, std::int64_t phase) {
    json.open('{').key("t").number(frame.time).key("d").number(frame.displacement).key("f").number(frame.force);
    json.key("phase").integer(phase).key("shells").open('[');
    for (const ShellPose& pose : frame.shells) {
        json.open('[').rounded(pose.start[0]).rounded(pose.start[1]).rounded(pose.angle);
        json.rounded(pose.bending_energy).roundedList(pose.curvature).close(']');
    }
    json.close(']').key("bodies").open('[');
    for (const BodyPose& pose : frame.bodies)
        json.open('[').rounded(pose.x).rounded(pose.y).rounded(pose.angle).close(']');
    json.close(']').key("contacts").open('[');
    for (const ContactMark& mark : frame.contacts) {
        json.open('[').rounded(mark.x).rounded(mark.y).rounded(mark.fx).rounded(mark.fy);
        json.integer(mark.slips ? 1 : 0).close(']');
    }
    json.close(']').close('}');
}

void writeEvents(JsonText& json, const Recording& recording) {
    json.key("events").open('[');
    for (const Event& event : recording.events) {
        json.open('{').key("t").number(event.time).key("d").number(event.displacement).key("f").number(event.force);
        json.key("kind").string(event.kind).key("text").string(event.text).close('}');
    }
    json.close(']');
}

} // namespace

Result<std::string> summaryJson(const Recording& recording) {
    std::string result;
    Members members(result, "");
    std::set<std::string> seen{"parameters", "timing", "energy", "cycles"};
    for (const auto& [name, value] : recording.summary) {
        if (!seen.insert(name).second)
            return Result<std::string>::failure("summary: the key '" + name + "' appears twice");
        appendValue(members.key(name), value);
    }
    if (seen.insert("scene").second && !recording.scene.empty())
        appendJsonString(members.key("scene"), recording.scene);
    if (!recording.parameters.empty())
        appendNumbers(members.key("parameters"), recording.parameters);
    if (!recording.timing.empty())
        appendNumbers(members.key("timing"), recording.timing);
    if (!recording.energy.empty())
        appendNumbers(members.key("energy"), recording.energy);
    if (!recording.cycles.empty())
        appendCycles(members.key("cycles"), recording.cycles);
    members.end();
    result += '\n';
    return result;
}

std::string trajectoryJson(const Recording& recording) {
    JsonText json;
    json.open('{').key("schema").string("supercircle-trajectory/1");
    json.key("scene").string(recording.scene).key("about").string(recording.about);
    json.key("R_m").number(recording.R).key("B_N_m2").number(recording.B).key("key_frames").open('[');
    for (const std::int32_t index : recording.keyFrames)
        json.integer(index);
    json.close(']');
    writeShells(json, recording);
    writeOutlines(json, recording);
    writeEvents(json, recording);
    const std::vector<std::string> phases = phaseNames(recording);
    json.key("phases").open('[');
    for (const auto& name : phases)
        json.string(name);
    json.close(']').key("frames").open('[');
    for (const Frame& frame : recording.frames)
        writeFrame(json, frame, std::find(phases.begin(), phases.end(), frame.phase) - phases.begin());
    json.close(']').close('}');
    json.text += '\n';
    return std::move(json.text);
}

Result<std::vector<NamedText>> recordingFiles(const Recording& recording) noexcept {
    using Files = Result<std::vector<NamedText>>;
    try {
        Result<std::string> summary = summaryJson(recording);
        if (!summary)
            return Files::failure(summary.error());
        Result<std::string> series = csvText(recording.series);
        if (!series)
            return Files::failure(series.error());
        std::vector<NamedText> files;
        files.emplace_back("series.csv", *std::move(series));
        files.emplace_back("trajectory.json", trajectoryJson(recording));
        files.emplace_back("summary.json", *std::move(summary));
        return files;
    } catch (const std::exception& exception) {
        return Files::failure(std::string("cannot write the recording: ") + exception.what());
    }
}

Status writeFiles(const Recording& recording, const std::string& directory) noexcept {
    const Result<std::vector<NamedText>> files = recordingFiles(recording);
    return files ? writeAtomically(directory, *files) : Status::failure(files.error());
}

} // namespace supercircle::record
