#include "plugin/scene/loader/reader.h"

#include "supercircle/support/names.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>

namespace supercircle::scene {

namespace {

std::string numberText(double v) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.10g", v);
    return buffer;
}

std::string limitsText(const Limits& limits) {
    const bool low = std::isfinite(limits.min);
    const bool high = std::isfinite(limits.max);
    std::string text = "a number";
    if (low && high && !limits.above)
        return text + " from " + numberText(limits.min) + " to " + numberText(limits.max);
    if (low)
        text += (limits.above ? " > " : " >= ") + numberText(limits.min);
    if (high)
        text += (low ? " and <= " : " <= ") + numberText(limits.max);
    return text;
}

/// b2dJson writes a float as the eight hex digits of its bits.
std::optional<double> hexFloat(const std::string& text) {
    if (text.size() != 8 || !std::all_of(text.begin(), text.end(),
                                         [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }))
        return std::nullopt;
    const auto bits = static_cast<std::uint32_t>(std::stoul(text, nullptr, 16));
    return static_cast<double>(std::bit_cast<float>(bits));
}

/// Value of {"param": name} or {"expr": formula}.
std::optional<double> readReference(Context& context, const Node& node, const std::string& pointer) {
    const std::optional<Node> param = node.find("param");
    const std::optional<Node> expr = node.find("expr");
    const char* wanted = "a number, {\"param\": name} or {\"expr\": formula}";
    for (const Node& child : node.children()) {
        if (child.key() != "param" && child.key() != "expr" && child.key() != "about") {
            context.keyError(child, pointer + "/" + pointerToken(child.key()),
                             "unknown key \"" + child.key() + "\" where a number stands", wanted,
                             nearestName(child.key(), {"param", "expr"}));
            return std::nullopt;
        }
    }
    if (param.has_value() == expr.has_value()) {
        context.error(node, pointer, param ? "both \"param\" and \"expr\"" : "not a number", wanted);
        return std::nullopt;
    }
    const Node text = param ? *param : *expr;
    const std::string where = pointer + "/" + text.key();
    if (text.kind() != Node::Kind::String) {
        context.error(text, where, "\"" + text.key() + "\" is " + kindName(text.kind()), "a text");
        return std::nullopt;
    }
    return param ? context.scope.value(context, text.text(), text, where)
                 : context.scope.evaluate(context, text.text(), text, where);
}

/// Reports the error, or counts it: the place of each takes time proportional to the length of its line.
void report(Context& context, std::size_t offset, const std::string& pointer, const std::string& what,
            const std::string& expected, const std::string& nearest) {
    const bool full = context.full();
    ++context.errorCount;
    if (!full) {
        Problem p = context.document.problemAt(offset, pointer, what, expected);
        p.nearest = nearest;
        context.problems.push_back(std::move(p));
        return;
    }
    const std::size_t more = context.errorCount - maxErrors;
    if (more == 1) {
        context.countAt = context.problems.size();
        context.problems.emplace_back().file = context.document.file;
    }
    context.problems[context.countAt].what =
        "and " + std::to_string(more) + (more == 1 ? " more error" : " more errors");
}

} // namespace

void Context::error(const Node& at, const std::string& pointer, const std::string& what, const std::string& expected,
                    const std::string& nearest) {
    errorAt(at.offset(), pointer, what, expected, nearest);
}

void Context::errorAt(std::size_t offset, const std::string& pointer, const std::string& what,
                      const std::string& expected, const std::string& nearest) {
    report(*this, offset, pointer, what, expected, nearest);
}

void Context::keyError(const Node& at, const std::string& pointer, const std::string& what, const std::string& expected,
                       const std::string& nearest) {
    report(*this, at.keyOffset(), pointer, what, expected, nearest);
}

void Context::note(const Node& at, const std::string& pointer, const std::string& what) {
    Problem p = document.problemAt(at.keyOffset(), pointer, what);
    p.severity = Problem::Severity::Note;
    problems.push_back(std::move(p));
}

void Context::noteRenamed(const Node& at, const std::string& pointer, const std::string& old,
                          const std::string& successor) {
    if (std::find(renamedNoted.begin(), renamedNoted.end(), old) != renamedNoted.end())
        return;
    renamedNoted.push_back(old);
    note(at, pointer, "\"" + old + "\" is called " + successor + " since 0.2");
}

