#pragma once
// Scales of diagrams: ranges, ticks at nice numbers, units with a prefix.

#include <string>
#include <vector>

namespace supercircle::report {

struct Range {
    double lo = 0.0, hi = 1.0;
    [[nodiscard]] double span() const { return hi - lo; }
};

struct Ticks {
    double step = 1.0;
    std::vector<double> values;
    /// Value with as many decimals as the step needs and a true minus sign.
    [[nodiscard]] std::string label(double value) const;
};

/// Multiples of 1, 2 or 5 times a power of ten inside the range, at most `most` of them (at least 2).
/// A range that is empty or not finite gives no values.
[[nodiscard]] Ticks niceTicks(const Range& range, int most);

/// The range widened by `pad` of its span on either side; an empty one around its value; one that is not finite is 0
/// .. 1.
[[nodiscard]] Range padded(Range range, double pad);

/// Prefix that makes numbers up to `largest` readable.
struct Unit {
    double factor = 1.0; ///< shown = value * factor
    std::string text;    ///< "mJ"
};
[[nodiscard]] Unit readableUnit(double largest, const std::string& unit);

/// Value for people: `digits` significant ones, no exponent between 1e-3 and 1e6, thin grouping is left to the reader.
[[nodiscard]] std::string significant(double value, int digits = 4);

/// The same without trailing zeros after the point: for numbers that were typed in, 0.35 and not 0.350000.
[[nodiscard]] std::string asTyped(double value, int digits = 7);

} // namespace supercircle::report
