#pragma once

#include <span>
#include <string>

namespace supercircle::sound {

/// A WAV file: mono, kRate samples a second, 32-bit floats, so that it has the samples as they are.
[[nodiscard]] std::string wav(std::span<const float> samples);

} // namespace supercircle::sound
