#include "hidden_includes.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace supercircle::architecture {

namespace {

using Names = std::vector<std::string_view>;

/// Names that headers of ours use. Of each only what no other header here has to declare.
const std::vector<std::pair<std::string_view, Names>>& known() {
    static const std::vector<std::pair<std::string_view, Names>> kKnown = {
        {"Eigen/Core", {"Eigen::"}},
        {"Eigen/Cholesky", {"Eigen::LLT", "Eigen::LDLT"}},
        {"algorithm",
         {"std::min", "std::max", "std::clamp", "std::sort", "std::find_if", "std::any_of", "std::all_of", "std::copy",
          "std::copy_n", "std::fill", "std::lower_bound", "std::transform"}},
        {"array", {"std::array"}},
        {"atomic", {"std::atomic"}},
        {"chrono", {"std::chrono"}},
        {"cmath",
         {"std::abs", "std::sqrt", "std::isfinite", "std::isinf", "std::isnan", "std::floor", "std::ceil", "std::round",
          "std::lround", "std::copysign"}},
        {"cstdint",
         {"std::int8_t", "std::int16_t", "std::int32_t", "std::int64_t", "std::uint8_t", "std::uint16_t",
          "std::uint32_t", "std::uint64_t"}},
        {"cstdio", {"std::printf", "std::snprintf", "std::fprintf", "std::fputs", "std::FILE"}},
        {"deque", {"std::deque"}},
        {"filesystem", {"std::filesystem"}},
        {"fstream", {"std::ifstream", "std::ofstream", "std::fstream"}},
        {"functional", {"std::function", "std::reference_wrapper"}},
        {"limits", {"std::numeric_limits"}},
        {"map", {"std::map", "std::multimap"}},
        {"memory", {"std::unique_ptr", "std::shared_ptr", "std::weak_ptr", "std::make_unique", "std::make_shared"}},
        {"mutex", {"std::mutex", "std::lock_guard", "std::unique_lock", "std::scoped_lock"}},
        {"numeric", {"std::accumulate", "std::iota"}},
        {"optional", {"std::optional", "std::nullopt"}},
        {"set", {"std::set", "std::multiset"}},
        {"span", {"std::span"}},
        {"sstream", {"std::stringstream", "std::istringstream", "std::ostringstream"}},
        {"string", {"std::string", "std::to_string"}},
        {"string_view", {"std::string_view"}},
        {"tuple", {"std::tuple", "std::tie"}},
        {"utility", {"std::pair", "std::move", "std::swap", "std::forward", "std::exchange"}},
        {"variant", {"std::variant"}},
        {"vector", {"std::vector"}},
    };
    return kKnown;
}

/// Headers that every standard library lets bring another one of the list.
bool bringsToo(const std::set<std::string>& brought, std::string_view wanted) {
    const auto has = [&](const char* header) { return brought.count(header) > 0; };
    if (wanted == "Eigen/Core")
        return std::any_of(brought.begin(), brought.end(),
                           [](const std::string& h) { return h.rfind("Eigen/", 0) == 0; });
    if (wanted == "string_view")
        return has("string");
    if (wanted == "utility") // containers and what holds others need it in their own declarations
        for (const char* header : {"algorithm", "array", "functional", "map", "memory", "optional", "set", "string",
                                   "tuple", "variant", "vector"})
            if (has(header))
                return true;
    return false;
}

/// Path and kind of bracket of an #include line; an empty path: none.
std::pair<std::string, char> included(const std::string& line) {
    const std::size_t hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line[hash] != '#' || line.find("include", hash) == std::string::npos)
        return {};
    const std::size_t open = line.find_first_of("<\"", hash);
    const std::size_t close = open == std::string::npos ? open : line.find_first_of(">\"", open + 1);
    if (close == std::string::npos)
        return {};
    return {line.substr(open + 1, close - open - 1), line[open]};
}

/// The file of the project that an include names, or nothing.
std::string resolved(const std::string& from, const std::string& path, const Files& files) {
    const std::string folder = from.substr(0, from.rfind('/') + 1);
    for (const std::string& start : {folder, std::string(), std::string("plugin/api/include/"),
                                     std::string("bridge/box2d/include/"), std::string("bridge/c/include/")})
        if (files.count(start + path) > 0)
            return start + path;
    return {};
}

void collect(const std::string& file, const Files& files, std::set<std::string>& seen, std::set<std::string>& brought) {
    if (!seen.insert(file).second)
        return;
    for (const std::string& line : files.at(file)) {
        const auto [path, bracket] = included(line);
        if (path.empty())
            continue;
        if (const std::string own = resolved(file, path, files); !own.empty())
            collect(own, files, seen, brought);
        else
            brought.insert(path);
    }
}

/// Whether code uses a name, not a longer one.
bool uses(const std::string& code, std::string_view name) {
    const auto belongs = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    for (std::size_t at = code.find(name); at != std::string::npos; at = code.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        const bool starts = at == 0 || (!belongs(code[at - 1]) && code[at - 1] != ':');
        if (starts && (name.back() == ':' || end == code.size() || !belongs(code[end])))
            return true;
    }
    return false;
}

} // namespace

std::set<std::string> headersWithKnownNames() {
    std::set<std::string> all;
    for (const auto& [header, names] : known())
        all.emplace(header);
    return all;
}

std::map<std::string, std::string> hiddenIncludes(const std::string& file, const Files& files) {
    std::set<std::string> seen, brought;
    collect(file, files, seen, brought);
    std::map<std::string, std::string> hidden;
    for (const std::string& line : files.at(file)) {
        if (!included(line).first.empty())
            continue;
        const std::string code = line.substr(0, line.find("//"));
        for (const auto& [header, names] : known())
            for (const std::string_view name : names)
                if (uses(code, name) && brought.count(std::string(header)) == 0 && !bringsToo(brought, header))
                    hidden.emplace(header, name);
    }
    return hidden;
}

} // namespace supercircle::architecture
