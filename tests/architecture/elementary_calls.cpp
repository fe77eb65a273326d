#include "elementary_calls.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace supercircle::architecture {

namespace {

constexpr std::array<std::string_view, 29> kFunctions = {
    "sin",   "cos",   "tan",   "asin", "acos", "atan",   "atan2",  "sinh",   "cosh",  "tanh",
    "asinh", "acosh", "atanh", "exp",  "exp2", "expm1",  "log",    "log2",   "log10", "log1p",
    "pow",   "cbrt",  "hypot", "erf",  "erfc", "lgamma", "tgamma", "sincos", "lerp"};

/// Names that are forbidden wherever they stand. <complex>: its abs, arg, polar and exp call the C library.
constexpr std::array<std::string_view, 13> kNames = {"complex",
                                                     "uniform_real_distribution",
                                                     "uniform_int_distribution",
                                                     "normal_distribution",
                                                     "shuffle",
                                                     "exponential_distribution",
                                                     "student_t_distribution",
                                                     "AngleAxis",
                                                     "Rotation2D",
                                                     "Rotation2Dd",
                                                     "blueNorm",
                                                     "computeDirect",
                                                     "random_device"};

bool isWord(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// The line without comments and the insides of strings.
std::string codeOf(const std::string& line) {
    std::string code;
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            if (c == '\\')
                ++i;
            else if (c == quote)
                quote = 0;
        } else if (c == '/' && i + 1 < line.size() && line[i + 1] == '/') {
            break;
        } else if (c == '"' || (c == '\'' && (i == 0 || !isWord(line[i - 1])))) { // 1'000 is a number
            quote = c;
        } else {
            code += c;
        }
    }
    return code;
}

bool isFunction(std::string_view word) {
    const auto known = [](std::string_view w) {
        return std::find(kFunctions.begin(), kFunctions.end(), w) != kFunctions.end();
    };
    return known(word) ||
           (word.size() > 3 && (word.back() == 'f' || word.back() == 'l') && known(word.substr(0, word.size() - 1)));
}

bool endsWith(std::string_view text, std::string_view end) {
    return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

/// A call with arguments: the word is followed by `(` and something other than `)`.
bool hasArguments(std::string_view after) {
    const std::size_t open = after.find_first_not_of(' ');
    if (open == std::string_view::npos || after[open] != '(')
        return false;
    const std::size_t next = after.find_first_not_of(' ', open + 1);
    return next == std::string_view::npos || after[next] != ')';
}

bool offends(std::string_view before, std::string_view after, bool own) {
    if (endsWith(before, "std::") || endsWith(before, "numext::"))
        return true;
    if (endsWith(before, "::")) // ::sin, but not math::sin
        return before.size() == 2 || !isWord(before[before.size() - 3]);
    if (endsWith(before, "shells.")) // Shells::log
        return false;
    if (endsWith(before, ".") || endsWith(before, "->")) // Eigen's arrays: a.exp(), a.pow(2)
        return hasArguments(after) || after.substr(0, 2) == "()";
    const bool declared = !before.empty() && before.back() == ' ' && before.size() > 1 &&
                          isWord(before[before.size() - 2]) && !endsWith(before, "return ");
    return !own && !declared && hasArguments(after);
}

} // namespace

std::string machineDependentCall(const std::string& line, bool own) {
    const std::string code = codeOf(line);
    for (std::size_t i = 0; i < code.size();) {
        if (!isWord(code[i])) {
            ++i;
            continue;
        }
        std::size_t end = i;
        while (end < code.size() && isWord(code[end]))
            ++end;
        const std::string_view all = code, word = all.substr(i, end - i);
        if (std::find(kNames.begin(), kNames.end(), word) != kNames.end())
            return std::string(word);
        if (isFunction(word) && offends(all.substr(0, i), all.substr(end), own))
            return std::string(word);
        i = end;
    }
    return {};
}

bool decidesNumbers(const std::string& file) {
    for (const std::string_view folder : {"supercircle/", "bridge/", "plugin/api/", "plugin/scene/", "plugin/lab/",
                                          "plugin/identification/", "plugin/recording/"})
        if (std::string_view(file).substr(0, folder.size()) == folder)
            return true;
    return false;
}

} // namespace supercircle::architecture
