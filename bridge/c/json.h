#pragma once
// JSON texts that cross the border.

#include "bridge/c/guard.h"

#include <nlohmann/json.hpp>
#include <string>

namespace supercircle::c {

using Json = nlohmann::ordered_json;

/// Reads a text of the caller. Refuses null, what is no JSON, and what is nested deeper than scenes may be.
/// @param what it is, such as "the request"
inline Json parsed(const char* text, const char* what) {
    const std::string json = textOf(text, -1, what);
    requireShallow(json);
    try {
        return Json::parse(json);
    } catch (const Json::exception& e) {
        refuse(SC_BAD_INPUT, std::string(what) + ": not JSON: " + e.what());
    }
}

/// In one line, or with this many spaces a level. Bytes that are no UTF-8 are replaced.
inline std::string written(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace supercircle::c
