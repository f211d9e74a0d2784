// Colours of materials and of powers.
#pragma once

#include <cstddef>
#include <string>

#include "daemon/site/plan/drawing.h"

namespace rayloc::draw {

inline constexpr Colour kInk{40, 40, 40, 1.0};
inline constexpr Colour kFaintInk{120, 120, 120, 1.0};
inline constexpr Colour kReceiverInk{20, 70, 160, 1.0};
inline constexpr Colour kTransmitterInk{20, 120, 60, 1.0};

// The usual colour of the materials of ITU-R P.2040-4;
// any other name gets a fixed one of some muted colours.
Colour material_colour(const std::string& name);

// From the weakest (0, pale) to the strongest (1, dark): monotonic in grey, too.
Colour power_colour(double share);

// A positive share: 0 dark violet, 1 yellow; brighter for larger values, in grey too.
Colour share_colour(double share);

// A signed value: -1 blue, 0 pale grey, 1 red.
Colour signed_colour(double value);

// Curve colours that most colour-blind people can distinguish; they repeat after six.
Colour curve_colour(std::size_t number);

// Each channel multiplied by the factor; 1 leaves the colour unchanged.
Colour shaded(const Colour& colour, double factor);

}  // namespace rayloc::draw
