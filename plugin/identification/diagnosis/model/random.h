#pragma once
// Normal and exponential numbers that are equal on every machine (the standard fixes engines, not distributions).

#include "supercircle/support/elementary.h"

#include <cmath>
#include <cstdint>
#include <random>

namespace supercircle::diagnosis {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// In (0, 1).
    double uniform() { return (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1p-53; }
    /// Standard normal (G. E. P. Box, M. E. Muller, 1958).
    double normal() {
        if (spare_) {
            spare_ = false;
            return kept_;
        }
        const double r = std::sqrt(-2.0 * math::log(uniform())), a = 6.283185307179586 * uniform();
        kept_ = r * math::sin(a);
        spare_ = true;
        return r * math::cos(a);
    }
    /// Student's t of `degrees` > 2 degrees of freedom, scaled to variance 1 (R. W. Bailey, Math. Comp. 62 (1994) 779).
    double student(double degrees) {
        const double r = std::sqrt((degrees - 2.0) * math::expm1(-2.0 / degrees * math::log(uniform())));
        return r * math::cos(6.283185307179586 * uniform());
    }
    double exponential() { return -math::log(uniform()); }

private:
    std::mt19937_64 engine_;
    bool spare_ = false;
    double kept_ = 0.0;
};

} // namespace supercircle::diagnosis
