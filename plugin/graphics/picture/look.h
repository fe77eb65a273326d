#pragma once
// Colours and sizes of pictures of a world (private to picture/). Sizes are px on an ordinary screen.

#include "plugin/graphics/canvas.h"

namespace supercircle::picture::look {

using graphics::Colour;

inline constexpr Colour ground = Colour::hex(0x151a22);
inline constexpr Colour outline = Colour::hex(0x0a0d12); ///< round shells: tells nested ones apart
inline constexpr Colour light = Colour::hex(0xffffff);
inline constexpr Colour shadow = Colour::hex(0x000000, 0.34);
inline constexpr Colour still = Colour::hex(0x2a323e), stillEdge = Colour::hex(0x5d6b7d);
inline constexpr Colour driven = Colour::hex(0x3b5170), drivenEdge = Colour::hex(0x9dbbe2);
inline constexpr Colour loose = Colour::hex(0x5b4a33), looseEdge = Colour::hex(0xd0a868);
inline constexpr Colour contact = Colour::hex(0x63e6d2);
inline constexpr Colour hold = Colour::hex(0x9be37a);
inline constexpr Colour flash = Colour::hex(0xffd9a0);
inline constexpr Colour snapText = Colour::hex(0xfff3d6);

inline constexpr double thinnest = 1.6; ///< half width of a shell at least
inline constexpr double gap = 1.2;      ///< of the dark outline
inline constexpr double rim = 1.1;
inline constexpr double edge = 1.2; ///< half width of the edges of bodies, of which the outer half is seen
inline constexpr double mark = 2.2; ///< radius of a contact
inline constexpr double shadowShift = 3.0;
inline constexpr double snapSize = 15.0; ///< of the text
inline constexpr double flashRadius = 70.0;
inline constexpr double flashStrength = 0.75;

} // namespace supercircle::picture::look
