#include "tests/support/json.h"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace supercircle::test {

nlohmann::json parseJson(const std::string& text) {
    return nlohmann::json::parse(text);
}

nlohmann::json jsonOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(path + ": cannot be read");
    return parseJson({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
}

std::string jsonText(const nlohmann::json& json) {
    return json.dump();
}

} // namespace supercircle::test
