#pragma once
// Collision filter of rods and outlines, as in Box2D. The crossing check has its own (decision 0122).

#include <cstdint>

namespace supercircle::contact {

struct Filter {
    std::uint32_t category = 0;
    std::uint32_t mask = 0;
    std::int32_t group = 0;
    bool operator==(const Filter&) const = default;
};

/// Two objects of one positive group always touch, of one negative group never; else the masks decide.
inline bool mayTouch(const Filter& a, const Filter& b) {
    if (a.group != 0 && a.group == b.group)
        return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

/// Groups do not count for a rod and itself.
inline bool mayTouchItself(const Filter& a) {
    return (a.category & a.mask) != 0;
}

} // namespace supercircle::contact
