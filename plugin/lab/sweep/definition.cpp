#include "plugin/lab/sweep/definition.h"

#include "plugin/recording/table/text.h"

#include <algorithm>
#include <charconv>

namespace supercircle::sweep {

namespace {

/// A whole number from 0; the whole of `text`.
std::optional<std::int64_t> whole(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 0)
        return std::nullopt;
    return value;
}

} // namespace

std::vector<ParameterValue> SweepDefinition::parameterValues(std::size_t set) const {
    std::vector<ParameterValue> all = fixed;
    for (std::size_t i = 0; i < names.size(); ++i)
        all.emplace_back(names[i], sets[set][i]);
    return all;
}

std::vector<Task> tasks(const SweepDefinition& sweep, const Shard& shard) {
    std::vector<Task> all;
    std::size_t index = 0;
    for (const std::int64_t seed : sweep.seeds)
        for (std::size_t set = 0; set < sweep.sets.size(); ++set)
            if (index++ % static_cast<std::size_t>(shard.parts) == static_cast<std::size_t>(shard.part - 1))
                all.push_back({set, seed});
    return all;
}

std::string keyOf(const std::vector<ParameterValue>& values) {
    std::vector<ParameterValue> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    std::string key;
    for (const auto& [name, value] : sorted) {
        key += (key.empty() ? "" : " ") + name + "=";
        record::appendNumber(key, value);
    }
    return key;
}

std::vector<std::int64_t> parseSeeds(const std::string& text) {
    std::vector<std::int64_t> seeds;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(',', from), text.size());
        const std::string_view part = std::string_view(text).substr(from, to - from);
        const std::size_t colon = std::min(part.find(':'), part.size());
        const auto first = whole(part.substr(0, colon));
        const auto last = colon < part.size() ? whole(part.substr(colon + 1)) : first;
        if (!first || !last || *last < *first || *last - *first >= static_cast<std::int64_t>(maxRuns))
            return {};
        for (std::int64_t seed = *first; seed <= *last; ++seed)
            seeds.push_back(seed);
        from = to + 1;
    }
    std::sort(seeds.begin(), seeds.end());
    seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
    return seeds;
}

std::optional<Shard> parseShard(const std::string& text) {
    const std::size_t slash = text.find('/');
    if (slash == std::string::npos)
        return std::nullopt;
    const auto part = whole(std::string_view(text).substr(0, slash));
    const auto parts = whole(std::string_view(text).substr(slash + 1));
    if (!part || !parts || *part < 1 || *part > *parts || *parts > 100'000)
        return std::nullopt;
    return Shard{static_cast<int>(*part), static_cast<int>(*parts)};
}

} // namespace supercircle::sweep
