#include "engine/localize/box_lattice.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kBoxSide = 0.1;    // [m], chosen: the covariance hardly changes over a box
constexpr double kBoxHeight = 0.3;  // [m], chosen: directions change less with the height
// A share of a cell, chosen: a box is wider than kBoxSide by at most this. Cells wider than
// kBoxSide are boxes of their own.
constexpr double kRoundUp = 0.3;

// Index of a coordinate among `count` steps from `first` on; count: outside.
std::size_t step_of(float at, double first, double step, std::size_t count) {
  const float position = (at - static_cast<float>(first)) / static_cast<float>(step);
  if (!(position >= 0.0F)) {
    return count;
  }
  return std::min(static_cast<std::size_t>(std::min(position, static_cast<float>(count))), count);
}

double middle_of(std::size_t first, std::size_t last) {
  return 0.5 * static_cast<double>(first + last);
}

}  // namespace

BoxLattice::BoxLattice(const Grid& grid) : grid_(grid) {
  const double cell = std::sqrt(grid.step_x * grid.step_y);
  block_ = std::max<std::size_t>(1, static_cast<std::size_t>(kBoxSide / cell + kRoundUp));
  count_x_ = (grid.count_x + block_ - 1) / block_;
  count_y_ = (grid.count_y + block_ - 1) / block_;
  const HeightLayers& layers = grid.layers;
  if (!layers.is_known()) {
    const double range = layers.thickness * static_cast<double>(layers.size());
    layers_ = static_cast<std::size_t>(std::max(1.0, std::round(range / kBoxHeight)));
    low_ = grid.first.z + layers.offset.front() - 0.5 * layers.thickness;
    thickness_ = range / static_cast<double>(layers_);
  }
  RAYLOC_CHECK(size() < kNone);
}

std::uint32_t BoxLattice::box_at(float x, float y, float z) const {
  const std::size_t cell = grid_.cell_at(static_cast<double>(x), static_cast<double>(y));
  const std::size_t layer = is_height_known() ? 0 : step_of(z, low_, thickness_, layers_);
  if (cell == grid_.size() || layer == layers_) {
    return kNone;
  }
  const std::size_t column =
      cell / grid_.count_y / block_ * count_y_ + cell % grid_.count_y / block_;
  return static_cast<std::uint32_t>(column * layers_ + layer);
}

BoxLattice::Cells BoxLattice::cells_x(std::uint32_t box) const {
  const std::size_t first = box / layers_ / count_y_ * block_;
  return {first, std::min(first + block_, grid_.count_x) - 1};
}

BoxLattice::Cells BoxLattice::cells_y(std::uint32_t box) const {
  const std::size_t first = box / layers_ % count_y_ * block_;
  return {first, std::min(first + block_, grid_.count_y) - 1};
}

Vec3d BoxLattice::middle(std::uint32_t box) const {
  const Cells x = cells_x(box);
  const Cells y = cells_y(box);
  const double z = is_height_known()
                       ? grid_.first.z
                       : low_ + thickness_ * (static_cast<double>(box % layers_) + 0.5);
  return {grid_.first.x + grid_.step_x * middle_of(x.first, x.last),
          grid_.first.y + grid_.step_y * middle_of(y.first, y.last),
          z};
}

Vec3d BoxLattice::half() const {
  const double side = 0.5 * static_cast<double>(block_);
  return {side * grid_.step_x, side * grid_.step_y, 0.5 * thickness_};
}

std::size_t BoxLattice::cell(std::uint32_t box) const {
  const Cells x = cells_x(box);
  const Cells y = cells_y(box);
  return (x.first + x.last) / 2 * grid_.count_y + (y.first + y.last) / 2;
}

}  // namespace rayloc
