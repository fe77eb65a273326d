#include "plugin/scene/loader/formula.h"

#include "plugin/scene/loader/formula_functions.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cctype>
#include <limits>

#include <muParser.h>

namespace supercircle::scene {

void defineFunctions(mu::Parser& parser) {
    parser.DefineFun("sinc", math::sinc);
    parser.DefineFun("sin", math::sin);
    parser.DefineFun("cos", math::cos);
    parser.DefineFun("tan", math::tan);
    parser.DefineFun("asin", math::asin);
    parser.DefineFun("acos", math::acos);
    parser.DefineFun("atan", math::atan);
    parser.DefineFun("atan2", math::atan2);
    parser.DefineFun("sinh", math::sinh);
    parser.DefineFun("cosh", math::cosh);
    parser.DefineFun("tanh", math::tanh);
    parser.DefineFun("exp", math::exp);
    parser.DefineFun("ln", math::log);
    parser.DefineFun("log10", math::log10);
    parser.DefineFun("log2", math::log2);
}

bool startsName(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool continuesName(char c) {
    return startsName(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
}

std::vector<NameUse> namesIn(const std::string& formula) {
    const auto digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(formula[i])) != 0; };
    std::vector<NameUse> uses;
    std::size_t i = 0;
    while (i < formula.size()) {
        const char c = formula[i];
        if (startsName(c)) {
            const std::size_t start = i;
            while (i < formula.size() && continuesName(formula[i]))
                ++i;
            uses.push_back({formula.substr(start, i - start), start});
        } else if (digit(i) || c == '.') {
            while (i < formula.size() && (digit(i) || formula[i] == '.'))
                ++i;
            if (i + 1 < formula.size() && (formula[i] == 'e' || formula[i] == 'E') &&
                (digit(i + 1) || formula[i + 1] == '+' || formula[i + 1] == '-'))
                i += 2;
        } else {
            ++i;
        }
    }
    return uses;
}

namespace {

void define(mu::Parser& parser) {
    defineFunctions(parser);
    parser.DefineFun("log", math::log);
    parser.DefineConst("pi", M_PI);
}

} // namespace

Result<Formula> Formula::parse(const std::string& text) {
    using Failed = Result<Formula>;
    if (text.size() > kLongestFormula)
        return Failed::failure("the formula is longer than " + std::to_string(kLongestFormula) + " characters");
    Formula out;
    out.text_ = text;
    mu::Parser parser;
    define(parser);
    for (const NameUse& use : namesIn(text))
        if (use.name != "pi" && parser.GetFunDef().count(use.name) == 0 &&
            std::find(out.names_.begin(), out.names_.end(), use.name) == out.names_.end())
            out.names_.push_back(use.name);
    try {
        for (const std::string& name : out.names_)
            parser.DefineConst(name, 1.0);
        parser.SetExpr(text);
        (void)parser.Eval();
        if (parser.GetNumResults() != 1)
            return Failed::failure("the formula gives several values, not one");
    } catch (const mu::ParserError& error) {
        return Failed::failure("the formula cannot be read at character " +
                               std::to_string(std::max(0, static_cast<int>(error.GetPos())) + 1) + ": " +
                               error.GetMsg());
    }
    return out;
}

std::vector<double> Formula::values(const std::vector<std::pair<std::string, double>>& given, const std::string& over,
                                    const std::vector<double>& points) const {
    std::vector<double> out(points.size(), std::numeric_limits<double>::quiet_NaN());
    mu::Parser parser; // of this call: threads evaluate at the same time
    define(parser);
    double at = 0.0;
    try {
        for (const auto& [name, value] : given)
            if (name != over)
                parser.DefineConst(name, value);
        parser.DefineVar(over, &at);
        parser.SetExpr(text_);
        for (std::size_t i = 0; i < points.size(); ++i) {
            at = points[i];
            out[i] = parser.Eval();
        }
    } catch (const mu::ParserError&) {
        return out; // a name without value: no number
    }
    return out;
}

} // namespace supercircle::scene
