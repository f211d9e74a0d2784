// HeightLayers: the possible heights of a device, as layers about the nominal one.
//
// A device's height is an unknown with a normal prior (DeviceModel). The layers cover the probable
// heights inside the room; nothing is stored for each layer of each cell of a room.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/room/room_model.h"

namespace rayloc {

struct HeightLayers {
  std::vector<double> offset;  // [m], middle of each layer relative to DeviceModel::height
  std::vector<double> weight;  // prior probability of each layer, sum 1
  double thickness = 0.0;      // [m]; 0: the height is known, one layer

  std::size_t size() const { return offset.size(); }
  bool is_known() const { return thickness <= 0.0; }
};

// The layers for `device` in a room whose floor and ceiling are at these heights [m].
HeightLayers height_layers(const DeviceModel& device, double floor, double ceiling);

// Heights within a layer that are evaluated one by one: offsets from DeviceModel::height [m] and
// shares of the layer's probability, sum 1. They are at most `most` [m] apart.
struct HeightSlice {
  double offset = 0.0;
  double weight = 1.0;
};
std::vector<HeightSlice> slices_of(const HeightLayers& layers,
                                   std::size_t layer,
                                   double sigma,
                                   double most);

}  // namespace rayloc
