#pragma once
// Random numbers that are the same with every standard library.

#include <cmath>
#include <cstdint>
#include <random>

namespace supercircle::blind_benchmark {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double uniform(double from = 0.0, double to = 1.0) {
        return from + (to - from) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
    }
    double logarithmic(double from, double to) { return from * std::exp(uniform() * std::log(to / from)); }
    double normal() { // Box and Muller, one of the pair
        const double r = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return r * std::cos(2.0 * M_PI * uniform());
    }
    /// Of unit variance, with heavy tails: Student's t with five degrees of freedom.
    double heavyTailed() {
        double chi = 0.0;
        for (int i = 0; i < 5; ++i) {
            const double n = normal();
            chi += n * n;
        }
        return normal() / std::sqrt(chi / 5.0) * std::sqrt(3.0 / 5.0);
    }
    double sign() { return uniform() < 0.5 ? -1.0 : 1.0; }
    bool chance(double p) { return uniform() < p; }
    int integer(int below) { return static_cast<int>(uniform() * below); }

private:
    std::mt19937_64 engine_;
};

} // namespace supercircle::blind_benchmark
