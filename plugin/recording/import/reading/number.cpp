#include "plugin/recording/import/reading/number.h"

#include "plugin/recording/import/reading/text.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

namespace supercircle::importing {

namespace {

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

/// The text with a plain minus sign and every kind of group mark that is no '.' or ',' as an apostrophe.
std::string plain(std::string_view text) {
    constexpr std::array<std::pair<std::string_view, char>, 6> kMarks = {{{"\xE2\x88\x92", '-'},
                                                                          {"\xE2\x80\x93", '-'},
                                                                          {"\xC2\xA0", '\''},
                                                                          {"\xE2\x80\xAF", '\''},
                                                                          {"\xE2\x80\x99", '\''},
                                                                          {" ", '\''}}};
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto found = std::find_if(kMarks.begin(), kMarks.end(),
                                        [&](const auto& m) { return text.substr(i, m.first.size()) == m.first; });
        out += found != kMarks.end() ? found->second : text[i];
        i += found != kMarks.end() ? found->first.size() : 1;
    }
    return out;
}

/// Takes marks between groups of three digits out of the whole part; false if they stand elsewhere.
bool ungroup(std::string& text, char decimal, bool& grouped) {
    const std::size_t begin = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    const std::size_t end = std::min({text.find(decimal), text.find_first_of("eE"), text.size()});
    char mark = 0;
    std::size_t digits = 0, groups = 0;
    std::string whole = text.substr(0, begin);
    for (std::size_t i = begin; i < end; ++i) {
        if (isDigit(text[i])) {
            ++digits;
            whole += text[i];
            continue;
        }
        const bool first = groups == 0;
        if ((text[i] != '\'' && text[i] != '.' && text[i] != ',') || (mark != 0 && text[i] != mark) ||
            (first ? digits == 0 || digits > 3 || text[begin] == '0' : digits != 3))
            return false;
        mark = text[i];
        digits = 0;
        ++groups;
    }
    if (groups > 0 && digits != 3)
        return false;
    grouped = groups > 0;
    text = whole + text.substr(end);
    return true;
}

/// Nothing, a word for it, or what a sensor beyond its range gives.
bool isMissing(std::string_view cell) {
    static const std::vector<std::string> kWords = {"",     "nan",      "n/a",       "na",      "#n/a", "null",
                                                    "none", "n.a.",     "#nv",       "over",    "ovr",  "ol",
                                                    "ovfl", "overload", "overrange", "overflow"};
    if (cell.find_first_not_of("-*#?") == std::string_view::npos)
        return true; // "---", "****"
    const std::string word = folded(cell);
    return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

/// Takes "AM", "p.m.", "Z" or "+02:00" off the end of a clock. Hours to add; the twelfth hour of half a day is its
/// first.
double takeEnd(std::string_view& text, bool& halfDays) {
    std::string letters;
    std::size_t end = text.size();
    while (end > 0 && (std::isalpha(static_cast<unsigned char>(text[end - 1])) != 0 || text[end - 1] == '.'))
        --end;
    for (const char c : text.substr(end))
        letters += c == '.' ? "" : std::string(1, static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    halfDays = letters == "am" || letters == "pm";
    if (halfDays || letters == "z")
        text = trimmed(text.substr(0, end));
    const std::size_t date = text.find('T'), zone = text.find_last_of("+-");
    if (date != std::string_view::npos && zone != std::string_view::npos && zone > date)
        text = text.substr(0, zone);
    return letters == "pm" ? 12.0 : 0.0;
}

/// Two or three parts: minutes and seconds, or hours before them. A date may stand in front.
bool readClock(std::string_view text, char decimal, double& value) {
    bool halfDays = false;
    const double later = takeEnd(text, halfDays);
    const std::size_t date = text.find_last_of(" T");
    if (date != std::string_view::npos && text.find_first_not_of("0123456789-./") == date)
        text.remove_prefix(date + 1);
    double seconds = 0.0;
    int parts = 0;
    while (true) {
        const std::size_t end = std::min(text.find(':'), text.size());
        std::string part(text.substr(0, end));
        std::replace(part.begin(), part.end(), decimal, '.');
        double v = 0.0;
        if (part.empty() || !isDigit(part[0]) || !record::parseNumber(part, v))
            return false;
        seconds = 60.0 * seconds + v;
        ++parts;
        if (end == text.size())
            break;
        text.remove_prefix(end + 1);
    }
    value = halfDays ? std::fmod(seconds, 43200.0) + 3600.0 * later : seconds;
    return parts == 2 || parts == 3;
}

} // namespace

Cell readCell(std::string_view cell, const NumberStyle& style, double& value, bool* grouped) {
    cell = trimmed(cell);
    if (cell.empty() || (!isDigit(cell.back()) && isMissing(cell))) // no word for "missing" ends with a digit
        return Cell::Missing;
    const char first = cell.front();
    const bool likely =
        isDigit(first) || first == '-' || first == '+' || first == '.' || first == ',' || first == '\xE2';
    if (!likely)
        return Cell::Text;
    if (cell.find(':') != std::string_view::npos)
        return readClock(cell, style.decimal, value) ? Cell::Number : Cell::Text;
    std::string text;
    const std::string_view usual = style.decimal == '.' ? "0123456789.+-eE" : "0123456789,+-eE";
    if (cell.find_first_not_of(usual) == std::string_view::npos) {
        text = cell; // quickly
        std::replace(text.begin(), text.end(), style.decimal, '.');
    } else {
        text = plain(cell);
        bool groups = false;
        if (!ungroup(text, style.decimal, groups))
            return Cell::Text;
        if (groups && grouped != nullptr)
            *grouped = true;
        std::replace(text.begin(), text.end(), style.decimal, '.');
    }
    if (!text.empty() && text[0] == '.')
        text.insert(0, 1, '0');
    if (text.size() > 1 && text[0] == '-' && text[1] == '.')
        text.insert(1, 1, '0');
    return record::parseNumber(text, value) && std::isfinite(value) ? Cell::Number : Cell::Text;
}

} // namespace supercircle::importing
