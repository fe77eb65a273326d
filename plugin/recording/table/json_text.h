#pragma once
// JSON from text and back. nlohmann's parser and printer are templates: compiled once, in json_text.cpp, because a
// source that instantiates them costs the compiler one to three seconds.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace supercircle::record {

/// The document; throws nlohmann's parse_error.
[[nodiscard]] nlohmann::ordered_json parseJson(std::string_view text);
/// The document, `is_discarded()` where the text is not JSON.
[[nodiscard]] nlohmann::ordered_json tryParseJson(std::string_view text);
/// Indented, or on one line with -1. Bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string jsonText(const nlohmann::ordered_json& json, int indent = 2);

} // namespace supercircle::record
