#include "daemon/site/plan/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace rayloc::draw {
namespace {

constexpr std::array<std::pair<std::string_view, Colour>, 19> kMaterials{{
    {"asphalt_concrete", {150, 150, 150, 1.0}},
    {"brick", {201, 138, 111, 1.0}},
    {"carpet_tile", {184, 132, 132, 1.0}},
    {"ceiling_board", {236, 236, 232, 1.0}},
    {"chipboard", {214, 186, 138, 1.0}},
    {"clear_acrylic", {190, 222, 236, 0.7}},
    {"concrete", {188, 188, 180, 1.0}},
    {"floorboard", {205, 162, 104, 1.0}},
    {"glass", {160, 208, 232, 0.7}},
    {"marble", {222, 214, 226, 1.0}},
    {"medium_dry_ground", {186, 164, 116, 1.0}},
    {"metal", {140, 160, 176, 1.0}},
    {"plasterboard", {232, 226, 208, 1.0}},
    {"plywood", {219, 185, 128, 1.0}},
    {"very_dry_ground", {208, 190, 142, 1.0}},
    {"vacuum", {255, 255, 255, 0.3}},
    {"vinyl_tile", {172, 172, 178, 1.0}},
    {"wet_ground", {142, 122, 84, 1.0}},
    {"wood", {212, 170, 108, 1.0}},
}};
constexpr std::array<Colour, 6> kOthers{{{178, 190, 160, 1.0},
                                         {196, 172, 192, 1.0},
                                         {170, 190, 200, 1.0},
                                         {212, 196, 160, 1.0},
                                         {190, 178, 168, 1.0},
                                         {164, 186, 180, 1.0}}};
// ColorBrewer "OrRd", without its two palest colours.
constexpr std::array<Colour, 6> kPowers{{{253, 212, 158, 1.0},
                                         {253, 187, 132, 1.0},
                                         {252, 141, 89, 1.0},
                                         {227, 74, 51, 1.0},
                                         {179, 0, 0, 1.0},
                                         {110, 0, 0, 1.0}}};
// matplotlib "viridis", six of its colours.
constexpr std::array<Colour, 6> kShares{{{68, 1, 84, 1.0},
                                         {65, 68, 135, 1.0},
                                         {42, 120, 142, 1.0},
                                         {34, 168, 132, 1.0},
                                         {122, 209, 81, 1.0},
                                         {253, 231, 37, 1.0}}};
// ColorBrewer "RdBu", blue first, its middle darker for a white page.
constexpr std::array<Colour, 5> kSigned{{{5, 80, 160, 1.0},
                                         {90, 150, 205, 1.0},
                                         {205, 205, 205, 1.0},
                                         {230, 120, 90, 1.0},
                                         {165, 10, 30, 1.0}}};
// Okabe and Ito, without black and yellow.
constexpr std::array<Colour, 6> kCurves{{{0, 114, 178, 1.0},
                                         {213, 94, 0, 1.0},
                                         {0, 158, 115, 1.0},
                                         {204, 121, 167, 1.0},
                                         {86, 180, 233, 1.0},
                                         {230, 159, 0, 1.0}}};

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

// `share` 0 is the first colour, 1 the last.
template <std::size_t N>
Colour between(const std::array<Colour, N>& colours, double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(N - 1);
  const auto below = std::min(static_cast<std::size_t>(position), N - 2);
  const double part = position - static_cast<double>(below);
  const Colour& a = colours.at(below);
  const Colour& b = colours.at(below + 1);
  return {channel(a.red + part * (b.red - a.red)),
          channel(a.green + part * (b.green - a.green)),
          channel(a.blue + part * (b.blue - a.blue)),
          1.0};
}

}  // namespace

Colour material_colour(const std::string& name) {
  const auto found = std::find_if(
      kMaterials.begin(), kMaterials.end(), [&](const auto& each) { return each.first == name; });
  if (found != kMaterials.end()) {
    return found->second;
  }
  std::size_t sum = 0;
  for (const char c : name) {
    sum = sum * 31 + static_cast<unsigned char>(c);
  }
  return kOthers.at(sum % kOthers.size());
}

Colour power_colour(double share) { return between(kPowers, share); }

Colour share_colour(double share) { return between(kShares, share); }

Colour signed_colour(double value) { return between(kSigned, 0.5 * (value + 1.0)); }

Colour curve_colour(std::size_t number) { return kCurves.at(number % kCurves.size()); }

Colour shaded(const Colour& colour, double factor) {
  return {channel(factor * colour.red),
          channel(factor * colour.green),
          channel(factor * colour.blue),
          colour.opacity};
}

}  // namespace rayloc::draw
