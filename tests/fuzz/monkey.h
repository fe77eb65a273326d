#pragma once
// Plays with the public API the way no sane program would, driven by a tape of random bytes.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::fuzz {

/// What a session of play did.
struct Tally {
    std::uint64_t calls = 0;   ///< of the public API, refused ones included
    std::uint64_t refused = 0; ///< answered by an error
    std::uint64_t frames = 0;  ///< accepted pre_steps
    std::uint64_t replays = 0; ///< logs played again that had to end in the same state
    std::uint64_t events = 0;
    std::string broken; ///< empty, or the promise that was broken
    Tally& operator+=(const Tally& more);
};

/// Builds a Box2D world with shells and makes calls until the tape ends. Broken promises are reported, crashes crash.
Tally play(const std::vector<std::uint8_t>& tape);

} // namespace supercircle::fuzz
