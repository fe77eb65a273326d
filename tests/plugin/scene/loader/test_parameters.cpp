// Parameters, constants, formulas and overrides.

#include "tests/plugin/scene/loader/support.h"

using namespace scenetest;

namespace {

const std::string sample = R"json({
  "parameters": {
    "mu": { "value": 0.35, "min": 0, "max": 2, "unit": "1", "about": "friction" },
    "count": { "value": 3, "min": 1, "max": 10, "integer": true },
    "depth": { "value": { "expr": "2*mu + half" }, "min": 0, "max": { "expr": "count + 3" } }
  },
  "constants": { "half": 0.5, "deep": { "expr": "sqrt(depth^2)" }, "long": { "value": 7, "about": "with a word" } },
  "shell": [ { "mu": { "param": "mu" }, "elements": { "param": "count" }, "spin": { "expr": "deep + long" } } ],
  "duration": { "expr": "pi * count" }
})json";

Problem overrideError(const std::string& name, double value) {
    const auto errors = refused(sample, {{name, value}});
    INFO(say(errors));
    REQUIRE(errors.size() == 1);
    return errors.front();
}

double formula(const std::string& text) {
    return loadedText("{\"constants\": {\"R\": 2, \"phi\": 0.5}, \"shell\": [{\"angle\": {\"expr\": \"" + text +
                      "\"}}]}")
        .shells[0]
        .angle;
}

Problem formulaError(const std::string& text) {
    const auto errors =
        refused("{\"constants\": {\"R\": 2, \"phi\": 0.5}, \"duration\": {\"expr\": \"" + text + "\"}}");
    INFO(say(errors));
    REQUIRE(errors.size() == 1);
    return errors.front();
}

} // namespace

TEST_CASE("defaults, formulas of parameters and constants in any order") {
    const Scene s = loadedText(sample);
    REQUIRE(s.parameters.size() == 3);
    CHECK(s.parameters[0].name == "mu");
    CHECK(s.parameters[0].about == "friction");
    CHECK(s.parameters[1].integer);
    CHECK(s.parameters[2].value == Approx(1.2).epsilon(1e-15));
    CHECK(s.parameters[2].max == 6.0);
    CHECK(s.shells[0].mu == 0.35);
    CHECK(s.shells[0].elements == 3);
    CHECK(s.shells[0].spin == Approx(8.2).epsilon(1e-15));
    CHECK(s.duration == Approx(3 * M_PI).epsilon(1e-15));
}

TEST_CASE("an override reaches everything that depends on it") {
    const Scene s = loadedText(sample, {{"mu", 0.5}, {"count", 4}});
    CHECK(s.shells[0].mu == 0.5);
    CHECK(s.shells[0].elements == 4);
    CHECK(s.parameters[2].value == 1.5);
    CHECK(s.duration == Approx(4 * M_PI).epsilon(1e-15));
    // An overridden formula is replaced, with all that depends on it.
    CHECK(loadedText(sample, {{"depth", 0.25}}).shells[0].spin == 7.25);
    // The last value counts.
    CHECK(loadedText(sample, {{"mu", 0.5}, {"mu", 0.75}}).shells[0].mu == 0.75);
}

TEST_CASE("overrides are checked") {
    const Problem unknown = overrideError("muu", 1);
    CHECK(unknown.toString() ==
          "text.json:2:3: /parameters: the scene has no parameter \"muu\"; expected one of mu, count, "
          "depth; did you mean \"mu\"?");
    CHECK(contains(overrideError("half", 1).what, "no parameter \"half\"")); // constants are not parameters
    CHECK(contains(overrideError("mu", 2.5).what, "out of range"));
    CHECK(contains(overrideError("mu", -0.1).expected, "from 0 to 2"));
    CHECK(overrideError("mu", 2.5).pointer == "/parameters/mu/value");
    CHECK_FALSE(refused(sample, {{"mu", std::nan("")}}).empty());
    CHECK_FALSE(refused(sample, {{"mu", INFINITY}}).empty());
    CHECK(contains(overrideError("count", 2.5).what, "not a whole number"));
    CHECK(contains(overrideError("depth", 6.5).what, "out of range"));
    CHECK(contains(refused("{\"duration\": 1}", {{"mu", 1}})[0].expected, "declares no parameters"));
}

TEST_CASE("a parameter given as NaN is called so") {
    bool said = false;
    for (const Problem& p : refused(sample, {{"mu", std::nan("")}}))
        said = said || contains(p.what, "not a finite number");
    CHECK(said);
}

TEST_CASE("declarations are checked") {
    const auto error = [](const std::string& block) {
        const auto errors = refused("{\"parameters\": {" + block + "}}");
        INFO(say(errors));
        REQUIRE(errors.size() == 1);
        return errors.front();
    };
    CHECK(contains(error("\"a\": {}").what, "\"value\" is missing"));
    CHECK(contains(error("\"a\": 3").what, "a number"));
    CHECK(contains(error("\"a\": {\"value\": 3, \"max\": 2}").what, "out of range"));
    CHECK(contains(error("\"a\": {\"value\": 3, \"min\": 4, \"max\": 2}").what, "empty"));
    CHECK(contains(error("\"a\": {\"value\": 1.5, \"integer\": true}").what, "whole number"));
    CHECK(contains(error("\"2a\": {\"value\": 1}").what, "is not a valid name"));
    CHECK(contains(error("\"a b\": {\"value\": 1}").what, "is not a valid name"));
    CHECK(contains(error("\"\": {\"value\": 1}").what, "is not a valid name"));
    CHECK(contains(error("\"pi\": {\"value\": 1}").what, "reserved"));
    CHECK(contains(error("\"sin\": {\"value\": 1}").what, "reserved"));
    CHECK(contains(refused("{\"parameters\": {\"a\": {\"value\": 1}}, \"constants\": {\"a\": 2}}")[0].what, "already"));
    CHECK(contains(refused("{\"parameters\": []}")[0].what, "array"));
}

