#include "plugin/recording/experiment/values.h"

#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::experiment {

namespace {

std::string inDigits(double v) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.10g", v);
    return buffer;
}

std::string wanted(const Limits& limits) {
    std::string text = "a number";
    if (std::isfinite(limits.min))
        text += (limits.above ? " > " : " >= ") + inDigits(limits.min);
    if (std::isfinite(limits.max))
        text += std::string(std::isfinite(limits.min) ? " and" : "") + " <= " + inDigits(limits.max);
    return text;
}

std::string thisIs(const Node& node) {
    return std::string("this is ") + scene::kindName(node.kind());
}

} // namespace

double numberAt(Context& context, const Node& node, const std::string& pointer, const Limits& limits) {
    if (node.kind() != Node::Kind::Number) {
        context.error(node, pointer, thisIs(node), wanted(limits));
        return 0.0;
    }
    const double v = node.number();
    if (!std::isfinite(v) || (limits.above ? v <= limits.min : v < limits.min) || v > limits.max) {
        context.error(node, pointer, inDigits(v) + " is out of range", wanted(limits));
        return 0.0;
    }
    return v;
}

Object::Object(Context& context, const Node& node, std::string pointer)
    : context_(context), reader_(context, node, std::move(pointer)), known_{"about"} {}

std::optional<Node> Object::find(const std::string& key) {
    known_.push_back(key);
    return reader_.find(key);
}

std::optional<Node> Object::required(const std::string& key, const std::string& expected) {
    known_.push_back(key);
    return reader_.require(key, expected) ? reader_.find(key) : std::nullopt;
}

double Object::number(const std::string& key, const Limits& limits) {
    const std::optional<Node> node = required(key, wanted(limits));
    return !node ? 0.0 : numberAt(context_, *node, pointerTo(key), limits);
}

double Object::number(const std::string& key, double fallback, const Limits& limits) {
    const std::optional<Node> node = find(key);
    return !node ? fallback : numberAt(context_, *node, pointerTo(key), limits);
}

std::string Object::text(const std::string& key) {
    return required(key, "a text") ? reader_.string(key, {}) : std::string();
}

std::string Object::text(const std::string& key, const std::string& fallback) {
    known_.push_back(key);
    return reader_.string(key, fallback);
}

bool Object::flag(const std::string& key, bool fallback) {
    known_.push_back(key);
    return reader_.boolean(key, fallback);
}

scene::ArrayItems Object::array(const std::string& key, bool mustHaveItems) {
    const std::optional<Node> node = required(key, "an array");
    scene::ArrayItems items = reader_.array(key);
    if (node && mustHaveItems && node->kind() == Node::Kind::Array && items.empty())
        context_.error(*node, pointerTo(key), "the array is empty", "at least one item");
    return items;
}

std::vector<double> Object::numbers(const std::string& key, const Limits& limits) {
    const scene::ArrayItems items = array(key, true);
    std::vector<double> values;
    values.reserve(items.size());
    for (const ArrayItem& item : items)
        values.push_back(numberAt(context_, item.node, item.pointer, limits));
    return values;
}

Point Object::pair(const std::string& key) {
    const std::optional<Node> node = required(key, "[x, y]");
    if (!node)
        return {};
    if (node->kind() != Node::Kind::Array || node->children().size() != 2) {
        context_.error(*node, pointerTo(key),
                       node->kind() == Node::Kind::Array ? std::to_string(node->children().size()) + " items"
                                                         : thisIs(*node),
                       "[x, y]");
        return {};
    }
    auto item = node->children().begin();
    const double x = numberAt(context_, *item, pointerTo(key) + "/0", scene::anyNumber);
    return {x, numberAt(context_, *++item, pointerTo(key) + "/1", scene::anyNumber)};
}

std::size_t Object::choice(const std::string& key, const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& w : words)
        all += (all.empty() ? "\"" : ", \"") + w + "\"";
    return required(key, "one of " + all) ? reader_.choice(key, words, words.size()) : words.size();
}

void Object::error(const std::string& key, const std::string& what, const std::string& expected,
                   const std::string& nearest) {
    const std::optional<Node> node = reader_.find(key);
    context_.error(!node ? reader_.node() : *node, pointerTo(key), what, expected, nearest);
}

void Object::note(const std::string& key, const std::string& what) {
    const std::optional<Node> node = reader_.find(key);
    context_.note(!node ? reader_.node() : *node, pointerTo(key), what);
}

void Object::finish() {
    if (!valid())
        return;
    std::vector<std::string> absent;
    for (const std::string& key : known_)
        if (!reader_.node().find(key))
            absent.push_back(key);
    for (const Node& child : reader_.node().children()) {
        if (std::find(known_.begin(), known_.end(), child.key()) != known_.end())
            continue;
        const std::string near = nearestName(child.key(), absent);
        if (near.empty())
            context_.note(child, pointerTo(child.key()), "this key has no meaning here: \"" + child.key() + "\"");
        else
            context_.keyError(child, pointerTo(child.key()), "unknown key \"" + child.key() + "\"", {}, near);
    }
}

} // namespace supercircle::experiment
