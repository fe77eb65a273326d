// valijson uses std::regex, where g++ 12 with sanitizers sees an uninitialised variable that is none.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "tests/support/schema.h"
#include "tests/support/json.h"

#include <map>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace supercircle::test {

std::string schemaErrors(const std::string& schema, const nlohmann::json& document) {
    static std::map<std::string, valijson::Schema> parsed;
    const auto [at, isNew] = parsed.try_emplace(schema);
    if (isNew) {
        const nlohmann::json text = jsonOf(std::string(SC_SOURCE_DIR) + "/" + schema);
        valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
        parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), at->second);
    }
    valijson::Validator validator;
    valijson::ValidationResults results;
    if (validator.validate(at->second, valijson::adapters::NlohmannJsonAdapter(document), &results))
        return {};
    std::string all = "refused: ";
    valijson::ValidationResults::Error error;
    while (results.popError(error)) {
        for (const std::string& part : error.context)
            all += part;
        all += ": " + error.description + "\n";
    }
    return all;
}

} // namespace supercircle::test
