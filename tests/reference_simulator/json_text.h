#pragma once
// JSON from text and back. nlohmann's parser and printer are compiled once, in json_text.cpp.

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace supercircle::reference_simulator {

/// The document; throws nlohmann's parse_error.
nlohmann::json parseJson(const std::string& text);
nlohmann::json parseJson(std::istream& in);
/// The same with members in the order of the text.
nlohmann::ordered_json parseOrderedJson(std::istream& in);
/// Indented by one, or on one line with -1.
std::string jsonText(const nlohmann::ordered_json& json, int indent = 1);
std::string jsonText(const nlohmann::json& json, int indent = 1);

} // namespace supercircle::reference_simulator
