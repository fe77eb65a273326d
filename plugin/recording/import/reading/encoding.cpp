#include "plugin/recording/import/reading/encoding.h"

#include "plugin/recording/table/shift_jis.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace supercircle::importing {

namespace {

/// Characters 0x80 to 0x9F; 0: not used.
constexpr std::array<std::uint16_t, 32> kWestern = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                    0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                    0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                    0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};
/// Characters 0x80 to 0xBF.
constexpr std::array<std::uint16_t, 64> kCyrillic = {
    0x0402, 0x0403, 0x201A, 0x0453, 0x201E, 0x2026, 0x2020, 0x2021, 0x20AC, 0x2030, 0x0409, 0x2039, 0x040A,
    0x040C, 0x040B, 0x040F, 0x0452, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014, 0,      0x2122,
    0x0459, 0x203A, 0x045A, 0x045C, 0x045B, 0x045F, 0x00A0, 0x040E, 0x045E, 0x0408, 0x00A4, 0x0490, 0x00A6,
    0x00A7, 0x0401, 0x00A9, 0x0404, 0x00AB, 0x00AC, 0x00AD, 0x00AE, 0x0407, 0x00B0, 0x00B1, 0x0406, 0x0456,
    0x0491, 0x00B5, 0x00B6, 0x00B7, 0x0451, 0x2116, 0x0454, 0x00BB, 0x0458, 0x0405, 0x0455, 0x0457};

unsigned byteAt(std::string_view bytes, std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
}

bool isLatin(unsigned c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool isLead(unsigned c) {
    return (c >= 0x81 && c <= 0x9F) || (c >= 0xE0 && c <= 0xFC);
}

bool isTrail(unsigned c) {
    return (c >= 0x40 && c <= 0x7E) || (c >= 0x80 && c <= 0xFC);
}

/// Signs that stand alone in Western and Cyrillic texts alike: NBSP, §, «, °, ±, µ, ·, ».
bool isSign(unsigned c) {
    return c == 0xA0 || c == 0xA7 || c == 0xAB || c == 0xB0 || c == 0xB1 || c == 0xB5 || c == 0xB7 || c == 0xBB;
}

/// Logarithms to base 10 of what the bytes from `begin` to `end`, all beyond ASCII, cost in each encoding.
double western(std::string_view bytes, std::size_t begin, std::size_t end) {
    const std::size_t length = end - begin;
    const bool inWord = (begin > 0 && isLatin(byteAt(bytes, begin - 1))) || isLatin(byteAt(bytes, end));
    double cost = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
        const unsigned c = byteAt(bytes, i);
        const bool none = c < 0xA0 && kWestern[c - 0x80] == 0;
        cost += none          ? 3.0
                : isSign(c)   ? 0.0
                : length >= 3 ? 1.0 // no language writes three accents in a row
                : length == 2 ? (inWord ? 0.3 : 0.5)
                : c < 0xA0    ? 0.3
                              : 0.0;
    }
    return cost;
}

double cyrillic(std::string_view bytes, std::size_t begin, std::size_t end) {
    const bool inWord = (begin > 0 && isLatin(byteAt(bytes, begin - 1))) || isLatin(byteAt(bytes, end));
    double cost = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
        const unsigned c = byteAt(bytes, i);
        const bool letter = c >= 0xC0 || c == 0xA8 || c == 0xB8, capital = c >= 0xC0 && c < 0xE0;
        const bool turns = capital && i > begin && byteAt(bytes, i - 1) >= 0xE0; // "дЕ"
        cost += c == 0x98   ? 3.0
                : isSign(c) ? 0.0
                : !letter   ? 1.0
                : inWord    ? 1.0 // two scripts in one word
                            : (end - begin == 1 ? 0.3 : 0.0) + (turns ? 1.0 : 0.0);
    }
    return cost;
}

