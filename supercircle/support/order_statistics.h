#pragma once
// Values of a sorted list, without interpolation. Published numbers rest on these definitions.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace supercircle {

/// The middle of the sorted values, the upper one of the two of an even number; 0 of an empty list. NaN is not allowed.
template <class Values>
typename Values::value_type upperMedian(Values values) {
    if (values.empty())
        return {};
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Entry floor(share (n - 1)), from 0, of the n sorted values; 0 of an empty list. NaN is not allowed.
/// @param share from 0 to 1; at 0.5 an even number gives the lower one of the two middle values
inline double lowerQuantile(std::vector<double> values, double share) {
    if (values.empty())
        return 0.0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

} // namespace supercircle
