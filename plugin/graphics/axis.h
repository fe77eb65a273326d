#pragma once
// Scales of diagrams: ranges, ticks at round numbers, units with a prefix; numbers as text.

#include <string>
#include <vector>

namespace supercircle::graphics {

struct AxisRange {
    double lo = 0.0, hi = 1.0;
    [[nodiscard]] double span() const { return hi - lo; }
};

struct Ticks {
    double step = 1.0;
    std::vector<double> values;
    /// Value with as many decimals as the step needs and a true minus sign.
    [[nodiscard]] std::string label(double value) const;
};

/// Multiples of 1, 2 or 5 times a power of ten inside the range, at most `most` of them (at least 2); up to five where
/// the next larger step would leave a scale with a single number. A range that is empty or not finite gives no values.
[[nodiscard]] Ticks niceTicks(const AxisRange& range, int most);

/// The range widened by `pad` of its span on either side; an empty one around its value; one that is not finite is 0
/// .. 1.
[[nodiscard]] AxisRange padded(AxisRange range, double pad);

/// The finite values of some columns, with a twentieth of their span on either side.
[[nodiscard]] AxisRange rangeOf(const std::vector<const std::vector<double>*>& columns);

/// A unit with a prefix, and the factor from the SI unit to it.
struct DisplayUnit {
    double factor = 1.0; ///< shown = value * factor
    std::string text;    ///< "mJ"
};
/// The prefix that makes numbers up to `largest` readable.
[[nodiscard]] DisplayUnit readableUnit(double largest, const std::string& unit);

/// Value with `digits` significant digits; no exponent between 1e-3 and 1e6.
[[nodiscard]] std::string significant(double value, int digits = 4);

/// The same without trailing zeros after the point, for numbers that were typed in: 0.35, not 0.350000.
[[nodiscard]] std::string trimmed(double value, int digits = 7);

/// "12 s", "3 min 20 s", "2 h 05 min".
[[nodiscard]] std::string readableDuration(double seconds);

} // namespace supercircle::graphics
