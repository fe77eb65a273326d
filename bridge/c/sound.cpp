// Sound of a world: samples for pages and files.

#include "bridge/c/world.h"
#include "plugin/graphics/sound/wav.h"

using namespace supercircle::c;
namespace sound = supercircle::sound;

namespace {

constexpr int32_t kMostSamples = 1 << 28; ///< of a WAV file: its sizes have 32 bits

} // namespace

sc_status sc_sound_make(sc_world w, double seconds) {
    return use(w, [&](World& x) {
        if (!(seconds >= 0.0 && seconds <= sound::kMostSeconds))
            refuse(SC_BAD_INPUT, "seconds must be 0 to 10: call more often for more");
        (void)x.sound.make(x.shells, seconds);
    });
}

const float* sc_sound_samples(sc_world w, int32_t* count) {
    return valueIn<const float*>(w, nullptr, [&](World& x) {
        int32_t& n = given(count, "the count");
        if (!x.sound.on())
            refuse(SC_REFUSED, "there are no samples yet: call sc_sound_make");
        static const float none = 0.0F; // an address in any case
        n = static_cast<int32_t>(x.sound.samples().size());
        return n > 0 ? x.sound.samples().data() : &none;
    });
}

int32_t sc_sound_wav(const float* samples, int32_t count, uint8_t* out, int32_t capacity) {
    return counted([&] {
        requireBuffer(out, capacity);
        if (count < 0 || count > kMostSamples || (samples == nullptr && count > 0))
            refuse(SC_BAD_INPUT, "samples are null, or their count is negative or above 268435456");
        const std::string file = sound::wav({samples, static_cast<std::size_t>(count)});
        return copyOut(file, out, capacity, [](char c) { return static_cast<uint8_t>(c); });
    });
}
