// Labels: places names without overlaps.
#pragma once

#include <string>
#include <vector>

#include "daemon/site/plan/drawing.h"

namespace rayloc::draw {

class Labels {
 public:
  // Keeps the first of `places` (texts that differ in place, size or direction) that is clear of
  // all labels so far; none if all are taken.
  void place(const std::vector<Text>& places);

  // Marks the area of an existing text as occupied.
  void reserve(const Text& text) { occupied_.push_back(extent(text)); }

  const std::vector<Text>& texts() const { return texts_; }

 private:
  struct Extent {
    PagePoint lower;
    PagePoint upper;
  };

  static Extent extent(const Text& text);
  bool is_clear(const Extent& extent) const;

  std::vector<Text> texts_;
  std::vector<Extent> occupied_;
};

}  // namespace rayloc::draw
