#pragma once
// Bytes read as numbers, points and choices.

#include "plugin/api/include/supercircle/definitions.hpp"

#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::fuzz {

class ByteSource {
public:
    explicit ByteSource(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}
    [[nodiscard]] bool empty() const { return at_ >= bytes_.size(); }
    std::uint8_t byte() { return empty() ? 0 : bytes_[at_++]; }
    std::uint32_t below(std::uint32_t n) { return (byte() | static_cast<std::uint32_t>(byte()) << 8) % n; }
    bool chance(int inTwoHundredFiftySix) { return byte() < inTwoHundredFiftySix; }
    /// Within [low, high]; with the chance `odd` / 256 an extreme number or none.
    double number(double low, double high, int odd = 4) {
        static constexpr double kOdd[] = {std::numeric_limits<double>::quiet_NaN(),
                                          std::numeric_limits<double>::infinity(),
                                          -std::numeric_limits<double>::infinity(),
                                          0.0,
                                          -0.0,
                                          -1.0,
                                          1e300,
                                          -1e300,
                                          1e-300,
                                          5e-324,
                                          1e30,
                                          1e9};
        if (chance(odd)) {
            const double x = kOdd[byte() % (sizeof(kOdd) / sizeof(double))];
            char text[32];
            std::snprintf(text, sizeof text, " %g", x);
            odd_ += text;
            return x;
        }
        return low + (high - low) * (below(65536) / 65535.0);
    }
    Point point(double reach, int odd = 4) {
        const double x = number(-reach, reach, odd);
        return {x, number(-0.2 * reach, reach, odd)};
    }

    /// The extreme numbers since the last call, as a text.
    std::string takeOddNumbers() { return std::exchange(odd_, {}); }

private:
    const std::vector<std::uint8_t>& bytes_;
    std::size_t at_ = 0;
    std::string odd_;
};

} // namespace supercircle::fuzz
