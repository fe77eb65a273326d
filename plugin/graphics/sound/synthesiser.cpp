#include "plugin/graphics/sound/synthesiser.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::sound {

namespace {

/// Amplitude below which sliding is left out. Half of it lets piles at rest hiss by their creep of micrometres a
/// second; twice of it silences a plate of 5 mm/s on one shell.
constexpr double kSoftest = 0.004;
constexpr double kTwoPi = 6.283185307179586;
/// Bending modes 2 to 5 of a free ring over mode 2: n (n^2 - 1) / sqrt(n^2 + 1) (Love, 1888).
constexpr std::array<double, 4> kRing = {1.0, 2.828427, 5.423261, 8.770580};

/// 0 at 0, half at the reference, 1 far above, because loudness is heard by its logarithm.
double grade(double strength, double reference, double power) {
    if (!(strength > 0.0))
        return 0.0;
    const double x = math::pow(std::min(strength / reference, 1e12), power);
    return x / (1.0 + x);
}

/// Of a shell of the paper's radius, 19.2 mm, and falling with the root of the radius.
double pitch(double at19mm, double radius) {
    const double r = radius > 0.0 ? radius : 0.0192;
    return std::clamp(at19mm * std::sqrt(0.0192 / r), 0.2 * at19mm, 4.0 * at19mm);
}

/// Straight up to 0.6, then bent towards 1, which it never reaches.
double limited(double x) {
    constexpr double kStraight = 0.6, kRest = 0.39;
    const double over = std::abs(x) - kStraight;
    return over <= 0.0 ? x : std::copysign(kStraight + kRest * over / (kRest + over), x);
}

} // namespace

void Synthesiser::start(double amplitude, double frequency, double seconds, std::size_t modes, double delay) {
    if (!(amplitude > 1e-3))
        return;
    Voice voice;
    for (std::size_t k = 0; k < modes; ++k) {
        const double f = frequency * kRing[k];
        if (f > 0.45 * kRate)
            break;
        const double turn = kTwoPi * f / kRate, order = static_cast<double>(k + 1);
        const double fall = math::exp(-order / (seconds * kRate)); // higher modes die sooner
        const math::SinCos step = math::sinCos(turn);
        const double share = amplitude / (order * order);
        voice.modes[k] = {2.0 * fall * step.cosine, fall * fall, 0.0, -share * step.sine / fall};
        voice.count = k + 1;
    }
    voice.loudness = amplitude;
    voice.decay = math::exp(-1.0 / (seconds * kRate));
    voice.delay = static_cast<int>(std::clamp(delay, 0.0, kMostSeconds) * kRate);
    Voice* const quietest = std::min_element(voices_.begin(), voices_.end(),
                                             [](const Voice& a, const Voice& b) { return a.loudness < b.loudness; });
    if (quietest->loudness < amplitude)
        *quietest = voice;
}

void Synthesiser::snap(double strength, double radius, double delay) {
    start(0.7 * grade(strength, 0.4, 0.5), pitch(620.0, radius), 0.11, kModes, delay);
}

void Synthesiser::hit(double strength, double radius, double delay) {
    start(0.45 * grade(strength, 1.0, 0.8), pitch(1450.0, radius), 0.012, 2, delay);
}

void Synthesiser::slide(double strength, double speed) {
    wanted_ = 0.3 * grade(strength, 0.3, 0.6);
    if (wanted_ < kSoftest)
        wanted_ = 0.0;
    const double f = std::clamp(3000.0 * std::sqrt(std::max(speed, 0.0)), 300.0, 6000.0);
    if (wanted_ > 0.0)
        pole_ = 1.0 - math::exp(-kTwoPi * f / kRate);
}

/// -1 to 1, by xorshift (Marsaglia, 2003).
double Synthesiser::noise() {
    seed_ ^= seed_ << 13;
    seed_ ^= seed_ >> 17;
    seed_ ^= seed_ << 5;
    return static_cast<double>(seed_) / 2147483648.0 - 1.0;
}

/// White noise between half a pitch and the pitch: the difference of two low passes.
double Synthesiser::hiss() {
    level_ += (wanted_ - level_) * 0.0014; // within 15 ms: no click
    if (level_ < 1e-5 && wanted_ == 0.0) {
        level_ = low_ = lower_ = lowest_ = 0.0;
        return 0.0;
    }
    low_ += pole_ * (noise() - low_);
    lower_ += pole_ * (low_ - lower_);
    lowest_ += 0.4 * pole_ * (lower_ - lowest_);
    return 2.4 * level_ * (lower_ - lowest_);
}

std::span<const float> Synthesiser::render(double seconds) {
    const double exact = std::clamp(seconds, 0.0, kMostSeconds) * kRate + carry_;
    const auto count = static_cast<std::size_t>(exact + 1e-6);
    carry_ = std::max(exact - static_cast<double>(count), 0.0);
    samples_.resize(count);
    for (float& sample : samples_) {
        double sum = hiss();
        for (Voice& v : voices_) {
            if (v.silent() || v.delay-- > 0)
                continue;
            for (std::size_t k = 0; k < v.count; ++k) {
                Mode& m = v.modes[k];
                const double next = m.a * m.last - m.b * m.before;
                sum += next;
                m.before = m.last;
                m.last = next;
            }
            v.loudness *= v.decay;
            if (v.silent())
                v = {};
        }
        sample = static_cast<float>(limited(sum));
    }
    return samples_;
}

std::size_t Synthesiser::voices() const {
    return static_cast<std::size_t>(
        std::count_if(voices_.begin(), voices_.end(), [](const Voice& v) { return !v.silent(); }));
}

} // namespace supercircle::sound
