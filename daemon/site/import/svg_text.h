// Parsers of the values of SVG attributes: lengths, transforms, points and paths (W3C, SVG 1.1
// chapters 4.2, 7.6, 9.7 and 8.3).
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/placing.h"

namespace rayloc {

// "12", "3.5mm", "80%".
struct SvgLength {
  double number = 0.0;
  std::string_view unit;
  // [m] on paper; 0 for pixels, percents and bare numbers.
  double metres() const;
};
std::optional<SvgLength> svg_length(std::string_view text);

// Numbers separated by spaces or commas; empty if there is any other text.
std::optional<std::vector<double>> svg_numbers(std::string_view text);

// "translate(10, 20) rotate(90)"; empty if it is no such list.
std::optional<Placing> svg_transform(std::string_view text);

// Each part of a path that begins with a move, without its layer. Bezier curves are converted to
// kPieces chords, arcs of ellipses to those of chords_of(). Empty if it is no path.
inline constexpr int kPieces = 8;  // count, chosen: a quarter of a circle is 0.5 % off
std::optional<std::vector<DrawnLine>> svg_path(std::string_view text);

}  // namespace rayloc
