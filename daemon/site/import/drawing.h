// Drawing: the lines of a flat drawing, in its own unit.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "engine/base/outline.h"

namespace rayloc {

inline constexpr std::size_t kMaxDrawnPoints = 2'000'000;  // chosen: drawing of a city

struct DrawnLine {
  std::string layer;
  std::vector<FloorPoint> points;  // at least two
  bool is_closed = false;          // the last is joined to the first
};

struct Drawing {
  std::vector<DrawnLine> lines;
  std::set<std::string> empty_layers;
  std::set<std::string> hidden_layers;  // whose lines were left out
  double metres = 0.0;                  // per unit, as the file states; 0: not stated
  std::vector<std::string> remarks;     // omitted content, as messages for a person
};

}  // namespace rayloc
