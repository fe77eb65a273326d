// muParser evaluates the formulas. A scan finds their names first, for three reasons. A name can be resolved on demand
// (formulas of formulas). An unknown name gets a suggestion at its column. And names become constants, which muParser
// does not let a formula assign to (`R = 3` would change R for the rest of the file).

#include "plugin/scene/loader/expression.h"

#include "plugin/scene/loader/formula_functions.h"
#include "plugin/scene/loader/reader.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <muParser.h>

namespace supercircle::scene {

namespace {

constexpr std::size_t maxNames = 1000;
constexpr int maxChain = 50; // formulas of formulas not yet evaluated; each level needs stack

bool isIdentifier(const std::string& name) {
    return !name.empty() && name.size() <= 64 && startsName(name[0]) && name[0] != '_' &&
           std::all_of(name.begin(), name.end(), continuesName);
}

std::string rangeText(const Parameter& p) {
    const auto text = [](double v) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.10g", v);
        return std::string(buffer);
    };
    const std::string noun = p.integer ? "a whole number" : "a number";
    if (std::isinf(p.min) && std::isinf(p.max))
        return noun;
    if (std::isinf(p.max))
        return noun + " >= " + text(p.min);
    if (std::isinf(p.min))
        return noun + " <= " + text(p.max);
    return noun + " from " + text(p.min) + " to " + text(p.max);
}

} // namespace

struct Scope::Entry {
    enum class State { Open, Busy, Done, Failed };
    bool isParameter = false;
    std::optional<Node> node;      ///< whole declaration
    std::optional<Node> valueNode; ///< the value, empty if missing
    std::string pointer;
    Parameter parameter;    ///< name and value also for constants
    std::string formerName; ///< of a parameter, accepted from outside; empty: none
    std::optional<double> overridden;
    State state = State::Open;
};

struct Scope::Calculator {
    mu::Parser functions; ///< only for the list of functions
};

Scope::Scope() : calculator_(std::make_unique<Calculator>()) {
    defineFunctions(calculator_->functions);
}
Scope::~Scope() = default;

bool Scope::isFunction(const std::string& name) const {
    return calculator_->functions.GetFunDef().count(name) > 0;
}

std::vector<std::string> Scope::names() const {
    std::vector<std::string> result;
    for (const auto& entry : entries_)
        result.push_back(entry->parameter.name);
    result.emplace_back("pi");
    return result;
}

bool Scope::acceptName(Context& context, const Node& node, const std::string& pointer) {
    if (!isIdentifier(node.key())) {
        context.keyError(node, pointer, "\"" + node.key() + "\" is not a valid name",
                         "a letter, then letters, digits and underscores, at most 64");
        return false;
    }
    if (node.key() == "pi" || isFunction(node.key())) {
        context.keyError(node, pointer, "the name \"" + node.key() + "\" is reserved for formulas", "another name");
        return false;
    }
    if (byName_.count(node.key()) > 0) {
        context.keyError(node, pointer, "\"" + node.key() + "\" is already a parameter", "another name");
        return false;
    }
    if (entries_.size() >= maxNames) {
        context.keyError(node, pointer, "too many names", "at most " + std::to_string(maxNames));
        return false;
    }
    return true;
}

void Scope::declareParameter(Context& context, const Node& node, const std::string& pointer) {
    if (!acceptName(context, node, pointer))
        return;
    auto entry = std::make_unique<Entry>();
    entry->isParameter = true;
    entry->node = node;
    entry->pointer = pointer;
    Parameter& p = entry->parameter;
    p.name = node.key();
    ObjectReader reader(context, node, pointer);
    if (reader.valid()) {
        entry->valueNode = reader.find("value");
        if (!entry->valueNode)
            reader.require("value", "a number or {\"expr\": formula}");
        p.unit = reader.string("unit", p.unit);
        p.about = reader.string("about", p.about);
        p.integer = reader.boolean("integer", false);
        entry->formerName = reader.string("formerly", "");
        reader.find("min"); // read when the value is checked; they may be formulas
        reader.find("max");
        reader.finish();
    }
    byName_[p.name] = entry.get();
    entries_.push_back(std::move(entry));
}

