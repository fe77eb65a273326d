#pragma once
// Random numbers that are equal on all systems (the standard's distributions differ between libraries).

#include <cstdint>
#include <random>

namespace supercircle::player {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// Uniform in [a, b).
    double uniform(double a, double b) { return a + (b - a) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53); }

private:
    std::mt19937_64 engine_;
};

} // namespace supercircle::player
