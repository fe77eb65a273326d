#pragma once
// JSON texts that cross the border (guard.cpp, where nlohmann's parser and printer are compiled once).

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace supercircle::c {

using Json = nlohmann::ordered_json;

/// Reads a text of the caller. Refuses null, what is no JSON, and what is nested deeper than scenes may be.
/// @param what it is, such as "the request"
Json parsed(const char* text, const char* what);

/// In one line, or with this many spaces a level. Bytes that are no UTF-8 are replaced.
std::string written(const Json& json, int indent = -1);

} // namespace supercircle::c