void Scope::declareConstant(Context& context, const Node& node, const std::string& pointer) {
    if (!acceptName(context, node, pointer))
        return;
    auto entry = std::make_unique<Entry>();
    entry->node = node;
    entry->valueNode = node;
    entry->pointer = pointer;
    entry->parameter.name = node.key();
    if (node.find("value")) { // the long form, with room for an "about"
        ObjectReader reader(context, node, pointer);
        entry->valueNode = reader.find("value");
        entry->parameter.unit = reader.string("unit", "1");
        entry->parameter.about = reader.string("about", "");
        reader.finish();
    }
    byName_[node.key()] = entry.get();
    entries_.push_back(std::move(entry));
}

std::string Scope::presentName(Context& context, const std::string& name, const Node& at) const {
    if (byName_.count(name) > 0)
        return name;
    for (const auto& entry : entries_)
        if (entry->formerName == name && !name.empty()) {
            context.noteRenamed(at, "/parameters", name, "\"" + entry->parameter.name + "\"");
            return entry->parameter.name;
        }
    return name;
}

void Scope::override(Context& context, const std::vector<Override>& overrides, const std::optional<Node>& parameters) {
    const Node at = parameters ? *parameters : context.document.root();
    std::vector<std::string> known;
    for (const auto& entry : entries_)
        if (entry->isParameter)
            known.push_back(entry->parameter.name);
    for (const Override& o : overrides) {
        const auto found = byName_.find(presentName(context, o.name, at));
        if (found == byName_.end() || !found->second->isParameter) {
            std::string all;
            for (const std::string& name : known)
                all += (all.empty() ? "" : ", ") + name;
            context.keyError(at, "/parameters", "the scene has no parameter \"" + o.name + "\"",
                             known.empty() ? "none: this scene declares no parameters" : "one of " + all,
                             nearestName(o.name, known));
            continue;
        }
        found->second->overridden = o.value;
    }
}

void Scope::declare(Context& context, const std::optional<Node>& parameters, const std::optional<Node>& constants,
                    const std::vector<Override>& overrides) {
    const auto block = [&](const std::optional<Node>& node, const char* name, auto&& each) {
        if (!node)
            return;
        const std::string pointer = std::string("/") + name;
        if (node->kind() != Node::Kind::Object) {
            context.error(*node, pointer, std::string("\"") + name + "\" is " + kindName(node->kind()), "an object");
            return;
        }
        for (const Node& child : node->children())
            if (child.key() != "about")
                each(child, pointer + "/" + pointerToken(child.key()));
    };
    block(parameters, "parameters", [&](const Node& n, const std::string& p) { declareParameter(context, n, p); });
    block(constants, "constants", [&](const Node& n, const std::string& p) { declareConstant(context, n, p); });
    override(context, overrides, parameters);
    for (const auto& entry : entries_)
        (void)resolve(context, *entry, *entry->node, entry->pointer); // it reports
}

bool Scope::resolve(Context& context, Entry& entry, const Node& at, const std::string& pointer) {
    if (entry.state == Entry::State::Done || entry.state == Entry::State::Failed)
        return entry.state == Entry::State::Done; // a failure was reported when it happened
    if (entry.state == Entry::State::Busy) {
        context.error(at, pointer, "\"" + entry.parameter.name + "\" is defined in terms of itself",
                      "formulas without circular references");
        return false;
    }
    if (depth_ >= maxChain) {
        context.error(at, pointer, "the chain of unevaluated definitions is too long",
                      "at most " + std::to_string(maxChain) + ", or declarations in the order of use");
        return false;
    }
    entry.state = Entry::State::Busy;
    ++depth_;
    std::optional<double> value;
    if (entry.overridden)
        value = entry.overridden;
    else if (entry.valueNode)
        value =
            readNumber(context, *entry.valueNode,
                       entry.pointer + (entry.valueNode->offset() != entry.node->offset() ? "/value" : ""), anyNumber);
    --depth_;
    entry.state = value ? Entry::State::Done : Entry::State::Failed;
    entry.parameter.value = value.value_or(0.0);
    // A value out of range is reported once: what depends on it gives no further error.
    if (value && entry.isParameter && !checkParameter(context, entry))
        entry.state = Entry::State::Failed;
    return entry.state == Entry::State::Done;
}

