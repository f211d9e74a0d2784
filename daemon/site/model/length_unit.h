// Units in which lengths are written by mistake instead of metres.
#pragma once

#include <array>
#include <string_view>

namespace rayloc {

struct LengthUnit {
  std::string_view name;
  double metres = 1.0;
};

// In order of closeness to the metre.
inline constexpr std::array<LengthUnit, 4> kMistakenUnits = {
    {{"feet", 0.3048}, {"inches", 0.0254}, {"centimetres", 0.01}, {"millimetres", 0.001}}};

}  // namespace rayloc
