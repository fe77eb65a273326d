#pragma once
// Draws shells with a b2Draw; see the public header.

#include "bridge/box2d/include/supercircle/box2d_draw.hpp"
