// The JSON Schema (for editors and other tools) accepts what the loader accepts and refuses what is plainly wrong.

#include "tests/plugin/recording/experiment/support.h"
#include "tests/support/json.h"
#include "tests/support/schema.h"

#include <nlohmann/json.hpp>

using namespace experimenttest;
using nlohmann::json;

namespace {

bool accepts(const json& document) {
    return test::schemaErrors("plugin/recording/experiment/experiment.schema.json", document).empty();
}

} // namespace

TEST_CASE("the schema accepts the baselines", "[experiment]") {
    for (int number = 101; number <= 106; ++number) {
        INFO(number);
        CHECK(accepts(test::jsonOf(baseline(number))));
    }
}

TEST_CASE("schema and loader refuse the same", "[experiment]") {
    const auto bothRefuse = [](const char* pointer, const json& value) {
        json document = test::jsonOf(baseline(101));
        document[json::json_pointer(pointer)] = value;
        INFO(pointer << " = " << value);
        CHECK_FALSE(accepts(document));
        std::vector<scene::Problem> problems;
        CHECK_FALSE(experiment::loadText(test::jsonText(document), "e.json", problems));
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
    json document = test::jsonOf(baseline(101));
    document["specimens"][0].erase("linear_mass_kg_m");
    CHECK_FALSE(accepts(document));
}