std::optional<double> readNumber(Context& context, const Node& node, const std::string& pointer, const Limits& limits,
                                 bool hex) {
    std::optional<double> value;
    if (node.kind() == Node::Kind::Number) {
        value = node.number();
    } else if (node.kind() == Node::Kind::Object) {
        value = readReference(context, node, pointer);
        if (!value)
            return value;
    } else {
        if (hex && node.kind() == Node::Kind::String)
            value = hexFloat(node.text());
        if (!value) {
            context.error(node, pointer, std::string("this is ") + kindName(node.kind()),
                          limitsText(limits) + ", {\"param\": name} or {\"expr\": formula}");
            return value;
        }
    }
    if (!std::isfinite(*value)) {
        context.error(node, pointer, "not a finite number", limitsText(limits));
        return std::nullopt;
    }
    const bool low = limits.above ? *value > limits.min : *value >= limits.min;
    if (!low || *value > limits.max) {
        context.error(node, pointer, numberText(*value) + " is out of range", limitsText(limits));
        return std::nullopt;
    }
    return value;
}

std::optional<Eigen::Vector2d> readVector(Context& context, const Node& node, const std::string& pointer, bool hex) {
    if (node.kind() == Node::Kind::Number && node.number() == 0.0)
        return Eigen::Vector2d(0.0, 0.0); // b2dJson's short form of the origin
    if (node.kind() != Node::Kind::Object) {
        context.error(node, pointer, std::string("this is ") + kindName(node.kind()), "{\"x\": ..., \"y\": ...} or 0");
        return std::nullopt;
    }
    ObjectReader reader(context, node, pointer, hex);
    const std::size_t before = context.errors();
    reader.require("x", "a number");
    reader.require("y", "a number");
    const Eigen::Vector2d v(reader.number("x", 0.0), reader.number("y", 0.0));
    reader.finish();
    if (context.errors() != before)
        return std::nullopt;
    return v;
}

ObjectReader::ObjectReader(Context& context, const Node& node, std::string pointer, bool hex)
    : context_(context), node_(node), pointer_(std::move(pointer)), hex_(hex) {
    known_.emplace_back("about");
    if (!valid())
        context_.error(node, pointer_, std::string("this is ") + kindName(node.kind()), "an object");
}

std::string ObjectReader::pointerTo(const std::string& key) const {
    for (const auto& [now, old] : aliases_)
        if (now == key)
            return pointer_ + "/" + pointerToken(old);
    return pointer_ + "/" + pointerToken(key);
}

void ObjectReader::renamed(const std::string& old, const std::string& now) {
    if (superseded(old, "\"" + now + "\"", now) && !node_.find(now))
        aliases_.emplace_back(now, old);
}

std::optional<Node> ObjectReader::superseded(const std::string& old, const std::string& successor,
                                             const std::string& now) {
    oldNames_.push_back(old);
    makeKnown(now);
    const std::optional<Node> node = node_.find(old);
    if (!node)
        return node;
    const std::string where = pointer_ + "/" + pointerToken(old);
    if (node_.find(now))
        context_.keyError(*node, where, "both \"" + old + "\" and \"" + now + "\"",
                          "\"" + now + "\" alone: \"" + old + "\" is its name before 0.2");
    else
        context_.noteRenamed(*node, where, old, successor);
    return node;
}

void ObjectReader::makeKnown(const std::string& key) {
    const auto in = [&](const std::vector<std::string>& list) {
        return std::find(list.begin(), list.end(), key) != list.end();
    };
    if (!in(known_) && !in(oldNames_))
        known_.push_back(key);
}

std::optional<Node> ObjectReader::find(const std::string& key) {
    makeKnown(key);
    for (const auto& [now, old] : aliases_)
        if (now == key)
            return node_.find(old);
    return node_.find(key);
}

double ObjectReader::number(const std::string& key, double fallback, const Limits& limits) {
    const std::optional<Node> node = find(key);
    return !node ? fallback : readNumber(context_, *node, pointerTo(key), limits, hex_).value_or(fallback);
}