bool Scope::checkParameter(Context& context, Entry& entry) {
    Parameter& p = entry.parameter;
    const auto limit = [&](const char* key, double& target) {
        if (const std::optional<Node> node = entry.node->find(key))
            target = readNumber(context, *node, entry.pointer + "/" + key, anyNumber).value_or(target);
    };
    limit("min", p.min);
    limit("max", p.max);
    if (p.min > p.max) {
        context.error(*entry.node->find("min"), entry.pointer + "/min", "the range of \"" + p.name + "\" is empty",
                      "min <= max");
        return false;
    }
    std::string fault;
    if (!std::isfinite(p.value))
        fault = " is not a finite number";
    else if (p.value < p.min || p.value > p.max)
        fault = " is out of range";
    else if (p.integer && p.value != std::floor(p.value))
        fault = " is not a whole number";
    if (fault.empty())
        return true;
    char number[32];
    std::snprintf(number, sizeof number, "%.10g", p.value);
    const std::string said = entry.overridden ? "the value given for \"" : "the value of \"";
    context.error(entry.valueNode ? *entry.valueNode : *entry.node, entry.pointer + "/value",
                  said + p.name + "\", " + number + "," + fault, rangeText(p));
    return false;
}

std::optional<double> Scope::value(Context& context, const std::string& name, const Node& at,
                                   const std::string& pointer) {
    if (name == "pi")
        return M_PI;
    const auto found = byName_.find(name);
    if (found == byName_.end()) {
        context.error(at, pointer, "there is no parameter or constant \"" + name + "\"", {},
                      nearestName(name, names()));
        return std::nullopt;
    }
    if (!resolve(context, *found->second, at, pointer))
        return std::nullopt;
    return found->second->parameter.value;
}

std::optional<double> Scope::evaluate(Context& context, const std::string& formula, const Node& at,
                                      const std::string& pointer) {
    const auto fail = [&](std::size_t column, const std::string& what, const std::string& expected,
                          const std::string& nearest) {
        context.errorAt(at.offset() + 1 + std::min(column, formula.size()), pointer, what, expected, nearest);
        return std::nullopt;
    };
    if (formula.size() > kLongestFormula)
        return fail(0, "the formula is too long", "at most " + std::to_string(kLongestFormula) + " characters", {});
    const auto owned = std::make_unique<mu::Parser>(); // kilobytes; formulas of formulas recurse
    mu::Parser& parser = *owned;
    defineFunctions(parser);
    parser.DefineConst("pi", M_PI);
    for (const NameUse& use : namesIn(formula)) {
        if (use.name == "pi" || isFunction(use.name))
            continue;
        const auto found = byName_.find(use.name);
        if (found == byName_.end()) {
            const std::size_t next = formula.find_first_not_of(" \t", use.at + use.name.size());
            if (next == std::string::npos || formula[next] != '(')
                return fail(use.at, "unknown name \"" + use.name + "\" in the formula", "a parameter or constant",
                            nearestName(use.name, names()));
            std::vector<std::string> functions;
            for (const auto& function : calculator_->functions.GetFunDef())
                functions.push_back(function.first);
            return fail(use.at, "unknown function \"" + use.name + "\" in the formula", "a function",
                        nearestName(use.name, functions));
        }
        if (!resolve(context, *found->second, at, pointer))
            return std::nullopt;
        parser.DefineConst(use.name, found->second->parameter.value);
    }
    try {
        parser.SetExpr(formula);
        const double result = parser.Eval();
        if (parser.GetNumResults() != 1)
            return fail(0, "the formula gives several values", "one value", {});
        if (!std::isfinite(result))
            return fail(0, "the formula \"" + formula + "\" gives no finite number", {}, {});
        return result;
    } catch (const mu::ParserError& error) {
        const auto column = static_cast<std::size_t>(std::max(0, static_cast<int>(error.GetPos())));
        return fail(column, "the formula cannot be read: " + error.GetMsg(), {}, {});
    }
}

std::vector<Parameter> Scope::parameters() const {
    std::vector<Parameter> result;
    for (const auto& entry : entries_)
        if (entry->isParameter)
            result.push_back(entry->parameter);
    return result;
}

} // namespace supercircle::scene
