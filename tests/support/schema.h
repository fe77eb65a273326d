#pragma once
// Documents against a JSON Schema. valijson is compiled once, in schema.cpp.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace supercircle::test {

/// Errors by the schema of a file of the project, such as "plugin/scene/scene.schema.json"; empty if it accepts.
std::string schemaErrors(const std::string& schema, const nlohmann::json& document);

} // namespace supercircle::test
