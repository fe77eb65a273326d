#include "plugin/recording/import/reading/text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace supercircle::importing {

namespace {

/// Length of the sequence a UTF-8 lead byte announces, 0 for none.
std::size_t announced(unsigned char lead) {
    return lead < 0x80                   ? 1
           : lead >= 0xC2 && lead < 0xE0 ? 2
           : (lead & 0xF0) == 0xE0       ? 3
           : lead >= 0xF0 && lead < 0xF5 ? 4
                                         : 0;
}

bool validUtf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t n = announced(static_cast<unsigned char>(text[i]));
        if (n == 0 || i + n > text.size())
            return false;
        for (std::size_t k = 1; k < n; ++k)
            if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80)
                return false;
        i += n;
    }
    return true;
}

std::string fromUtf16(std::string_view bytes, bool bigEndian) {
    std::string out;
    out.reserve(bytes.size());
    const auto unit = [&](std::size_t i) {
        const auto a = static_cast<unsigned char>(bytes[i]), b = static_cast<unsigned char>(bytes[i + 1]);
        return static_cast<std::uint32_t>(bigEndian ? (a << 8) | b : (b << 8) | a);
    };
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t c = unit(i);
        if (c >= 0xD800 && c < 0xE000) { // half of a pair; one without the other is no character
            const std::uint32_t low = c < 0xDC00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
            const bool pair = low >= 0xDC00 && low < 0xE000;
            c = pair ? 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00) : 0xFFFD;
            i += pair ? 2 : 0;
        }
        appendUtf8(out, c);
    }
    return out;
}

std::string lineEndsOf(std::string_view text) {
    std::size_t lf = 0, crlf = 0, cr = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n')
            ++(i > 0 && text[i - 1] == '\r' ? crlf : lf);
        else if (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'))
            ++cr;
    }
    if ((lf > 0) + (crlf > 0) + (cr > 0) > 1)
        return "mixed";
    return crlf > 0 ? "CRLF" : cr > 0 ? "CR" : "LF";
}

bool startsWith(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

/// UTF-16 without a mark: every other byte of a text of digits and Latin letters is zero.
int zeroParity(std::string_view bytes) {
    std::array<std::size_t, 2> zeros{0, 0};
    const std::size_t n = std::min<std::size_t>(bytes.size(), 4096);
    for (std::size_t i = 0; i < n; ++i)
        zeros[i % 2] += bytes[i] == 0 ? 1 : 0;
    for (int k = 0; k < 2; ++k)
        if (4 * zeros[static_cast<std::size_t>(k)] > n && 16 * zeros[static_cast<std::size_t>(1 - k)] < n)
            return k;
    return -1;
}

Result<Text> refused(const std::string& what) {
    return Result<Text>::failure(what + "; expected a text of lines and columns (export it as CSV)");
}

} // namespace

Result<Text> decode(std::string bytes, std::optional<Encoding> stated) {
    Text t;
    if (bytes.empty())
        return refused("the file is empty");
    if (startsWith(bytes, "PK\x03\x04") || startsWith(bytes, "\xD0\xCF\x11\xE0"))
        return refused("this is a spreadsheet or an archive, not a text");
    if (startsWith(bytes, "MATLAB ") || startsWith(bytes, "\x89HDF"))
        return refused("this is a file of MATLAB, not a text");
    if (startsWith(bytes, "\xEF\xBB\xBF")) {
        t.encoding = "UTF-8 with byte order mark";
        bytes.erase(0, 3);
        t.utf8 = validUtf8(bytes) ? std::move(bytes) : toUtf8(bytes, Encoding::Windows1252);
    } else if (startsWith(bytes, "\xFF\xFE")) {
        t.encoding = "UTF-16 (little-endian)";
        t.utf8 = fromUtf16(std::string_view(bytes).substr(2), false);
    } else if (startsWith(bytes, "\xFE\xFF")) {
        t.encoding = "UTF-16 (big-endian)";
        t.utf8 = fromUtf16(std::string_view(bytes).substr(2), true);
    } else if (const int zeros = zeroParity(bytes); zeros >= 0) {
        t.encoding = zeros == 1 ? "UTF-16 (little-endian)" : "UTF-16 (big-endian)";
        t.utf8 = fromUtf16(bytes, zeros == 0);
    } else if (bytes.find('\0') != std::string::npos) {
        return refused("there are zero bytes in it: this is not a text");
    } else if (!stated && validUtf8(bytes)) {
        t.encoding = "UTF-8";
        t.utf8 = std::move(bytes); // recordings can be large
    } else {
        const EncodingGuess guess = guessEncoding(bytes);
        const Encoding encoding = stated.value_or(guess.best);
        constexpr double kSure = 10.0; // as for signs, units and clocks
        if (!stated && guess.odds < kSure)
            return Result<Text>::failure("1:1: the text may be " + std::string(name(guess.best)) + " or " +
                                         name(guess.second) + "; say which one with --encoding " +
                                         optionName(guess.best) + "|" + optionName(guess.second));
        t.encoding = name(encoding);
        t.otherEncoding = stated ? "" : name(guess.second);
        t.encodingOdds = stated ? 0.0 : guess.odds;
        t.utf8 = toUtf8(bytes, encoding);
        if (t.utf8.empty())
            return Result<Text>::failure("1:1: the text is " + t.encoding +
                                         ", which this system cannot convert; export it again in UTF-8");
    }
    t.lineEnds = lineEndsOf(t.utf8);
    return t;
}