TEST_CASE("unknown names and circular definitions are reported") {
    const auto unknown = refused("{\"parameters\": {\"mu\": {\"value\": 1}}, \"duration\": {\"param\": \"nu\"}}");
    REQUIRE(unknown.size() == 1);
    CHECK(unknown[0].pointer == "/duration/param");
    CHECK(unknown[0].nearest == "mu");
    const auto inFormula = [](const std::string& formula) {
        const auto errors =
            refused(R"({"parameters": {"width": {"value": 1}, "sine": {"value": 1}}, "duration": {"expr": ")" +
                    formula + R"("}})");
        REQUIRE(errors.size() == 1);
        return errors.front();
    };
    CHECK(inFormula("2*widht").nearest == "width");
    CHECK(inFormula("2*sinr(1)").nearest == "sin"); // although the parameter "sine" is as near
    CHECK(inFormula("2*sqr (1)").nearest == "sqrt");
    CHECK(inFormula("2*spin").nearest.empty()); // one letter off a function, which it is not
    CHECK(inFormula("tan*2").nearest.empty());
    CHECK(inFormula("2*x").nearest.empty());
    CHECK(inFormula("widht(1)").what == "unknown function \"widht\" in the formula");
    for (const char* text :
         {"{\"constants\": {\"a\": {\"expr\": \"a\"}}}",
          "{\"constants\": {\"a\": {\"expr\": \"b+1\"}, \"b\": {\"param\": \"c\"}, \"c\": {\"expr\": \"a\"}}}"}) {
        const auto circle = refused(text);
        INFO(say(circle));
        REQUIRE(circle.size() == 1);
        CHECK(contains(circle[0].what, "in terms of itself"));
    }
}

TEST_CASE("a long chain of definitions is not circular, and never exhausts the stack") {
    const auto chain = [](int length, bool backwards) {
        std::string all;
        for (int i = 0; i < length; ++i) {
            const std::string before = i == 0 ? "0" : "a" + std::to_string(i - 1);
            const std::string one = "\"a" + std::to_string(i) + "\": {\"expr\": \"" + before + " + 1\"}";
            all = backwards ? one + (i == 0 ? "" : ", ") + all : all + (i == 0 ? "" : ", ") + one;
        }
        return "{\"constants\": {" + all + "}, \"duration\": {\"param\": \"a" + std::to_string(length - 1) + "\"}}";
    };
    CHECK(loadedText(chain(1000, false)).duration == 1000.0);
    CHECK(loadedText(chain(40, true)).duration == 40.0);
    for (const Problem& p : refused(chain(1000, true))) // one for every fifty
        CHECK(contains(p.what, "chain of unevaluated definitions"));
}

TEST_CASE("formulas") {
    CHECK(formula("R - 0.5/2") == 1.75);
    CHECK(formula("-2*cos(pi*phi)*R") == Approx(0.0).margin(1e-15));
    CHECK(formula("max(0.6, R)") == 2.0);
    CHECK(formula("1e-3 + 2.5E+1*R") == 50.001);
    CHECK(formula("phi > 0.4 ? 1 : 2") == 1.0);
    CHECK(formula("R == 2") == 1.0);
    CHECK(formula("sinc(0)") == 1.0);
    CHECK(formula("sinc(phi)") == Approx(std::sin(0.5) / 0.5).epsilon(1e-15));
    CHECK(formula("R^3") == 8.0);
}

TEST_CASE("errors in formulas stand at their column") {
    // {"constants": {"R": 2, "phi": 0.5}, "duration": {"expr": " takes 58 columns
    const Problem unknown = formulaError("R + fhi");
    CHECK(unknown.nearest == "phi");
    CHECK(unknown.column == 58 + 1 + 4);
    CHECK(unknown.pointer == "/duration/expr");
    CHECK_FALSE(formulaError("R + ").what.empty());
    CHECK_FALSE(formulaError("").what.empty());
    CHECK_FALSE(formulaError("(R").what.empty());
    CHECK_FALSE(formulaError("R R").what.empty());
    CHECK_FALSE(formulaError("R = 3").what.empty()); // nothing can be assigned to
    CHECK(contains(formulaError("1, 2").what, "several values"));
    CHECK(contains(formulaError("1/0").what, "no finite number"));
    CHECK(contains(formulaError("sqrt(-R)").what, "no finite number"));
    CHECK(formulaError("coss(phi)").nearest == "cos");
    CHECK_FALSE(formulaError("cos").what.empty());
    CHECK_FALSE(formulaError("cos()").what.empty());
    CHECK_FALSE(formulaError("0x").what.empty());
    CHECK_FALSE(formulaError("\\u00e4").what.empty());
}
