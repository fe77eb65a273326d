#include "plugin/recording/import/reading/units.h"

#include "plugin/recording/import/reading/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace supercircle::importing {

namespace {

/// Which letters of a unit may be capitals: any; any beside words that name the quantity ("force (n)", but n alone
/// counts, and mS is no time); or those that are written (mN is not MN, nm is not Nm).
enum class Case : std::uint8_t { Any, Named, Exact };

struct Known {
    const char* written;
    Quantity measures;
    double factor;
    Case letters = Case::Any;
};

constexpr double kPound = 4.4482216152605, kKilopond = 9.80665, kInch = 0.0254;

const std::vector<Known>& units() {
    static const std::vector<Known> kUnits = {{"s", Quantity::Time, 1.0},
                                              {"sec", Quantity::Time, 1.0},
                                              {"sek", Quantity::Time, 1.0},
                                              {"seg", Quantity::Time, 1.0},
                                              {"sekunde", Quantity::Time, 1.0},
                                              {"sekunden", Quantity::Time, 1.0},
                                              {"seconde", Quantity::Time, 1.0},
                                              {"segundo", Quantity::Time, 1.0},
                                              {"second", Quantity::Time, 1.0},
                                              {"secs", Quantity::Time, 1.0},
                                              {"ms", Quantity::Time, 1e-3, Case::Named},
                                              {"msec", Quantity::Time, 1e-3},
                                              {"us", Quantity::Time, 1e-6, Case::Named},
                                              {"min", Quantity::Time, 60.0},
                                              {"minute", Quantity::Time, 60.0},
                                              {"h", Quantity::Time, 3600.0},
                                              {"hr", Quantity::Time, 3600.0},
                                              {"d", Quantity::Time, 86400.0},
                                              {"day", Quantity::Time, 86400.0},
                                              {"mm", Quantity::Displacement, 1e-3},
                                              {"millimetre", Quantity::Displacement, 1e-3},
                                              {"millimeter", Quantity::Displacement, 1e-3},
                                              {"metre", Quantity::Displacement, 1.0},
                                              {"meter", Quantity::Displacement, 1.0},
                                              {"micrometre", Quantity::Displacement, 1e-6},
                                              {"micrometer", Quantity::Displacement, 1e-6},
                                              {"millisecond", Quantity::Time, 1e-3},
                                              {"hour", Quantity::Time, 3600.0},
                                              {"kilonewton", Quantity::Force, 1e3},
                                              {"millinewton", Quantity::Force, 1e-3},
                                              {"pound", Quantity::Force, kPound},
                                              {"radian", Quantity::Angle, 1.0},
                                              {"cm", Quantity::Displacement, 1e-2},
                                              {"m", Quantity::Displacement, 1.0, Case::Named},
                                              {"um", Quantity::Displacement, 1e-6, Case::Named},
                                              {"micron", Quantity::Displacement, 1e-6},
                                              {"nm", Quantity::Displacement, 1e-9, Case::Exact},
                                              {"in", Quantity::Displacement, kInch},
                                              {"inch", Quantity::Displacement, kInch},
                                              {"inche", Quantity::Displacement, kInch},
                                              {"\"", Quantity::Displacement, kInch},
                                              {"mil", Quantity::Displacement, 1e-3 * kInch},
                                              {"thou", Quantity::Displacement, 1e-3 * kInch},
                                              {"ft", Quantity::Displacement, 12.0 * kInch},
                                              {"mN", Quantity::Force, 1e-3, Case::Exact},
                                              {"MN", Quantity::Force, 1e6, Case::Exact},
                                              {"N", Quantity::Force, 1.0, Case::Named},
                                              {"newton", Quantity::Force, 1.0},
                                              {"kn", Quantity::Force, 1e3},
                                              {"un", Quantity::Force, 1e-6},
                                              {"cn", Quantity::Force, 1e-2},
                                              {"dn", Quantity::Force, 0.1},
                                              {"dan", Quantity::Force, 10.0},
                                              {"lbf", Quantity::Force, kPound},
                                              {"lb", Quantity::Force, kPound},
                                              {"klbf", Quantity::Force, 1e3 * kPound},
                                              {"kip", Quantity::Force, 1e3 * kPound},
                                              {"ozf", Quantity::Force, kPound / 16.0},
                                              {"kgf", Quantity::Force, kKilopond},
                                              {"kp", Quantity::Force, kKilopond},
                                              {"gf", Quantity::Force, 1e-3 * kKilopond},
                                              {"deg", Quantity::Angle, M_PI / 180.0},
                                              {"degree", Quantity::Angle, M_PI / 180.0},
                                              {"grad", Quantity::Angle, M_PI / 180.0},
                                              {"°", Quantity::Angle, M_PI / 180.0},
                                              {"rad", Quantity::Angle, 1.0},
                                              {"mrad", Quantity::Angle, 1e-3},
                                              {"rev", Quantity::Angle, 2.0 * M_PI},
                                              {"turns", Quantity::Angle, 2.0 * M_PI}};
    return kUnits;
}

/// Units in Cyrillic, folded.
constexpr std::array<std::pair<const char*, const char*>, 14> kTranslatedUnits = {{{"с", "s"},
                                                                                   {"сек", "s"},
                                                                                   {"мс", "ms"},
                                                                                   {"мин", "min"},
                                                                                   {"ч", "h"},
                                                                                   {"мм", "mm"},
                                                                                   {"см", "cm"},
                                                                                   {"м", "m"},
                                                                                   {"мкм", "um"},
                                                                                   {"н", "N"},
                                                                                   {"кн", "kN"},
                                                                                   {"кгс", "kgf"},
                                                                                   {"град", "deg"},
                                                                                   {"рад", "rad"}}};

/// "min:sec", "hours:minutes:seconds"
bool isClockFormat(std::string_view low) {
    constexpr std::array kParts = {"h", "hr",     "hour",    "hours", "m",    "min",    "mins",
                                   "s", "minute", "minutes", "sec",   "secs", "second", "seconds"};
    for (bool last = false; !last;) {
        const std::size_t colon = low.find(':');
        last = colon == std::string_view::npos;
        const std::string part(trimmed(low.substr(0, colon)));
        if (std::find(kParts.begin(), kParts.end(), part) == kParts.end())
            return false;
        low.remove_prefix(last ? low.size() : colon + 1);
    }
    return true;
}

/// Micro signs as u, letters as they are.
std::string withPlainMicro(std::string_view text) {
    std::string out(text);
    for (const char* micro : {"µ", "μ"})
        if (out.rfind(micro, 0) == 0)
            out.replace(0, std::string_view(micro).size(), "u");
    return out;
}

bool isWritten(const Known& k, const std::string& text, const std::string& low, Quantity named) {
    if (k.letters == Case::Any || (k.letters == Case::Named && named == k.measures))
        return low == folded(k.written);
    return text == k.written;
}

} // namespace