std::vector<std::string_view> linesOf(std::string_view text) {
    std::vector<std::string_view> lines;
    std::size_t from = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\n' && text[i] != '\r')
            continue;
        lines.push_back(text.substr(from, i - from));
        if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n')
            ++i;
        from = i + 1;
    }
    if (from < text.size())
        lines.push_back(text.substr(from));
    return lines;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::array<std::string_view, 5> kBlanks = {" ", "\t", "\xC2\xA0", "\xE2\x80\xAF", "\xEF\xBB\xBF"};
    for (bool again = true; again;) {
        again = false;
        for (const std::string_view blank : kBlanks) {
            if (startsWith(text, blank)) {
                text.remove_prefix(blank.size());
                again = true;
            }
            if (text.size() >= blank.size() && text.substr(text.size() - blank.size()) == blank) {
                text.remove_suffix(blank.size());
                again = true;
            }
        }
    }
    return text;
}

std::vector<std::string> cellsOf(std::string_view line, char separator) {
    if (separator == ' ') {
        std::vector<std::string_view> words;
        splitCells(line, separator, words);
        return {words.begin(), words.end()};
    }
    std::vector<std::string> cells;
    std::string cell;
    bool quoted = false;
    const auto finish = [&] {
        cells.emplace_back(trimmed(cell));
        cell.clear();
    };
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            cell += '"';
            ++i;
        } else if (c == '"' && (quoted || trimmed(cell).empty())) {
            quoted = !quoted;
        } else if (c == separator && !quoted) {
            finish();
        } else {
            cell += c;
        }
    }
    finish();
    return cells;
}

void splitCells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    cells.clear();
    if (separator == ' ') {
        for (std::size_t i = 0; i < line.size();) {
            const std::size_t from = line.find_first_not_of(" \t", i);
            if (from == std::string_view::npos)
                return;
            i = std::min(line.find_first_of(" \t", from), line.size());
            cells.push_back(line.substr(from, i - from));
        }
        return;
    }
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t to = std::min(line.find(separator, from), line.size());
        cells.push_back(trimmed(line.substr(from, to - from)));
        from = to + 1;
    }
}

std::size_t columnOf(std::string_view line, char separator, std::size_t cell) {
    if (separator == ' ') {
        std::vector<std::string_view> cells;
        splitCells(line, separator, cells);
        return cell < cells.size() ? static_cast<std::size_t>(cells[cell].data() - line.data()) + 1 : 1;
    }
    bool quoted = false;
    std::size_t count = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (count == cell && line[i] != ' ')
            return i + 1;
        quoted = quoted != (line[i] == '"');
        count += line[i] == separator && !quoted ? 1 : 0;
    }
    return 1;
}

std::string folded(std::string_view utf8) {
    static const std::vector<std::pair<std::string_view, std::string_view>> kAccents = {
        {"ä", "a"}, {"Ä", "a"}, {"ö", "o"}, {"Ö", "o"}, {"ü", "u"}, {"Ü", "u"}, {"ß", "ss"}, {"é", "e"}, {"É", "e"},
        {"è", "e"}, {"È", "e"}, {"ê", "e"}, {"á", "a"}, {"à", "a"}, {"â", "a"}, {"ó", "o"},  {"ô", "o"}, {"í", "i"},
        {"î", "i"}, {"ú", "u"}, {"û", "u"}, {"ç", "c"}, {"ñ", "n"}, {"°", "°"}, {"µ", "u"},  {"μ", "u"}, {"Δ", "d"}};
    std::string out;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto found = std::find_if(kAccents.begin(), kAccents.end(),
                                        [&](const auto& p) { return startsWith(utf8.substr(i), p.first); });
        if (found != kAccents.end()) {
            out += found->second;
            i += found->first.size();
        } else if (utf8[i] == '\xD0' && i + 1 < utf8.size() && utf8[i + 1] >= '\x90' && utf8[i + 1] <= '\xAF') {
            const auto c = static_cast<unsigned long>(static_cast<unsigned char>(utf8[i + 1]));
            appendUtf8(out, 0x430 + (c - 0x90)); // a Cyrillic capital
            i += 2;
        } else {
            const char c = utf8[i++];
            out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        }
    }
    return out;
}

} // namespace supercircle::importing
