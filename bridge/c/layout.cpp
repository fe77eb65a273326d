// Sizes and offsets of all structs, for languages that rebuild them.

#include "bridge/c/guard.h"

#include <cstddef>

namespace {

std::string layout() {
    std::string json = "{";
    bool first = true;
    const auto comma = [&] { json += first ? "" : ","; };
#define STRUCT(name)                                                                                                   \
    comma();                                                                                                           \
    json += "\"" #name "\":{\"size\":" + std::to_string(sizeof(name)) + ",\"members\":{";                              \
    first = true;
#define MEMBER(name, member)                                                                                           \
    comma();                                                                                                           \
    json += "\"" #member "\":" + std::to_string(offsetof(name, member));                                               \
    first = false;
#define END()                                                                                                          \
    json += "}}";                                                                                                      \
    first = false;
#include "bridge/c/layout.inc"
    return json + "}";
}

} // namespace

const char* sc_layout(void) {
    return supercircle::c::text([] { return layout(); });
}
