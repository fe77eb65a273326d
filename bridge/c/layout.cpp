// Sizes and offsets of all structs, for languages that rebuild them.

#include "bridge/c/guard.h"

#include <cstddef>
#include <iterator>

namespace {

struct Entry {
    const char* name;
    std::int32_t number; ///< bytes of a struct, offset of a member
    bool isStruct;
};

// A table, because code for each member would be 20 kB.
constexpr Entry kEntries[] = {
#define STRUCT(name) {#name, sizeof(name), true},
#define MEMBER(name, member) {#member, offsetof(name, member), false},
#define END()
#include "bridge/c/layout.inc"
};

std::string layout() {
    std::string json = "{";
    for (const Entry& e : kEntries) {
        const bool first = &e == std::begin(kEntries);
        const bool firstMember = !first && (&e)[-1].isStruct;
        if (e.isStruct)
            json += std::string(first ? "" : "}},") + "\"" + e.name + "\":{\"size\":" + std::to_string(e.number) +
                    ",\"members\":{";
        else
            json += std::string(firstMember ? "" : ",") + "\"" + e.name + "\":" + std::to_string(e.number);
    }
    return json + "}}}";
}

} // namespace

const char* sc_layout(void) {
    return supercircle::c::text([] { return layout(); });
}
