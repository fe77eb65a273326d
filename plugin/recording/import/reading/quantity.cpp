#include "plugin/recording/import/reading/quantity.h"

#include "plugin/recording/import/reading/text.h"
#include "plugin/recording/import/reading/units.h"

#include <algorithm>
#include <array>

namespace supercircle::importing {

namespace {

struct Word {
    const char* stem; ///< folded; a word of the heading begins with it
    Quantity quantity;
    int rank;
};

/// English, German, French, Spanish, Italian. A higher rank is the better channel: of "crosshead position" and
/// "compressive displacement" the latter.
constexpr std::array kWords = {Word{"time", Quantity::Time, 5},
                               Word{"zeit", Quantity::Time, 5},
                               Word{"prufzeit", Quantity::Time, 6},
                               Word{"temps", Quantity::Time, 5},
                               Word{"tiempo", Quantity::Time, 5},
                               Word{"tempo", Quantity::Time, 5},
                               Word{"elapsed", Quantity::Time, 4},
                               Word{"clock", Quantity::Time, 3},
                               Word{"t", Quantity::Time, 1},
                               Word{"displacement", Quantity::Displacement, 6},
                               Word{"displ", Quantity::Displacement, 5},
                               Word{"disp", Quantity::Displacement, 5},
                               Word{"extension", Quantity::Displacement, 5},
                               Word{"crosshead", Quantity::Displacement, 4},
                               Word{"stroke", Quantity::Displacement, 5},
                               Word{"travel", Quantity::Displacement, 5},
                               Word{"position", Quantity::Displacement, 4},
                               Word{"indentation", Quantity::Displacement, 5},
                               Word{"deflection", Quantity::Displacement, 5},
                               Word{"draw", Quantity::Displacement, 2},
                               Word{"actuator", Quantity::Displacement, 3},
                               Word{"weg", Quantity::Displacement, 6},
                               Word{"standardweg", Quantity::Displacement, 6},
                               Word{"traverse", Quantity::Displacement, 5},
                               Word{"verschiebung", Quantity::Displacement, 5},
                               Word{"verformung", Quantity::Displacement, 5},
                               Word{"hub", Quantity::Displacement, 4},
                               Word{"deplacement", Quantity::Displacement, 6},
                               Word{"course", Quantity::Displacement, 5},
                               Word{"desplazamiento", Quantity::Displacement, 6},
                               Word{"spostamento", Quantity::Displacement, 6},
                               Word{"corsa", Quantity::Displacement, 5},
                               Word{"deformation", Quantity::Displacement, 4},
                               Word{"elongation", Quantity::Displacement, 5},
                               Word{"allongement", Quantity::Displacement, 5},
                               Word{"distance", Quantity::Displacement, 5},
                               Word{"compression", Quantity::Displacement, 3},
                               Word{"depth", Quantity::Displacement, 4},
                               Word{"ext", Quantity::Displacement, 3},
                               Word{"pos", Quantity::Displacement, 3},
                               Word{"gap", Quantity::Displacement, 3},
                               Word{"lvdt", Quantity::Displacement, 4},
                               Word{"force", Quantity::Force, 6},
                               Word{"effort", Quantity::Force, 5},
                               Word{"load", Quantity::Force, 6},
                               Word{"kraft", Quantity::Force, 6},
                               Word{"standardkraft", Quantity::Force, 7},
                               Word{"prufkraft", Quantity::Force, 7},
                               Word{"last", Quantity::Force, 4},
                               Word{"charge", Quantity::Force, 5},
                               Word{"fuerza", Quantity::Force, 6},
                               Word{"carga", Quantity::Force, 5},
                               Word{"forza", Quantity::Force, 6},
                               Word{"carico", Quantity::Force, 5},
                               Word{"f", Quantity::Force, 1},
                               Word{"angle", Quantity::Angle, 6},
                               Word{"winkel", Quantity::Angle, 6},
                               Word{"rotation", Quantity::Angle, 5},
                               Word{"theta", Quantity::Angle, 5},
                               Word{"phi", Quantity::Angle, 4},
                               Word{"encoder", Quantity::Angle, 3},
                               Word{"pendulum", Quantity::Angle, 3}};

/// Words in other alphabets, folded, as one of kWords; their first letters suffice. Longer ones stand first.
constexpr std::array<std::pair<const char*, const char*>, 21> kTranslated = {
    {{"время", "time"},          {"перемещ", "displacement"},
     {"смещен", "displacement"}, {"деформац", "deformation"},
     {"удлинен", "elongation"},  {"ход", "stroke"},
     {"прогиб", "deflection"},   {"нагруз", "load"},
     {"усили", "force"},         {"сила", "force"},
     {"угол", "angle"},          {"скорость", "speed"},
     {"напряж", "stress"},       {"時間", "time"},
     {"変位", "displacement"},   {"ストローク", "stroke"},
     {"荷重", "load"},           {"試験力", "force"},
     {"角度", "angle"},          {"応力", "stress"},
     {"ひずみ", "strain"}}};
/// With the words of other alphabets as words of kWords, blanks around them.
std::string translated(std::string folded) {
    for (const auto& [word, english] : kTranslated)
        for (std::size_t at = folded.find(word); at != std::string::npos; at = folded.find(word))
            folded.replace(at, std::string_view(word).size(), " " + std::string(english) + " ");
    return folded;
}

/// Names of a column that numbers the rows.
constexpr std::array kCounters = {"index", "point",  "points", "nr",    "no",        "row",        "rows",
                                  "step",  "sample", "count",  "frame", "messpunkt", "datenpunkt", "punkt"};

/// What makes a column another thing than its words suggest: rates, moduli, set points, maxima.
constexpr std::array kOther = {
    "rate",    "speed",          "velocity",    "geschwindigkeit", "vitesse", "angvel",      "acceleration",
    "accel",   "beschleunigung", "modulus",     "modul",           "stress",  "strain",      "spannung",
    "dehnung", "cycle",          "cycles",      "zyklen",          "zyklus",  "temperature", "temperatur",
    "status",  "stamp",          "contrainte",  "esfuerzo",        "sforzo",  "torque",      "moment",
    "moments", "drehmoment",     "biegemoment", "torsionsmoment",  "momento", "couple",      "coppia"};
/// Of these, what a clock may be named after: "time stamp", "cycle time".
constexpr std::array kOfClocks = {"stamp", "cycle", "zyklus"};
constexpr std::array kClocks = {"time", "zeit", "temps", "tiempo", "tempo"};
/// Less direct measurements of the same quantity.
constexpr std::array kSecond = {"set", "target", "demand",    "soll",      "command",      "max",
                                "min", "peak",   "corrected", "total",     "extensometer", "video",
                                "day", "date",   "datum",     "tageszeit", "uhrzeit"};

std::vector<std::string> wordsOf(const std::string& folded) {
    std::vector<std::string> words(1);
    for (const char c : folded)
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
            words.back() += c;
        else if (!words.back().empty())
            words.emplace_back();
    if (words.back().empty())
        words.pop_back();
    return words;
}

template <class Words>
bool has(const Words& list, const std::string& word) {
    return std::any_of(list.begin(), list.end(), [&](const char* w) { return word == w; });
}

/// "traversengeschwindigkeit"; only long words, for compounds.
bool endsWithOther(const std::string& word) {
    return std::any_of(kOther.begin(), kOther.end(), [&](const char* w) {
        const std::string other = w;
        return other.size() >= 7 && word.size() > other.size() + 2 &&
               word.compare(word.size() - other.size(), other.size(), other) == 0;
    });
}

/// @param measured by the unit: among words that contradict each other it decides; None: it is not known
void findQuantity(const std::vector<std::string>& words, Quantity measured, Heading& h) {
    int penalty = 0;
    const bool clock = (measured == Quantity::None || measured == Quantity::Time) &&
                       std::any_of(words.begin(), words.end(), [](const std::string& w) { return has(kClocks, w); });
    for (const std::string& word : words) {
        if (clock && has(kOfClocks, word)) {
            penalty += 2;
            continue;
        }
        if (has(kOther, word) || endsWithOther(word)) {
            h.other = true;
            return;
        }
        penalty += has(kSecond, word) ? 2 : 0;
    }
    bool agrees = false; // "extension from preload (mm)" is no load
    for (const std::string& word : words)
        for (const Word& known : kWords) {
            const std::string stem = known.stem;
            const bool fits = stem.size() < 4 ? word == stem
                                              : word.rfind(stem, 0) == 0 ||
                                                    (word.size() > stem.size() + 2 &&
                                                     word.compare(word.size() - stem.size(), stem.size(), stem) == 0);
            const bool same = known.quantity == measured;
            if (fits && (same || !agrees) && (10 * known.rank > h.rank || (same && !agrees))) {
                h.quantity = known.quantity;
                h.rank = 10 * known.rank;
                agrees = same;
            }
        }
    if (h.quantity != Quantity::None)
        h.rank = std::max(1, h.rank - 10 * penalty - static_cast<int>(words.size()));
}

/// "m0_x_mm", "Marker 1 X", "P3.y": a name and an axis.
void findMarker(const std::vector<std::string>& words, Heading& h) {
    if (words.size() < 2 || h.quantity == Quantity::Force || h.quantity == Quantity::Time)
        return;
    for (std::size_t i = 1; i < words.size(); ++i) {
        if (words[i] != "x" && words[i] != "y")
            continue;
        for (std::size_t k = 0; k < i; ++k)
            h.marker += words[k];
        h.quantity = words[i] == "x" ? Quantity::MarkerX : Quantity::MarkerY;
        h.rank = 50;
        return;
    }
}

bool isVelocity(Quantity q) {
    return q == Quantity::Velocity || q == Quantity::AngularVelocity;
}

constexpr std::array kBrackets = {std::pair{'(', ')'}, std::pair{'[', ']'}, std::pair{'<', '>'}, std::pair{'{', '}'}};

/// The unit among the brackets of a name, "Weg (Traverse) [mm]", which is taken out of it: the last one, of those that
/// fit the words if there are such. Two that fit and differ are both returned, and are no unit.
std::string bracketedUnit(std::string& text) {
    struct Group {
        std::size_t from, to;
        std::string unit;
    };
    std::vector<Group> groups;
    std::string outside;
    std::size_t end = 0;
    for (std::size_t from = 0; from < text.size(); ++from)
        for (const auto& [open, close] : kBrackets) {
            const std::size_t to = text[from] == open ? text.find(close, from) : std::string::npos;
            if (to == std::string::npos)
                continue;
            outside += from >= end ? text.substr(end, from - end) + " " : "";
            end = std::max(end, to + 1);
            if (std::string unit = text.substr(from + 1, to - from - 1); isUnit(unit))
                groups.push_back({from, to, std::move(unit)});
        }
    if (groups.empty())
        return {};
    Heading said;
    findQuantity(wordsOf(translated(folded(outside + text.substr(end)))), Quantity::None, said);
    std::vector<Group> fitting;
    for (const Group& g : groups)
        if (said.quantity != Quantity::None && unitFor(g.unit, said.quantity).measures == said.quantity)
            fitting.push_back(g);
    const Group best = fitting.empty() ? groups.back() : fitting.back();
    text = text.substr(0, best.from) + " " + text.substr(best.to + 1);
    for (const Group& g : fitting)
        if (unitFor(g.unit, said.quantity).factor != unitFor(best.unit, said.quantity).factor)
            return g.unit + " and " + best.unit;
    return best.unit;
}

/// The unit in "Weg in mm", "force/kN", "force_N", "Force, kN"; the name is shortened to what is left.
std::string unitAtEnd(std::string& text) {
    const std::size_t at = text.find_last_of("/_, ");
    if (at == std::string::npos || at == 0)
        return {};
    const std::string last = text.substr(at + 1);
    if (text.size() > 3 && at >= 3 && text.compare(at - 3, 4, " of ") == 0)
        return {}; // "time of day"
    if (const std::size_t before = text.find_last_of("/_, ", at - 1); before != std::string::npos && before > 0) {
        const std::string two = text.substr(before + 1), rate = two.substr(0, at - before - 1) + "/" + last;
        const bool velocity = isVelocity(unitOf(rate).measures); // "velocity_mm_s"
        if (velocity || isUnit(two)) {                           // "load_lb_f"
            text = text.substr(0, before);
            return velocity ? rate : two;
        }
    }
    const bool announced = at > 3 && text.compare(at - 3, 4, " in ") == 0; // "Kraft in %"
    if (!isUnit(last) && !announced)
        return {};
    text = text.substr(0, at);
    if (text.size() > 3 && text.compare(text.size() - 3, 3, " in") == 0)
        text.resize(text.size() - 3);
    return last;
}

/// The unit in "Force (kN)", "Load [N]", "Weg in mm", "force/kN", "force_N", "Force, kN"; the name is shortened to what
/// is left.
std::string unitInName(std::string& text) {
    if (std::string unit = bracketedUnit(text); !unit.empty())
        return unit;
    constexpr std::string_view kClosing = ")]>}";
    const bool remark = !text.empty() && kClosing.find(text.back()) != std::string_view::npos;
    if (std::string unit = remark ? std::string() : unitAtEnd(text); !unit.empty())
        return unit;
    for (const auto& [open, close] : kBrackets) { // what stands in the place of the unit
        const std::size_t to = text.rfind(close), from = text.rfind(open, to);
        if (to == std::string::npos || from == std::string::npos)
            continue;
        const std::string unit = text.substr(from + 1, to - from - 1);
        text = text.substr(0, from) + text.substr(to + 1);
        return unit;
    }
    return remark ? unitAtEnd(text) : std::string();
}

bool fits(Quantity quantity, const Unit& unit) {
    const bool length = quantity == Quantity::MarkerX || quantity == Quantity::MarkerY;
    return unit.measures == (length ? Quantity::Displacement : quantity);
}

} // namespace

const char* name(Quantity q) {
    switch (q) {
    case Quantity::Time:
        return "time";
    case Quantity::Displacement:
        return "displacement";
    case Quantity::Force:
        return "force";
    case Quantity::Angle:
        return "angle";
    case Quantity::MarkerX:
        return "marker x";
    case Quantity::MarkerY:
        return "marker y";
    case Quantity::Counter:
        return "number of the row";
    case Quantity::Velocity:
        return "velocity";
    case Quantity::AngularVelocity:
        return "angular velocity";
    case Quantity::None:
        break;
    }
    return "not used";
}

Heading headingOf(std::string_view columnName, std::string_view unitCell) {
    Heading h;
    h.text = std::string(trimmed(columnName));
    std::string text = h.text;
    const std::string named = unitInName(text);
    std::string unit = named;
    if (!trimmed(unitCell).empty())
        unit = std::string(trimmed(unitCell));
    h.unit = unitOf(unit);
    if (isVelocity(h.unit.measures)) {
        h.quantity = h.unit.measures;
        h.unitStated = true;
        h.rank = 5;
        return h;
    }
    const std::vector<std::string> words = wordsOf(translated(folded(text)));
    findQuantity(words, h.unit.measures, h);
    findMarker(words, h);
    if (h.unit.measures == Quantity::None && h.quantity != Quantity::None)
        h.unit = unitFor(unit, h.marker.empty() ? h.quantity : Quantity::Displacement);
    // a heading that says nothing but a unit still says what is measured
    if (h.quantity == Quantity::None && words.empty() && h.unit.measures != Quantity::None) {
        h.quantity = h.unit.measures;
        h.rank = 5;
    }
    if (const Unit own = unitOf(text);
        h.quantity == Quantity::None && words.size() == 1 && own.measures != Quantity::None && unit.empty()) {
        h.quantity = own.measures;
        h.unit = own;
        h.rank = 5;
    }
    if (h.quantity == Quantity::None && words == std::vector<std::string>{"x", "value"} &&
        (unit.empty() || h.unit.measures == Quantity::Time)) { // LabVIEW's name of its clock
        h.quantity = Quantity::Time;
        h.rank = 1;
    }
    // a letter of a formula ("s in mm" is a way in German) is what its unit says
    if (h.quantity == Quantity::None && words.size() == 1 && words[0].size() == 1 && !unit.empty() &&
        h.unit.measures != Quantity::None) {
        h.quantity = h.unit.measures;
        h.rank = 3;
    }
    if (h.quantity == Quantity::None && !words.empty() && words.size() <= 2 && has(kCounters, words[0]) &&
        unit.empty()) {
        h.quantity = Quantity::Counter;
        h.rank = 1;
    }
    if (h.quantity == Quantity::Counter)
        return h;
    h.unitStated = h.unit.measures != Quantity::None;
    if (!unit.empty() && (h.quantity == Quantity::None ? !h.unitStated : !fits(h.quantity, h.unit)))
        h.unknownUnit = unit;
    if (const Unit other = unitOf(named);
        h.unitStated && other.measures == h.unit.measures && other.factor != h.unit.factor) {
        h.unknownUnit = named + " and " + unit; // in the name, and on the line of units
        h.twoUnits = true;
    }
    if (h.quantity != Quantity::None && !fits(h.quantity, h.unit)) {
        h.unit = usualUnit(h.quantity);
        h.unitStated = false;
    }
    return h;
}

} // namespace supercircle::importing
