#pragma once
// Sound of shells from plain data: snaps ring, hits click, slides hiss. Samples are equal on every machine. The lowest
// mode of a shell of some centimetres lies below 100 Hz, so pitch keeps the ratios of modes and the order of sizes, not
// the frequencies (decision 0202).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace supercircle::sound {

inline constexpr int kRate = 48000;            ///< samples a second
inline constexpr std::size_t kMostVoices = 16; ///< that ring at a time; a new one replaces the quietest
/// At a time, s: bounds the memory of a caller's mistake.
inline constexpr double kMostSeconds = 10.0;

class Synthesiser {
public:
    /// A shell of that radius (m; of a strip its length over 2 pi) snaps. Strength: released energy over B / L, 1.
    /// `delay`: from the next sample, s.
    void snap(double strength, double radius, double delay = 0.0);
    /// A shell of that radius is hit. Strength: impulse over m sqrt(g R) of the shell, 1.
    void hit(double strength, double radius, double delay = 0.0);
    /// From now on shells slide. Strength: friction power over m g sqrt(g R) of all shells, 1; 0: nothing slides.
    /// Speed: mean slip speed over sqrt(g R), 1.
    void slide(double strength, double speed);
    /// The next samples, mono, between -1 and 1, neither reached. Fractions of a sample are carried over. `seconds` is
    /// 0 to kMostSeconds.
    [[nodiscard]] std::span<const float> render(double seconds);
    [[nodiscard]] std::size_t voices() const;

private:
    static constexpr std::size_t kModes = 4;
    /// A decaying sine by recursion: y[n] = a y[n-1] - b y[n-2].
    struct Mode {
        double a = 0.0, b = 0.0, last = 0.0, before = 0.0;
    };
    struct Voice {
        std::array<Mode, kModes> modes{};
        std::size_t count = 0; ///< of modes
        int delay = 0;         ///< samples
        double loudness = 0.0; ///< amplitude now: decays with the longest mode
        double decay = 0.0;    ///< of it, a sample
        [[nodiscard]] bool silent() const { return loudness < 1e-4; }
    };
    void start(double amplitude, double frequency, double seconds, std::size_t modes, double delay);
    double noise();
    double hiss();

    std::array<Voice, kMostVoices> voices_{};
    std::vector<float> samples_;
    double carry_ = 0.0;                                         ///< of a sample
    double level_ = 0.0, wanted_ = 0.0;                          ///< amplitude of the hiss
    double pole_ = 0.0, low_ = 0.0, lower_ = 0.0, lowest_ = 0.0; ///< its filter
    std::uint32_t seed_ = 0x9e3779b9U;
};

} // namespace supercircle::sound
