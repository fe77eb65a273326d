#pragma once
// Colours and font sizes of all figures.

#include "plugin/graphics/canvas.h"

namespace supercircle::graphics::theme {

inline constexpr Colour ink = Colour::hex(0x1b1f24);
inline constexpr Colour muted = Colour::hex(0x57606a);
inline constexpr Colour grid = Colour::hex(0xe7eaee);
inline constexpr Colour axis = Colour::hex(0x8c959f);
inline constexpr Colour loading = Colour::hex(0xc8452d);
inline constexpr Colour unloading = Colour::hex(0x2a6fb8);
inline constexpr Colour body = Colour::hex(0xdadee3);
inline constexpr Colour bodyEdge = Colour::hex(0xb4bcc5);
inline constexpr Colour driven = Colour::hex(0x78828e);
inline constexpr Colour drivenEdge = Colour::hex(0x5a646f);
inline constexpr Colour paper = Colour::hex(0xffffff);

inline constexpr double tickSize = 12.0;  ///< font, px
inline constexpr double labelSize = 13.0; ///< font, px
inline constexpr double titleSize = 17.0; ///< font, px

} // namespace supercircle::graphics::theme
