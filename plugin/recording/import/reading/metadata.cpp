#include "plugin/recording/import/reading/metadata.h"

#include "plugin/recording/import/reading/quantity.h"
#include "plugin/recording/import/reading/text.h"

#include <algorithm>
#include <initializer_list>
#include <string>

namespace supercircle::importing {

namespace {

bool hasAny(const std::string& text, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return text.find(w) != std::string::npos; });
}

bool isAbout(const std::string& key, MetadataKey what) {
    switch (what) {
    case MetadataKey::Rate:
        return hasAny(key, {"rate", "frequen", "frequenz", "abtast"}) && !hasAny(key, {"strain", "load"});
    case MetadataKey::Speed:
        return hasAny(key, {"speed", "rate", "geschwindigkeit", "vitesse", "velocity", "velocidad", "velocita"});
    case MetadataKey::PeakForce:
        return hasAny(key, {"fmax", "f max", "f_max"}) ||
               (hasAny(key, {"max", "peak", "hochst"}) && hasAny(key, {"force", "load", "kraft", "fuerza", "forza"}));
    case MetadataKey::Width:
        return hasAny(key, {"width", "breite", "largeur", "larghezza", "ancho"});
    case MetadataKey::Thickness:
        return hasAny(key, {"thickness", "dicke", "epaisseur", "spessore", "espesor"});
    case MetadataKey::Rows:
        break;
    }
    return hasAny(key, {"points", "rows", "samples", "messpunkte", "messwerte"}) && !hasAny(key, {"rate", "per", "/"});
}

/// Number and unit of a value; the unit may stand in brackets behind the key.
bool takeApart(const HeaderEntry& m, double& value, std::string& unit) {
    std::string_view text = trimmed(m.value);
    const std::size_t end = std::min(text.find_first_not_of("0123456789.,+-"), text.size());
    const std::string_view digits = text.substr(0, end);
    unit = std::string(trimmed(text.substr(end)));
    if (unit.empty()) {
        const std::size_t from = m.key.find_first_of("[("), to = m.key.find_last_of("])");
        if (from != std::string::npos && to != std::string::npos && to > from)
            unit = m.key.substr(from + 1, to - from - 1);
    }
    // the mark of a header need not be that of the table; one mark is a decimal one
    const bool comma = digits.find(',') != std::string_view::npos && digits.find('.') == std::string_view::npos;
    return readCell(digits, {comma ? ',' : '.'}, value) == Cell::Number && value > 0.0;
}

/// Factor to SI, 0: no such unit.
double factorOf(const std::string& unit, MetadataKey what) {
    const std::string low = folded(unit);
    if (what == MetadataKey::Rate)
        return low == "hz" || low == "1/s" || low == "s-1" ? 1.0 : low == "khz" ? 1e3 : 0.0;
    if (what == MetadataKey::PeakForce)
        return unitOf(unit).measures == Quantity::Force ? unitOf(unit).factor : 0.0;
    if (what == MetadataKey::Width || what == MetadataKey::Thickness)
        return unitOf(unit).measures == Quantity::Displacement ? unitOf(unit).factor : 0.0;
    if (what == MetadataKey::Rows)
        return 1.0;
    const std::size_t slash = unit.find('/');
    if (slash == std::string::npos)
        return 0.0;
    const Unit length = unitOf(unit.substr(0, slash)), time = unitOf(unit.substr(slash + 1));
    return length.measures == Quantity::Displacement && time.measures == Quantity::Time ? length.factor / time.factor
                                                                                        : 0.0;
}

} // namespace

std::optional<MetadataValue> metadataValue(const std::vector<HeaderEntry>& metadata, MetadataKey what) {
    for (const HeaderEntry& m : metadata) {
        const std::string key = folded(m.key);
        double value = 0.0;
        std::string unit;
        if (!isAbout(key, what) || !takeApart(m, value, unit))
            continue;
        if (const double factor = factorOf(unit, what); factor > 0.0)
            return MetadataValue{value * factor, m.line, true};
        if (what == MetadataKey::Rate && unit.empty() && hasAny(key, {"sampl", "abtast"}))
            return MetadataValue{value, m.line, false};
    }
    return std::nullopt;
}

} // namespace supercircle::importing
