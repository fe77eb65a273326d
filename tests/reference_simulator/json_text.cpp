#include "tests/reference_simulator/json_text.h"

#include <istream>
#include <nlohmann/json.hpp>

namespace supercircle::reference_simulator {

nlohmann::json parseJson(const std::string& text) {
    return nlohmann::json::parse(text);
}

nlohmann::json parseJson(std::istream& in) {
    return nlohmann::json::parse(in);
}

nlohmann::ordered_json parseOrderedJson(std::istream& in) {
    return nlohmann::ordered_json::parse(in);
}

std::string jsonText(const nlohmann::ordered_json& json, int indent) {
    return json.dump(indent);
}

std::string jsonText(const nlohmann::json& json, int indent) {
    return json.dump(indent);
}

} // namespace supercircle::reference_simulator
