#pragma once
// Conditions that several assertions share. A number that is not finite passes: a step that computes one is rolled
// back, which is no broken invariant.

#include "supercircle/support/failure.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace supercircle::invariants {

/// Whether SC_ASSERT_EXPENSIVE is on: for values that only such an assertion reads.
#ifdef SUPERCIRCLE_CHECKED
constexpr bool kExpensive = true;
#else
constexpr bool kExpensive = false;
#endif

/// Length 1 within 1e-9.
template <class Vector>
bool isUnit(const Vector& n) {
    return !(std::abs(n.squaredNorm() - 1.0) > 2e-9);
}

/// Whether `index` names one of `size` items.
template <class Index>
constexpr bool inRange(Index index, std::size_t size) {
    return index >= 0 && static_cast<std::size_t>(index) < size;
}

/// Whether `keyOf` of the items rises from each to the next.
template <class List, class KeyOf>
bool strictlyRising(const List& list, KeyOf&& keyOf) {
    for (std::size_t i = 1; i < list.size(); ++i)
        if (!(keyOf(list[i - 1]) < keyOf(list[i])))
            return false;
    return true;
}
template <class List>
bool strictlyRising(const List& list) {
    return strictlyRising(list, [](const auto& item) { return item; });
}

/// Whether all of `condition(i)` hold, i in [0, count).
template <class Condition>
bool forAll(std::size_t count, Condition&& condition) {
    for (std::size_t i = 0; i < count; ++i)
        if (!condition(i))
            return false;
    return true;
}

} // namespace supercircle::invariants
