// Drawing: a picture as a list of shapes, painted in their order. svg.h and png.h write it to
// files, so that both formats show the same.
//
// Coordinates are those of the page: x to the right, y down, in units of one pixel at scale 1.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rayloc::draw {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  double opacity = 1.0;

  friend bool operator==(const Colour&, const Colour&) = default;
};

struct PagePoint {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const PagePoint&, const PagePoint&) = default;
};

struct Pen {
  Colour colour;
  double width = 1.0;
  bool dashed = false;
};

struct Polygon {
  std::vector<PagePoint> corners;
  Colour fill;
};

struct Line {
  std::vector<PagePoint> points;
  Pen pen;
};

struct Circle {
  PagePoint centre;
  double radius = 1.0;
  Colour fill;
  std::optional<Pen> outline;
};

enum class TextAnchor : std::uint8_t { kStart, kMiddle, kEnd };

struct Text {
  PagePoint at;  // on the base line
  std::string text;
  double size = 11.0;
  Colour colour;
  TextAnchor anchor = TextAnchor::kStart;
  bool bold = false;
  double degrees = 0.0;  // anticlockwise about `at`
  bool halo = false;     // white outline, for text on top of lines
};

using Shape = std::variant<Polygon, Line, Circle, Text>;

inline void append_shapes(std::vector<Shape> more, std::vector<Shape>& shapes) {
  std::move(more.begin(), more.end(), std::back_inserter(shapes));
}

struct Drawing {
  double width = 0.0;
  double height = 0.0;
  std::vector<Shape> shapes;
};

// Approximate width of a text: independent of fonts, so that a picture is the same everywhere.
double text_width(const std::string& text, double size);

}  // namespace rayloc::draw
