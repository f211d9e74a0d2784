// TargetChannel: how much the channel of a target differs from that of a remembered moment, and
// whether the target must have moved for that.
//
// Used by one thread at a time.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/localize/array_observation.h"
#include "engine/observe/alignment.h"

namespace rayloc {

class TargetChannel {
 public:
  struct Limits {
    // Share of the power that differs between two moments of a device at rest, beyond their noise;
    // from `walking_ratio` times as much on, the device certainly walks.
    double still_change = 0.0;
    double walking_ratio = 0.0;  // above 1
  };
  TargetChannel(const OfdmGrid& grid, const Limits& limits) : aligner_(grid), limits_(limits) {}

  // Share of the power that differs from the remembered moment, above 0: the mean over the access
  // points present in both. Empty if there is none.
  std::optional<double> of(const RoomObservation& observation) const;
  // Largest change that noise and the radio explain.
  double unmoved(const RoomObservation& observation) const;
  // 0: the change is explained by noise and the radio, 1: the device must have moved.
  double motion_of(double change, const RoomObservation& observation) const;

  // The next moments are compared with this one.
  void remember(const RoomObservation& observation);
  void forget() { last_.clear(); }

 private:
  struct Earlier {
    std::size_t ap = 0;                   // ArrayObservation::ap
    std::vector<std::complex<double>> h;  // ArrayObservation::h
  };

  Aligner aligner_;
  Limits limits_;
  std::vector<Earlier> last_;  // arrays of the remembered moment
};

}  // namespace rayloc
