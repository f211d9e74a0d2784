// Colours of materials and of powers.
#pragma once

#include <cstddef>
#include <string>

#include "daemon/draw/drawing.h"

namespace rayloc::draw {

inline constexpr Colour kInk{40, 40, 40, 1.0};
inline constexpr Colour kFaintInk{120, 120, 120, 1.0};
inline constexpr Colour kReceiverInk{20, 70, 160, 1.0};
inline constexpr Colour kTransmitterInk{20, 120, 60, 1.0};

// The usual colour of the materials of ITU-R P.2040-4; any other name has one of some muted ones,
// always the same.
Colour material_colour(const std::string& name);

// From the weakest (0, pale) to the strongest (1, dark): the darker the stronger also in grey.
Colour power_colour(double share);

// A share of something good: 0 dark violet, 1 yellow; brighter the larger also in grey.
Colour share_colour(double share);

// Of a sign and a size: -1 blue, 0 pale grey, 1 red.
Colour signed_colour(double value);

// Colours of curves that differ for most people who do not see all colours; they repeat after six.
Colour curve_colour(std::size_t number);

// Each channel multiplied; 1 leaves the colour as it is.
Colour shaded(const Colour& colour, double factor);

}  // namespace rayloc::draw
