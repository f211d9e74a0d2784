// ThousandCells: whitens a thousand cells that are adjacent in memory, eight delays and two means
// each and nothing else: the unit in which two machines agree.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/lane_kernel.h"

namespace rayloc::bench {

class ThousandCells {
 public:
  // dimension: of each cell, as ObservationModel::dimension().
  explicit ThousandCells(std::size_t dimension)
      : terms_(dimension * (dimension + 1) / 2),
        whitener_(kCells * terms_, {0.5F, 0.25F}),
        along_(2 * dimension, {0.5F, 0.5F}),
        y_(dimension) {
    for (LaneRow& row : y_) {
      row.fill(0.25F);
    }
  }

  // The sum of the cells' powers at one delay: a use of the results.
  float whiten_all() const {
    float sum = 0.0F;
    for (std::size_t n = 0; n < kCells; ++n) {
      fetch(std::span(whitener_).subspan((n + 1) % kCells * terms_, terms_));
      std::array<LaneSums, 2> sums;
      sum += whiten(whitener_.data() + n * terms_, y_, y_, along_, sums)[0];
    }
    return sum;
  }

 private:
  static constexpr std::size_t kCells = 1000;

  std::size_t terms_;  // of a triangle
  std::vector<std::complex<float>> whitener_;
  std::vector<std::complex<float>> along_;
  std::vector<LaneRow> y_;
};

}  // namespace rayloc::bench
