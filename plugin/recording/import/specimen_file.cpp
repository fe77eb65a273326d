#include "plugin/recording/import/specimen_file.h"

#include "plugin/recording/table/json_text.h"
#include "plugin/recording/table/text.h"
#include "plugin/scene/loader/document.h"

#include <nlohmann/json.hpp>

namespace supercircle::importing {

Result<std::string> readSpecimenFile(const std::string& file) {
    using Own = Result<std::string>;
    std::vector<scene::Problem> problems;
    const auto text = scene::readFile(file, problems);
    const auto document = text ? scene::parseDocument(*text, file, problems) : Result<scene::Document>::failure("");
    if (!document)
        return Own::failure(problems.front().toString());
    if (document->root().kind() != scene::Node::Kind::Object)
        return Own::failure(file + ":1:1: this is no JSON object");
    return text;
}

Result<ForceZero> parseForceZero(const std::string& words) {
    using ZeroKind = ForceZero::Kind;
    ForceZero z;
    if (words == "none") {
        z.kind = ZeroKind::None;
        return z;
    }
    const std::string mean = "the mean reading of the first ", subtracted = " s is subtracted";
    if (words.rfind(mean, 0) == 0 && words.size() > mean.size() + subtracted.size()) {
        z.kind = ZeroKind::Window;
        if (record::parseNumber(words.substr(mean.size(), words.size() - mean.size() - subtracted.size()), z.to) &&
            z.to > 0.0)
            return z;
    }
    if (const std::size_t dots = words.find(".."); dots != std::string::npos) {
        z.kind = ZeroKind::Window;
        if (record::parseNumber(words.substr(0, dots), z.from) && record::parseNumber(words.substr(dots + 2), z.to) &&
            z.from >= 0.0 && z.to > z.from)
            return z;
    }
    z.kind = ZeroKind::Value;
    if (record::parseNumber(words, z.value))
        return z;
    return Result<ForceZero>::failure("\"" + words +
                                      "\" is no zero of the force; expected none, a range of times in s as 0..0.5, or "
                                      "a value in N");
}

Result<ForceZero> statedForceZero(const std::string& file) {
    const auto own = readSpecimenFile(file);
    if (!own)
        return Result<ForceZero>::failure(own.error());
    const auto json = record::parseJson(*own);
    const nlohmann::ordered_json::json_pointer place("/sensors/force_zero");
    if (!json.contains(place) || !json[place].is_string())
        return ForceZero{};
    auto zero = parseForceZero(json[place].get<std::string>());
    return zero ? zero : Result<ForceZero>::failure(file + ": /sensors/force_zero: " + zero.error());
}

} // namespace supercircle::importing
