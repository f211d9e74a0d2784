// The small languages within the attributes of SVG: lengths, transforms, points and paths (W3C, SVG
// 1.1 chapters 4.2, 7.6, 9.7 and 8.3).
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "daemon/import/drawing.h"
#include "daemon/import/placing.h"

namespace rayloc {

// "12", "3.5mm", "80%".
struct SvgLength {
  double number = 0.0;
  std::string_view unit;
  // [m] on paper; 0 of pixels, percents and bare numbers.
  double metres() const;
};
std::optional<SvgLength> svg_length(std::string_view text);

// Numbers with spaces or commas between them; nothing where something else stands there.
std::optional<std::vector<double>> svg_numbers(std::string_view text);

// "translate(10, 20) rotate(90)"; nothing where it is no such list.
std::optional<Placing> svg_transform(std::string_view text);

// Each part of a path that begins with a move, without its layer. Curves of Bezier are taken as
// kPieces chords, arcs of ellipses as those of chords_of(). Nothing where it is no path.
inline constexpr int kPieces = 8;  // a count, chosen: a quarter of a circle is 0.5 % off
std::optional<std::vector<DrawnLine>> svg_path(std::string_view text);

}  // namespace rayloc
