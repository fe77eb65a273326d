// From sweep.json to the list of runs; every problem is reported with its place in the file.

#include "plugin/lab/sweep/definition.h"
#include "plugin/scene/loader/reader.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace supercircle::sweep {

namespace {

using scene::Context;
using scene::Node;
using scene::ObjectReader;

constexpr const char* schemaName = "supercircle-sweep/1";
constexpr std::int64_t kMaxSeed = std::int64_t{1} << 53; // larger ones are not whole in a JSON number

std::optional<double> plainNumber(Context& context, const Node& node, const std::string& pointer) {
    if (node.kind() == Node::Kind::Number && std::isfinite(node.number()))
        return node.number();
    context.error(node, pointer, std::string("this is ") + scene::kindName(node.kind()), "a number");
    return std::nullopt;
}

/// Values of one axis: a list, or {"from", "to", "count"} evenly spaced with both ends.
std::vector<double> readAxis(Context& context, const Node& node, const std::string& pointer) {
    std::vector<double> values;
    if (node.kind() == Node::Kind::Object) {
        ObjectReader object(context, node, pointer);
        for (const char* key : {"from", "to", "count"})
            object.require(key, "a number");
        const double from = object.number("from", 0.0), to = object.number("to", 0.0);
        const std::int64_t count = object.integer("count", 2, 1, 100'000);
        object.finish();
        for (std::int64_t i = 0; i < count; ++i)
            values.push_back(
                count == 1 ? from : from + (to - from) * (static_cast<double>(i) / static_cast<double>(count - 1)));
        return values;
    }
    if (node.kind() != Node::Kind::Array || node.children().empty()) {
        context.error(node, pointer, "no values", "a list of numbers, or {\"from\", \"to\", \"count\"}");
        return values;
    }
    for (const auto& [item, place] : scene::ArrayItems(node.children(), pointer)) {
        if (const auto value = plainNumber(context, item, place)) {
            if (std::find(values.begin(), values.end(), *value) != values.end())
                context.error(item, place, "this value appears twice");
            values.push_back(*value);
        }
    }
    return values;
}

/// An object of numbers by name.
std::vector<ParameterValue> readParameterValues(Context& context, const Node& node, const std::string& pointer) {
    std::vector<ParameterValue> values;
    if (node.kind() != Node::Kind::Object) {
        context.error(node, pointer, std::string("this is ") + scene::kindName(node.kind()),
                      "an object of parameters and their values");
        return values;
    }
    for (const Node& child : node.children())
        if (child.key() != "about")
            if (const auto value = plainNumber(context, child, pointer + "/" + scene::pointerToken(child.key())))
                values.emplace_back(child.key(), *value);
    return values;
}

/// Cases: combinations of values; every case names the same parameters.
void readCases(Context& context, ObjectReader& top, SweepDefinition& sweep) {
    std::vector<std::vector<double>> rows;
    for (const scene::ArrayItem& item : top.array("cases")) {
        const std::vector<ParameterValue> values = readParameterValues(context, item.node, item.pointer);
        if (rows.empty())
            for (const ParameterValue& s : values)
                sweep.names.push_back(s.first);
        std::vector<double> row;
        for (const std::string& name : sweep.names)
            for (const ParameterValue& s : values)
                if (s.first == name)
                    row.push_back(s.second);
        if (row.size() != sweep.names.size() || row.size() != values.size()) {
            context.error(item.node, item.pointer, "this case does not name the parameters of the first one");
            continue;
        }
        if (std::find(rows.begin(), rows.end(), row) != rows.end())
            context.error(item.node, item.pointer, "this case appears twice");
        rows.push_back(std::move(row));
    }
    if (!rows.empty())
        sweep.sets = std::move(rows);
}

void multiply(SweepDefinition& sweep, const std::string& name, const std::vector<double>& values) {
    std::vector<std::vector<double>> product;
    for (const std::vector<double>& set : sweep.sets)
        for (const double value : values) {
            product.push_back(set);
            product.back().push_back(value);
        }
    sweep.names.push_back(name);
    sweep.sets = std::move(product);
}

void readGrid(Context& context, ObjectReader& top, SweepDefinition& sweep) {
    sweep.sets = {{}};
    readCases(context, top, sweep);
    const std::optional<Node> grid = top.find("grid");
    if (!grid)
        return;
    if (grid->kind() != Node::Kind::Object) {
        context.error(*grid, "/grid", std::string("this is ") + scene::kindName(grid->kind()),
                      "an object of parameters and their values");
        return;
    }
    for (const Node& axis : grid->children()) {
        const std::string pointer = "/grid/" + scene::pointerToken(axis.key());
        if (axis.key() == "about")
            continue;
        if (std::find(sweep.names.begin(), sweep.names.end(), axis.key()) != sweep.names.end()) {
            context.keyError(axis, pointer, "this parameter varies in \"cases\" already");
            continue;
        }
        const std::vector<double> values = readAxis(context, axis, pointer);
        if (values.size() * sweep.sets.size() > maxRuns) {
            context.error(axis, pointer, "too many sets of parameters", "at most " + std::to_string(maxRuns));
            return;
        }
        if (!values.empty())
            multiply(sweep, axis.key(), values);
    }
}

std::vector<std::int64_t> readSeeds(Context& context, ObjectReader& top) {
    const std::optional<Node> node = top.find("seeds");
    if (!node)
        return {1};
    std::vector<std::int64_t> seeds;
    if (node->kind() == Node::Kind::Object) {
        ObjectReader object(context, *node, "/seeds");
        object.require("last", "a whole number");
        const std::int64_t first = object.integer("first", 1, 0, kMaxSeed);
        const std::int64_t last = object.integer("last", first, 0, kMaxSeed);
        object.finish();
        if (last < first || last - first >= static_cast<std::int64_t>(maxRuns))
            context.error(*node, "/seeds", "not a valid range", "first <= last, at most " + std::to_string(maxRuns));
        else
            for (std::int64_t seed = first; seed <= last; ++seed)
                seeds.push_back(seed);
        return seeds;
    }
    for (const double value : top.numbers("seeds", {0.0, static_cast<double>(kMaxSeed), false})) {
        if (value != std::floor(value))
            context.error(*node, "/seeds", "seeds are whole numbers");
        seeds.push_back(static_cast<std::int64_t>(value));
    }
    std::sort(seeds.begin(), seeds.end());
    if (std::adjacent_find(seeds.begin(), seeds.end()) != seeds.end())
        context.error(*node, "/seeds", "a seed appears twice");
    if (seeds.empty())
        context.error(*node, "/seeds", "no seeds", "a list, or {\"first\", \"last\"}");
    return seeds;
}

void readReport(Context& context, ObjectReader& top, SweepDefinition& sweep) {
    if (!sweep.names.empty())
        sweep.x = sweep.names.front();
    const std::optional<Node> node = top.find("report");
    if (!node)
        return;
    ObjectReader object(context, *node, "/report");
    sweep.x = object.string("x", sweep.x);
    if (object.find("x") && std::find(sweep.names.begin(), sweep.names.end(), sweep.x) == sweep.names.end())
        context.error(*object.find("x"), "/report/x", "no parameter \"" + sweep.x + "\" varies",
                      "one of \"grid\" or \"cases\"", nearestName(sweep.x, sweep.names));
    object.finish();
}

void readTop(Context& context, SweepDefinition& sweep) {
    ObjectReader top(context, context.document.root(), "");
    if (!top.valid())
        return;
    if (top.require("schema", std::string("\"") + schemaName + "\"")) {
        const std::string schema = top.string("schema", schemaName);
        if (schema != schemaName)
            context.error(*top.find("schema"), "/schema", "this is \"" + schema + "\", not a sweep of this version",
                          std::string("\"") + schemaName + "\"");
    }
    sweep.name = top.string("name", std::filesystem::path(sweep.file).stem().string());
    sweep.about = top.string("about", "");
    if (top.require("scene", "path of a scene file, relative to this one")) {
        const std::filesystem::path scene = top.string("scene", "");
        sweep.scene = (std::filesystem::path(sweep.file).parent_path() / scene).lexically_normal().string();
    }
    readGrid(context, top, sweep);
    if (const std::optional<Node> fixed = top.find("fixed"))
        sweep.fixed = readParameterValues(context, *fixed, "/fixed");
    for (const ParameterValue& s : sweep.fixed)
        if (std::find(sweep.names.begin(), sweep.names.end(), s.first) != sweep.names.end())
            context.error(*top.find("fixed")->find(s.first), "/fixed/" + scene::pointerToken(s.first),
                          "this parameter varies, it cannot be fixed");
    sweep.seeds = readSeeds(context, top);
    readReport(context, top, sweep);
    top.finish();
    if (sweep.sets.size() * sweep.seeds.size() > maxRuns)
        context.error(context.document.root(), "", "too many runs", "at most " + std::to_string(maxRuns));
}

} // namespace

std::optional<SweepDefinition> loadText(const std::string& text, const std::string& file,
                                        std::vector<scene::Problem>& problems) {
    std::vector<scene::Problem> found;
    std::optional<SweepDefinition> sweep;
    if (const auto document = scene::parseDocument(text, file, found)) {
        scene::Scope none;
        Context context{*document, found, none};
        sweep.emplace();
        sweep->file = file;
        readTop(context, *sweep);
    }
    if (scene::anyError(found))
        sweep.reset();
    problems.insert(problems.end(), found.begin(), found.end());
    return sweep;
}

std::optional<SweepDefinition> load(const std::string& path, std::vector<scene::Problem>& problems) {
    const auto text = scene::readFile(path, problems);
    return text ? loadText(*text, path, problems) : std::nullopt;
}

} // namespace supercircle::sweep
