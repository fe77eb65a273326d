// One call for all of supercircle_lab.h that a page can make: it tells the page how far the work is.

#include "bridge/c/include/supercircle_lab.h"

#include <array>
#include <cstring>

/// The page's own; other than 0 cancels.
extern "C" __attribute__((import_module("page"), import_name("progress"))) int32_t page_progress(double fraction,
                                                                                                 const char* stage);

namespace {

int32_t tellPage(void* /*context*/, double fraction, const char* stage) {
    return page_progress(fraction, stage);
}

} // namespace

/// @param name of the call, such as "replay"
/// @return the answer; null: refused, or there is no such call
extern "C" const char* sc_page_lab(const char* name, const char* request) {
    using Call = const char* (*)(const char*, sc_lab_progress, void*);
    struct Known {
        const char* name;
        Call call;
    };
    static constexpr std::array kCalls{Known{"import", sc_lab_import}, Known{"replay", sc_lab_replay},
                                       Known{"diagnose", sc_lab_diagnose}};
    for (const Known& known : kCalls)
        if (std::strcmp(known.name, name) == 0)
            return known.call(request, tellPage, nullptr);
    return nullptr;
}
