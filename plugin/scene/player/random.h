#pragma once
// Random numbers that are equal on all systems (the standard's distributions differ between libraries).

#include <cstdint>
#include <random>
#include <sstream>
#include <string>

namespace supercircle::player {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// Uniform in [a, b).
    double uniform(double a, double b) { return a + (b - a) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53); }
    /// All that decides the coming numbers, as a text that setState() takes; false: it is no such text.
    [[nodiscard]] std::string state() const {
        std::ostringstream out;
        out << engine_;
        return out.str();
    }
    [[nodiscard]] bool setState(const std::string& text) {
        std::istringstream in(text);
        return static_cast<bool>(in >> engine_);
    }

private:
    std::mt19937_64 engine_;
};

} // namespace supercircle::player
