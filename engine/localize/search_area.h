// The places that a localizer compares: the calibrated area (RoomModel::bounds), and a margin
// around it that the scene covers.
//
// A single access point has no other one to contradict it: a device outside the area resembles one
// at some place inside. If the scene extends beyond the area, places there are compared as well,
// and the mass that they explain is the probability that the device is outside the area.
#pragma once

#include <vector>

#include "engine/grid/cell_set.h"
#include "engine/grid/grid.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SearchArea {
  // Outlier probability above which there is no fix, ...
  static constexpr double kMaxOutlierShare = 2.0 / 3.0;
  // ... and the reason reported if the device is outside the area.
  static constexpr const char* kBeside =
      "the device is beside the area: the scene explains it better there";

  Grid grid;
  std::vector<char> inside;  // [cell], 1 in the calibrated area; empty: all are
};

// Cells of 5 cm, or of a 12000th of the area. Extends up to 2 m beyond the area if the scene
// reaches at least half a metre beyond it.
SearchArea search_area(const RoomModel& room);

// The probability of the cells outside the area, from a map of log-likelihoods; their cells are set
// to AccessPointFusion::kNothing. cells: the cells of the map.
double take_outside(const SearchArea& area,
                    double likelihood_exponent,
                    std::vector<double>& log_likelihood,
                    const CellSet& cells = {});

}  // namespace rayloc
