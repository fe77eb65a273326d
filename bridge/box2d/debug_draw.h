#pragma once
// Shells in a picture that b2Draw makes: the public header has it all.

#include "bridge/box2d/include/supercircle/box2d_draw.hpp"