Unit unitFor(std::string_view text, Quantity named) {
    text = trimmed(text);
    while (text.size() > 1 &&
           (text.front() == '(' || text.front() == '[' || text.front() == '<' || text.front() == '{'))
        text = trimmed(text.substr(1));
    while (text.size() > 1 &&
           (text.back() == ')' || text.back() == ']' || text.back() == '>' || text.back() == '}' || text.back() == '.'))
        text = trimmed(text.substr(0, text.size() - 1));
    const std::string low = folded(text);
    for (const auto& [cyrillic, latin] : kTranslatedUnits)
        if (low == cyrillic) {
            Unit unit = unitOf(latin);
            unit.name = std::string(text);
            return unit;
        }
    if (low.find(':') != std::string::npos &&
        (low.find_first_not_of("hms:.0fdyt ") == std::string::npos || isClockFormat(low)))
        return {"s", Quantity::Time, 1.0}; // hh:mm:ss is read as seconds
    const bool plural = low.size() > 2 && low.back() == 's';
    const std::string plain = withPlainMicro(text);
    for (const std::string& word : {low, plural ? low.substr(0, low.size() - 1) : low})
        for (const Known& k : units())
            if (isWritten(k, plain, word, named))
                return {std::string(text), k.measures, k.factor};
    if (const std::size_t slash = text.find('/'); slash != std::string_view::npos && slash > 0) {
        const Unit way = unitOf(text.substr(0, slash)), time = unitOf(text.substr(slash + 1));
        if (way.measures == Quantity::Displacement && time.measures == Quantity::Time)
            return {std::string(text), Quantity::Velocity, way.factor / time.factor};
        if (way.measures == Quantity::Angle && time.measures == Quantity::Time)
            return {std::string(text), Quantity::AngularVelocity, way.factor / time.factor};
    }
    if (const std::size_t mark = text.find_first_of("-_ "); mark != std::string_view::npos && low.back() == 'f')
        if (Unit force = unitFor(std::string(text.substr(0, mark)) + std::string(text.substr(mark + 1)), named);
            force.measures == Quantity::Force) { // "lb-f"
            force.name = std::string(text);
            return force;
        }
    return {};
}

Unit unitOf(std::string_view text) {
    return unitFor(text, Quantity::None);
}

bool isUnit(std::string_view text) {
    return unitFor(text, Quantity::Time).measures != Quantity::None ||
           unitFor(text, Quantity::Displacement).measures != Quantity::None ||
           unitFor(text, Quantity::Force).measures != Quantity::None;
}

Unit usualUnit(Quantity quantity) {
    switch (quantity) {
    case Quantity::Time:
        return unitOf("s");
    case Quantity::Force:
        return unitOf("N");
    case Quantity::Angle:
        return unitOf("deg");
    case Quantity::Displacement:
    case Quantity::MarkerX:
    case Quantity::MarkerY:
        return unitOf("mm");
    case Quantity::Velocity:
        return unitOf("mm/s");
    case Quantity::AngularVelocity:
        return unitOf("deg/s");
    case Quantity::Counter:
    case Quantity::None:
        break;
    }
    return {};
}

} // namespace supercircle::importing
