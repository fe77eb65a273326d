#include "plugin/recording/table/json_text.h"

#include <nlohmann/json.hpp>

namespace supercircle::record {

using Json = nlohmann::ordered_json;

Json parseJson(std::string_view text) {
    return Json::parse(text);
}

Json tryParseJson(std::string_view text) {
    return Json::parse(text, nullptr, false);
}

std::string jsonText(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace supercircle::record