double japanese(std::string_view bytes, std::size_t& i) {
    const unsigned c = byteAt(bytes, i), next = byteAt(bytes, i + 1);
    if (isLead(c) && isTrail(next)) {
        ++i;
        const bool common = (c >= 0x81 && c <= 0x84) || (c >= 0x88 && c <= 0x97); // signs, kana, kanji of daily use
        return common ? 0.0 : c < 0xF0 ? 1.3 : 2.0;
    }
    if (c < 0xA1 || c > 0xDF)
        return 3.0;
    const auto half = [](unsigned b) { return b >= 0xA1 && b <= 0xDF; };
    return half(next) || (i > 0 && half(byteAt(bytes, i - 1))) ? 0.1 : 0.7;
}

} // namespace

const char* name(Encoding encoding) {
    return encoding == Encoding::ShiftJis      ? "Shift-JIS"
           : encoding == Encoding::Windows1251 ? "Windows-1251"
                                               : "Windows-1252";
}

const char* optionName(Encoding encoding) {
    return encoding == Encoding::ShiftJis      ? "shift-jis"
           : encoding == Encoding::Windows1251 ? "windows-1251"
                                               : "windows-1252";
}

std::optional<Encoding> encodingOf(std::string_view text) {
    for (const Encoding e : {Encoding::Windows1252, Encoding::Windows1251, Encoding::ShiftJis})
        if (text == optionName(e))
            return e;
    return std::nullopt;
}

EncodingGuess guessEncoding(std::string_view bytes) {
    // Headers and remarks decide; halved or doubled, no export of the tests is read otherwise.
    constexpr std::size_t kSample = std::size_t{1} << 18;
    constexpr double kPrior = 1.0; // of Windows-1252, a power of ten; halved: "Ø" alone is asked about
    bytes = bytes.substr(0, kSample);
    std::array<std::pair<double, Encoding>, 3> cost = {
        {{0.0, Encoding::Windows1252}, {kPrior, Encoding::Windows1251}, {kPrior, Encoding::ShiftJis}}};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (byteAt(bytes, i) < 0x80)
            continue;
        std::size_t end = i;
        while (byteAt(bytes, end) >= 0x80)
            ++end;
        cost[0].first += western(bytes, i, end);
        cost[1].first += cyrillic(bytes, i, end);
        i = end - 1;
    }
    for (std::size_t i = 0; i < bytes.size(); ++i)
        if (byteAt(bytes, i) >= 0x80)
            cost[2].first += japanese(bytes, i);
    std::stable_sort(cost.begin(), cost.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return {cost[0].second, cost[1].second, math::pow(10.0, std::min(12.0, cost[1].first - cost[0].first))};
}

std::string toUtf8(std::string_view bytes, Encoding encoding) {
    if (encoding == Encoding::ShiftJis)
        return record::fromShiftJis(bytes);
    std::string out;
    out.reserve(bytes.size() + bytes.size() / 8);
    for (const char b : bytes) {
        const auto c = static_cast<unsigned char>(b);
        std::uint32_t wide = c;
        if (encoding == Encoding::Windows1252 && c >= 0x80 && c < 0xA0)
            wide = kWestern[c - 0x80U];
        if (encoding == Encoding::Windows1251 && c >= 0x80)
            wide = c < 0xC0 ? kCyrillic[c - 0x80U] : 0x0410U + (c - 0xC0U);
        appendUtf8(out, wide == 0 && c != 0 ? 0xFFFD : wide);
    }
    return out;
}

void appendUtf8(std::string& out, unsigned long c) {
    const auto put = [&](unsigned long byte) { out += static_cast<char>(byte); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xC0 | (c >> 6));
        put(0x80 | (c & 63));
    } else if (c < 0x10000) {
        put(0xE0 | (c >> 12));
        put(0x80 | ((c >> 6) & 63));
        put(0x80 | (c & 63));
    } else {
        put(0xF0 | (c >> 18));
        put(0x80 | ((c >> 12) & 63));
        put(0x80 | ((c >> 6) & 63));
        put(0x80 | (c & 63));
    }
}

} // namespace supercircle::importing
