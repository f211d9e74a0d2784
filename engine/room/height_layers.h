// HeightLayers: the heights that a device may be at, as layers about the usual one.
//
// A device's height is an unknown with a normal prior (DeviceModel). The layers fill what is
// probable of it and the room; nothing is kept for each layer of each cell of a room.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/room/room_model.h"

namespace rayloc {

struct HeightLayers {
  std::vector<double> offset;  // [m], of each layer's middle from DeviceModel::height
  std::vector<double> weight;  // prior probability, 1 in all
  double thickness = 0.0;      // [m]; 0: the height is known, and there is one layer

  std::size_t size() const { return offset.size(); }
  bool is_known() const { return thickness <= 0.0; }
};

// Those of `device` in a room whose floor and ceiling are at these heights [m].
HeightLayers height_layers(const DeviceModel& device, double floor, double ceiling);

// Heights within a layer that are looked at one by one: offsets from DeviceModel::height [m] and
// their share of the layer's probability, 1 in all. No more than `most` [m] apart.
struct HeightSlice {
  double offset = 0.0;
  double weight = 1.0;
};
std::vector<HeightSlice> slices_of(const HeightLayers& layers,
                                   std::size_t layer,
                                   double sigma,
                                   double most);

}  // namespace rayloc
