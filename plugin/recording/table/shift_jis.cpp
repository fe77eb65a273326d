#include "plugin/recording/table/shift_jis.h"

#include <algorithm>
#include <cerrno>
#include <iconv.h>

namespace supercircle::record {

std::string fromShiftJis(std::string_view bytes) {
    constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
    iconv_t converter = iconv_open("UTF-8", "CP932");
    if (converter == reinterpret_cast<iconv_t>(-1)) // NOLINT: as POSIX defines it
        converter = iconv_open("UTF-8", "SHIFT_JIS");
    if (converter == reinterpret_cast<iconv_t>(-1)) // NOLINT
        return {};
    std::string in(bytes), out(3 * bytes.size() + 16, '\0');
    char *from = in.data(), *to = out.data();
    std::size_t left = in.size(), room = out.size();
    while (left > 0 && iconv(converter, &from, &left, &to, &room) == static_cast<std::size_t>(-1)) {
        if (errno == E2BIG || room < kReplacement.size())
            break;
        to = std::copy(kReplacement.begin(), kReplacement.end(), to);
        room -= kReplacement.size();
        ++from; // a byte that is no character
        --left;
    }
    iconv_close(converter);
    out.resize(out.size() - room);
    return out;
}

} // namespace supercircle::record
