#pragma once
// JSON from text, from files and back. nlohmann's parser and printer are compiled once, in json.cpp.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace supercircle::test {

/// The document; throws nlohmann's parse_error.
nlohmann::json parseJson(const std::string& text);
/// The document of a file; throws if it is not there.
nlohmann::json jsonOf(const std::string& path);
/// On one line.
std::string jsonText(const nlohmann::json& json);

} // namespace supercircle::test
