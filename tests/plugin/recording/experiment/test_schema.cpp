// The JSON Schema (for editors and other tools) accepts what the loader accepts and refuses what is plainly wrong.

// valijson uses std::regex, where g++ 12 with sanitizers sees an uninitialised variable that is none.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "tests/plugin/recording/experiment/support.h"

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

using namespace experimenttest;
using nlohmann::json;

namespace {

bool accepts(const json& document) {
    const json text =
        json::parse(contentOf(std::string(SC_SOURCE_DIR) + "/plugin/recording/experiment/experiment.schema.json"));
    valijson::Schema schema;
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema);
    valijson::Validator validator;
    valijson::ValidationResults results;
    return validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), &results);
}

} // namespace

TEST_CASE("the schema accepts the baselines", "[experiment]") {
    for (int number = 101; number <= 106; ++number) {
        INFO(number);
        CHECK(accepts(json::parse(contentOf(baseline(number)))));
    }
}

TEST_CASE("schema and loader refuse the same", "[experiment]") {
    const auto bothRefuse = [](const char* pointer, const json& value) {
        json document = json::parse(contentOf(baseline(101)));
        document[json::json_pointer(pointer)] = value;
        INFO(pointer << " = " << value);
        CHECK_FALSE(accepts(document));
        std::vector<scene::Problem> problems;
        CHECK_FALSE(experiment::loadText(document.dump(), "e.json", problems));
    };
    bothRefuse("/schema", "rod-recordings/2");
    bothRefuse("/protocol", "drop_test");
    bothRefuse("/gravity_m_s2", {0.0});
    bothRefuse("/specimens", json::array());
    bothRefuse("/specimens/0/thickness_m", 0.0);
    bothRefuse("/specimens/0/clamp/carried_by", "crane");
    bothRefuse("/obstacles/0/radius_m", -1.0);
    bothRefuse("/friction/coefficient", -0.1);
    bothRefuse("/runs/0/sampling_hz", 0.0);
    bothRefuse("/runs/0/file", 7);
    bothRefuse("/markers/0/arc_fraction", 2.0);
    json document = json::parse(contentOf(baseline(101)));
    document["specimens"][0].erase("linear_mass_kg_m");
    CHECK_FALSE(accepts(document));
}
