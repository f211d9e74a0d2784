// The places that a localizer compares: the calibrated area (RoomModel::bounds), and what the scene
// knows beside it.
//
// One access point contradicts nobody: a device beyond the area is heard like one at some place
// within. Where the scene reaches further than the area, places there are compared as well, and
// what they explain is probability that the device is not in the area.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/posterior.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct WatchedArea {
  // A probability that the device is not there: with more of it there is no fix, ...
  static constexpr double kMostElsewhere = 2.0 / 3.0;
  // ... where it is beside the area for this reason.
  static constexpr const char* kBeside =
      "the device is beside the area: the scene explains it better there";

  RoomGrid grid;
  std::vector<char> inside;  // [cell], of the calibrated area; empty: all are
};

// Cells of 5 cm, or of a 12000th of the area. Beside the area up to 2 m, where the scene reaches
// half a metre beyond it or more.
WatchedArea watched_area(const RoomModel& room);

// The probability of the cells that are not in the area, by a map of log-likelihoods; their cells
// become AccessPointFusion::kNothing. cells: those that the map is of; empty: all.
double take_outside(const WatchedArea& area,
                    double likelihood_exponent,
                    std::vector<double>& log_likelihood,
                    std::span<const std::size_t> cells = {},
                    const CellWeights& weights = {});

}  // namespace rayloc
