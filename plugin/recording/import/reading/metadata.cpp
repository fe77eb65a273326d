#include "plugin/recording/import/reading/metadata.h"

#include "plugin/recording/import/reading/quantity.h"
#include "plugin/recording/import/reading/text.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <string>

namespace supercircle::importing {

namespace {

bool hasAny(const std::string& text, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return text.find(w) != std::string::npos; });
}

/// A word of the text begins with one of these.
bool hasWordOf(const std::string& text, std::initializer_list<const char*> stems) {
    return std::any_of(stems.begin(), stems.end(), [&](const char* stem) {
        for (std::size_t at = text.find(stem); at != std::string::npos; at = text.find(stem, at + 1))
            if (at == 0 || text[at - 1] < 'a' || text[at - 1] > 'z')
                return true;
        return false;
    });
}

/// Speeds before and after the test, and bounds of them.
bool isOtherPhase(const std::string& key) {
    return hasWordOf(key, {"vorkraft", "vorlast",   "preload",  "pre-load", "pretest",  "pre-test", "pre test",
                           "post",     "return",    "ruck",     "zuruck",   "retour",   "retorno",  "ritorno",
                           "approach", "anfahr",    "jog",      "eil",      "position", "unload",   "entlast",
                           "zero",     "nullpunkt", "einricht", "precarg",  "precaric", "precharg", "max"});
}

bool isOfTheTest(const std::string& key) {
    return hasAny(key, {"test speed", "testing speed", "test rate", "test velocity", "testspeed", "test_speed",
                        "prufgeschwindigkeit", "versuchsgeschwindigkeit", "vitesse d'essai", "vitesse de l'essai",
                        "velocidad de ensayo", "velocita di prova"});
}

/// Of what holds the specimen.
bool isOfTheMachine(const std::string& key) {
    return hasWordOf(key, {"grip", "jaw", "clamp", "anvil", "roller", "support", "punch", "spann", "backe", "klemm",
                           "auflage", "stempel", "mors", "machoire", "mordaza", "ganasc", "fixture", "platen"});
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
        return hasAny(key, {"width", "breite", "largeur", "larghezza", "ancho"}) && !isOfTheMachine(key);
    case MetadataKey::Thickness:
        return hasAny(key, {"thickness", "dicke", "epaisseur", "spessore", "espesor"}) && !isOfTheMachine(key);
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

/// All entries with this metadata.
std::vector<StatedValue> allOf(const std::vector<HeaderEntry>& metadata, MetadataKey what) {
    std::vector<StatedValue> found;
    for (const HeaderEntry& m : metadata) {
        const std::string key = folded(m.key);
        double value = 0.0;
        std::string unit;
        if (!isAbout(key, what) || !takeApart(m, value, unit))
            continue;
        if (const double factor = factorOf(unit, what); factor > 0.0)
            found.push_back({{value * factor, m.line, true}, m.key});
        else if (what == MetadataKey::Rate && unit.empty() && hasAny(key, {"sampl", "abtast"}))
            found.push_back({{value, m.line, false}, m.key});
    }
    return found;
}

template <class Keep>
std::vector<StatedValue> only(const std::vector<StatedValue>& all, const Keep& keep) {
    std::vector<StatedValue> kept;
    std::copy_if(all.begin(), all.end(), std::back_inserter(kept),
                 [&](const StatedValue& s) { return keep(folded(s.key)); });
    return kept;
}

bool agree(const std::vector<StatedValue>& all) {
    return std::all_of(all.begin(), all.end(), [&](const StatedValue& s) {
        return std::abs(s.value.value - all.front().value.value) < 1e-6 * s.value.value;
    });
}

/// Those that may be the speed of the test: they are named so, else those of no other phase.
std::vector<StatedValue> testSpeeds(const std::vector<HeaderEntry>& metadata) {
    const std::vector<StatedValue> all = allOf(metadata, MetadataKey::Speed),
                                   here = only(all, [](const std::string&key) { return !isOtherPhase(key); }),
                                   named = only(here, isOfTheTest);
    return !named.empty() ? named : here;
}

} // namespace

std::optional<MetadataValue> metadataValue(const std::vector<HeaderEntry>& metadata, MetadataKey what) {
    const std::vector<StatedValue> found = what == MetadataKey::Speed ? testSpeeds(metadata) : allOf(metadata, what);
    if (found.empty() || (what == MetadataKey::Speed && !agree(found)))
        return std::nullopt;
    return found.front().value;
}

std::vector<StatedValue> unclearSpeeds(const std::vector<HeaderEntry>& metadata) {
    const std::vector<StatedValue> found = testSpeeds(metadata);
    if (found.empty())
        return allOf(metadata, MetadataKey::Speed);
    return agree(found) ? std::vector<StatedValue>() : found;
}

} // namespace supercircle::importing
