#include "engine/track/cloud_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// A count, chosen: positions that are drawn for a box of the sample, in a room full of furniture.
constexpr std::size_t kMaxDrawsPerBox = 1000;

// Multiples modulo 1: of the powers of the inverse of the root of x^3 = x + 1 they fill a square
// evenly, and so do any successive ones; of the golden ratio, the heights.
constexpr std::array<double, 3> kSequence{
    0.7548776662466927, 0.5698402909980532, 0.6180339887498949};

double of_sequence(std::size_t number, std::size_t axis) {
  const double value = 0.5 + static_cast<double>(number) * kSequence[axis];
  return value - std::floor(value);
}

// The height [m] below which a target is with this probability; even within a layer.
double height_at(const Grid& grid, double probability) {
  const HeightLayers& layers = grid.layers;
  std::size_t layer = 0;
  double rest = probability;
  while (layer + 1 < layers.size() && rest >= layers.weight[layer]) {
    rest -= layers.weight[layer];
    ++layer;
  }
  const double share = layers.weight[layer] > 0.0 ? rest / layers.weight[layer] : 0.5;
  return grid.first.z + layers.offset[layer] +
         layers.thickness * (std::clamp(share, 0.01, 0.99) - 0.5);
}

// The box of a number of the sequence, anywhere in the grid.
std::uint32_t box_of(const BoxLattice& lattice, std::size_t number) {
  const Grid& grid = lattice.grid();
  const double x = static_cast<double>(grid.count_x) * of_sequence(number, 0) - 0.5;
  const double y = static_cast<double>(grid.count_y) * of_sequence(number, 1) - 0.5;
  return lattice.box_at(static_cast<float>(grid.first.x + grid.step_x * x),
                        static_cast<float>(grid.first.y + grid.step_y * y),
                        static_cast<float>(height_at(grid, of_sequence(number, 2))));
}

std::vector<char> free_boxes(const BoxLattice& lattice, const FreeSpace& space) {
  std::vector<char> free(lattice.size());
  for (std::uint32_t box = 0; box < free.size(); ++box) {
    free[box] = space.free[lattice.cell(box)] != 0 ? 1 : 0;
  }
  if (std::count(free.begin(), free.end(), 1) == 0) {
    // No box has its middle in a free cell: all boxes count.
    std::fill(free.begin(), free.end(), 1);
  }
  return free;
}

}  // namespace

std::shared_ptr<const CloudRoom> make_cloud_room(std::shared_ptr<const Localizer> localizer,
                                                 std::shared_ptr<const FreeSpace> space) {
  if (!localizer->has_place_boxes()) {
    return nullptr;
  }
  const BoxLattice lattice(localizer->grid());
  RAYLOC_CHECK(space->free.size() == lattice.grid().size());
  const std::vector<char> free = free_boxes(lattice, *space);
  std::vector<CloudRoom::SampleBox> sample;
  for (std::size_t number = 0;
       sample.size() < kSampleBoxes && number < kMaxDrawsPerBox * kSampleBoxes;
       ++number) {
    const std::uint32_t box = box_of(lattice, number);
    if (box != BoxLattice::kNone && free[box] != 0) {
      sample.push_back({box, lattice.middle(box)});
    }
  }
  // If too few free boxes were drawn, the free boxes fill the sample in order, repeatedly.
  while (sample.size() < kSampleBoxes) {
    for (std::uint32_t box = 0; box < free.size() && sample.size() < kSampleBoxes; ++box) {
      if (free[box] != 0) {
        sample.push_back({box, lattice.middle(box)});
      }
    }
  }
  const auto boxes = static_cast<double>(std::count(free.begin(), free.end(), 1));
  return std::make_shared<const CloudRoom>(
      CloudRoom{std::move(localizer), std::move(space), lattice, std::move(sample), boxes});
}

}  // namespace rayloc
