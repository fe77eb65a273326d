#include "plugin/graphics/sound/wav.h"

#include "plugin/graphics/sound/synthesiser.h"

#include <cstdint>
#include <cstring>

namespace supercircle::sound {

namespace {

/// Little endian on every machine.
void put(std::string& out, std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
        out += static_cast<char>((value >> (8 * i)) & 255U);
}

} // namespace

std::string wav(std::span<const float> samples) {
    constexpr std::uint32_t kFloat = 3, kSample = 4, kFormat = 18, kFact = 4;
    const auto data = static_cast<std::uint32_t>(kSample * samples.size());
    std::string out = "RIFF";
    put(out, 4 + 8 + kFormat + 8 + kFact + 8 + data, 4);
    out += "WAVEfmt ";
    put(out, kFormat, 4);
    put(out, kFloat, 2);
    put(out, 1, 2); // channel
    put(out, kRate, 4);
    put(out, kSample * kRate, 4);
    put(out, kSample, 2);
    put(out, 8 * kSample, 2);
    put(out, 0, 2); // no extension
    out += "fact";
    put(out, kFact, 4);
    put(out, static_cast<std::uint32_t>(samples.size()), 4);
    out += "data";
    put(out, data, 4);
    for (const float s : samples) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &s, sizeof bits);
        put(out, bits, 4);
    }
    return out;
}

} // namespace supercircle::sound