std::int64_t ObjectReader::integer(const std::string& key, std::int64_t fallback, std::int64_t min, std::int64_t max) {
    const std::optional<Node> node = find(key);
    if (!node)
        return fallback;
    const auto value = readNumber(context_, *node, pointerTo(key), anyNumber, hex_);
    if (!value)
        return fallback;
    const auto low = static_cast<double>(min);
    const auto high = static_cast<double>(max);
    if (*value != std::floor(*value) || *value < low || *value > high) {
        context_.error(*node, pointerTo(key), numberText(*value) + " is not accepted",
                       "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
        return fallback;
    }
    return static_cast<std::int64_t>(*value);
}

bool ObjectReader::boolean(const std::string& key, bool fallback) {
    const std::optional<Node> node = find(key);
    if (!node)
        return fallback;
    if (node->kind() == Node::Kind::Boolean)
        return node->boolean();
    context_.error(*node, pointerTo(key), std::string("this is ") + kindName(node->kind()), "true or false");
    return fallback;
}

std::string ObjectReader::string(const std::string& key, const std::string& fallback) {
    const std::optional<Node> node = find(key);
    if (!node)
        return fallback;
    if (node->kind() == Node::Kind::String)
        return node->text();
    context_.error(*node, pointerTo(key), std::string("this is ") + kindName(node->kind()), "a text");
    return fallback;
}

Eigen::Vector2d ObjectReader::vector(const std::string& key, const Eigen::Vector2d& fallback) {
    const std::optional<Node> node = find(key);
    return !node ? fallback : readVector(context_, *node, pointerTo(key), hex_).value_or(fallback);
}

std::size_t ObjectReader::choice(const std::string& key, const std::vector<std::string>& words, std::size_t fallback) {
    const std::optional<Node> node = find(key);
    if (!node)
        return fallback;
    std::string all;
    for (const std::string& word : words)
        all += (all.empty() ? "\"" : ", \"") + word + "\"";
    if (node->kind() != Node::Kind::String) {
        context_.error(*node, pointerTo(key), std::string("this is ") + kindName(node->kind()), "one of " + all);
        return fallback;
    }
    const std::string text = node->text();
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end()) {
        context_.error(*node, pointerTo(key), "unknown value \"" + text + "\"", "one of " + all,
                       nearestName(text, words));
        return fallback;
    }
    return static_cast<std::size_t>(found - words.begin());
}

ArrayItems ObjectReader::array(const std::string& key) {
    const std::optional<Node> node = find(key);
    const auto nowhere = node_.children().end();
    if (!node)
        return {{nowhere, nowhere}, {}};
    if (node->kind() != Node::Kind::Array) {
        context_.error(*node, pointerTo(key), std::string("this is ") + kindName(node->kind()), "an array");
        return {{nowhere, nowhere}, {}};
    }
    return {node->children(), pointerTo(key)};
}

std::vector<double> ObjectReader::numbers(const std::string& key, const Limits& limits) {
    const ArrayItems items = array(key);
    std::vector<double> values;
    values.reserve(items.size());
    for (const ArrayItem& item : items)
        values.push_back(readNumber(context_, item.node, item.pointer, limits, hex_).value_or(0.0));
    return values;
}

bool ObjectReader::require(const std::string& key, const std::string& expected) {
    if (!valid() || find(key))
        return true;
    context_.keyError(node_, pointer_, "\"" + key + "\" is missing", expected);
    return false;
}

void ObjectReader::ignore(std::initializer_list<const char*> keys) {
    for (const char* key : keys)
        find(key);
}

void ObjectReader::finish() {
    if (!valid())
        return;
    for (const Node& child : node_.children()) {
        if (std::find(known_.begin(), known_.end(), child.key()) != known_.end() ||
            std::find(oldNames_.begin(), oldNames_.end(), child.key()) != oldNames_.end())
            continue;
        if (context_.full()) {
            context_.keyError(child, {}, {});
            continue;
        }
        std::string all;
        if (known_.size() <= 12)
            for (const std::string& key : known_)
                all += (all.empty() ? "one of " : ", ") + key;
        context_.keyError(child, pointerTo(child.key()), "unknown key \"" + child.key() + "\"", all,
                          nearestName(child.key(), known_));
    }
}

} // namespace supercircle::scene
