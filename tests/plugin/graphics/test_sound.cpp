// Sound: bounded, silent without events, louder with energy, the same each time.

#include "plugin/graphics/sound/synthesiser.h"
#include "plugin/graphics/sound/wav.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

using namespace supercircle::sound;

namespace {

double energyOf(std::span<const float> samples) {
    double sum = 0.0;
    for (const float s : samples)
        sum += static_cast<double>(s) * static_cast<double>(s);
    return sum;
}

double loudest(std::span<const float> samples) {
    double most = 0.0;
    for (const float s : samples)
        most = std::max(most, std::abs(static_cast<double>(s)));
    return most;
}

std::vector<float> snapOf(double strength, double radius = 0.0192) {
    Synthesiser s;
    s.snap(strength, radius);
    const auto samples = s.render(1.0);
    return {samples.begin(), samples.end()};
}

/// Sign changes a second in the first 0.1 s.
double pitchOf(const std::vector<float>& samples) {
    int changes = 0;
    for (int i = 1; i < kRate / 10; ++i)
        changes += (samples[i] > 0.0F) != (samples[i - 1] > 0.0F) ? 1 : 0;
    return 5.0 * changes;
}

} // namespace

TEST_CASE("without events there is silence, bit by bit", "[sound]") {
    Synthesiser s;
    s.slide(0.0, 0.3);
    s.snap(0.0, 0.02);
    s.hit(-1.0, 0.02);
    s.snap(std::numeric_limits<double>::quiet_NaN(), 0.02);
    const auto samples = s.render(2.0);
    CHECK(samples.size() == 2 * kRate);
    CHECK(std::all_of(samples.begin(), samples.end(), [](float x) { return x == 0.0F; }));
}

TEST_CASE("no sample reaches 1, however much sounds at a time, and at most sixteen voices ring", "[sound]") {
    Synthesiser s;
    double most = 0.0;
    for (int frame = 0; frame < 120; ++frame) {
        for (int i = 0; i < 10; ++i) {
            s.snap(1e6, 0.0192 * (1 + i % 3), 0.001 * i);
            s.hit(1e6, 0.01, 0.0015 * i);
        }
        s.slide(1e9, 10.0);
        most = std::max(most, loudest(s.render(1.0 / 60.0)));
        CHECK(s.voices() <= kMostVoices);
    }
    CHECK(most < 1.0);
    CHECK(most > 0.6); // it is loud indeed
}

TEST_CASE("the creep of a pile at rest is not heard", "[sound]") {
    Synthesiser s;
    s.slide(2e-4, 1e-5);
    CHECK(loudest(s.render(0.5)) == 0.0);
}

TEST_CASE("the energy of a snap's sound grows with the released energy", "[sound]") {
    double last = 0.0;
    for (const double strength : {0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0}) {
        const double now = energyOf(snapOf(strength));
        CHECK(now > 1.05 * last);
        last = now;
    }
    CHECK(loudest(snapOf(10.0)) < 1.0);
}

TEST_CASE("hits grow with impulse, slides with friction power", "[sound]") {
    double lastHit = 0.0, lastSlide = 0.0;
    for (const double x : {0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 5.0}) {
        Synthesiser hit, slide;
        hit.hit(x, 0.0192);
        slide.slide(x, 0.1);
        const double hits = energyOf(hit.render(0.5)), slides = energyOf(slide.render(0.5));
        CHECK(hits >= lastHit); // equal: neither is heard
        CHECK(slides > lastSlide);
        lastHit = hits;
        lastSlide = slides;
    }
    CHECK(lastHit > 0.0);
}

TEST_CASE("a larger shell has a lower pitch, and a faster slide is brighter", "[sound]") {
    CHECK(pitchOf(snapOf(1.0, 0.02)) > 1.4 * pitchOf(snapOf(1.0, 0.06)));
    const auto brightness = [](double speed) {
        Synthesiser s;
        s.slide(1.0, speed);
        const auto x = s.render(1.0);
        return pitchOf({x.begin(), x.end()});
    };
    CHECK(brightness(0.4) > 1.5 * brightness(0.05));
}

TEST_CASE("a snap dies away and ends in silence", "[sound]") {
    const auto samples = snapOf(1.0);
    const std::span<const float> all = samples;
    CHECK(energyOf(all.subspan(24000)) < 0.001 * energyOf(all.first(24000))); // four time constants of amplitude
    Synthesiser s;
    s.snap(1.0, 0.0192);
    (void)s.render(2.0);
    CHECK(s.voices() == 0);
    CHECK(loudest(s.render(0.1)) == 0.0);
}

TEST_CASE("frames of any length give the samples of one long call", "[sound]") {
    const auto play = [](const std::vector<double>& lengths) {
        Synthesiser s;
        s.snap(2.0, 0.0192, 0.01);
        s.hit(1.0, 0.0192, 0.05);
        s.slide(0.5, 0.1);
        std::vector<float> out;
        for (const double seconds : lengths) {
            const auto x = s.render(seconds);
            out.insert(out.end(), x.begin(), x.end());
        }
        return out;
    };
    const auto whole = play({0.5});
    CHECK(whole.size() == 24000);
    CHECK(play(std::vector<double>(30, 1.0 / 60.0)) == whole);
    CHECK(play(std::vector<double>(3500, 1.0 / 7000.0)) == whole); // 6.86 samples each
    CHECK(play({0.5}) == whole);                                   // and each time
}

TEST_CASE("a delay shifts a sound by as many samples", "[sound]") {
    Synthesiser now, later;
    now.snap(1.0, 0.0192);
    later.snap(1.0, 0.0192, 0.25);
    const auto a = now.render(0.5), b = later.render(0.75);
    CHECK(std::equal(a.begin(), a.end(), b.begin() + 12000));
    CHECK(loudest(b.first(12000)) == 0.0);
}

TEST_CASE("a WAV file has a head and the samples as they are", "[sound]") {
    const std::vector<float> samples{0.0F, 0.5F, -0.25F};
    const std::string file = wav(samples);
    const auto word = [&](std::size_t at) {
        std::uint32_t v = 0;
        for (int i = 3; i >= 0; --i)
            v = v << 8 | static_cast<unsigned char>(file[at + static_cast<std::size_t>(i)]);
        return v;
    };
    REQUIRE(file.size() == 58 + 12);
    CHECK(file.substr(0, 4) == "RIFF");
    CHECK(word(4) == file.size() - 8);
    CHECK(file.substr(8, 8) == "WAVEfmt ");
    CHECK(word(20) == (3U | 1U << 16)); // floats, one channel
    CHECK(word(24) == kRate);
    CHECK(file.substr(50, 4) == "data");
    CHECK(word(54) == 12);
    CHECK(std::memcmp(file.data() + 58, samples.data(), 12) == 0);
}
