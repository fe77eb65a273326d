#pragma once
// Candidate ids. From the high bits: key of side A (20), key of side B (20), feature kind (3), payload (21). An id does
// not depend on where the closest point is, so that warm starting survives sliding from one element to the next.

#include "supercircle/contact/detection.h"

namespace supercircle::contact {

enum class Feature : std::uint32_t {
    SampleRod = 0,     ///< node, tip or mid sample of A on rod B: sample (11), side of B (1), rank among equal ids (9)
    TipTip = 1,        ///< which tip of A (1), which tip of B (1); A is the rod with the smaller key
    Interior = 2,      ///< minimum of two elements: element of A (10), of B (10), part (1); A has the smaller key
    SampleOutline = 3, ///< sample of A on an outline: sample (11), side (1), unused (9)
    InteriorOutline = 4, ///< extremal point of an element against a face or disc: element (10), face (10), part (1)
    CornerRod = 5        ///< outline corner on rod A: corner (11), side of A (1), rank (9)
};

inline std::uint64_t makeId(std::uint32_t keyA, std::uint32_t keyB, Feature kind, std::uint32_t payload) {
    return (static_cast<std::uint64_t>(keyA & 0xfffffu) << 44U) | (static_cast<std::uint64_t>(keyB & 0xfffffu) << 24U) |
           (static_cast<std::uint64_t>(kind) << 21U) | (payload & 0x1fffffu);
}

inline Feature featureOf(std::uint64_t id) {
    return static_cast<Feature>((id >> 21U) & 7U);
}

inline std::uint32_t keyAOf(std::uint64_t id) {
    return static_cast<std::uint32_t>(id >> 44U) & 0xfffffu;
}
inline std::uint32_t keyBOf(std::uint64_t id) {
    return static_cast<std::uint32_t>(id >> 24U) & 0xfffffu;
}
/// True if side B is a rod, too, not an outline.
inline bool betweenRods(std::uint64_t id) {
    const Feature kind = featureOf(id);
    return kind == Feature::SampleRod || kind == Feature::TipTip || kind == Feature::Interior;
}
inline bool concernsRod(std::uint64_t id, std::uint32_t key) {
    return keyAOf(id) == key || (betweenRods(id) && keyBOf(id) == key);
}

inline std::uint32_t samplePayload(std::int32_t sample, bool left, std::uint32_t rank) {
    return ((static_cast<std::uint32_t>(sample) & 0x7ffu) << 10U) | (left ? 0x200u : 0u) | (rank & 0x1ffu);
}

/// Sample or corner number of an id with a sample payload.
inline std::int32_t sampleOf(std::uint64_t id) {
    return static_cast<std::int32_t>((id >> 10U) & 0x7ffu);
}

inline std::uint32_t elementPayload(std::int32_t first, std::int32_t second, std::int32_t part) {
    return ((static_cast<std::uint32_t>(first) & 0x3ffu) << 11U) |
           ((static_cast<std::uint32_t>(second) & 0x3ffu) << 1U) | (static_cast<std::uint32_t>(part) & 1u);
}

/// Face number of an InteriorOutline id.
inline std::int32_t faceOf(std::uint64_t id) {
    return static_cast<std::int32_t>((id >> 1U) & 0x3ffu);
}

} // namespace supercircle::contact
