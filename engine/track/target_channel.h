// TargetChannel: how much the channel of a target differs from the remembered one, and whether the
// target must have moved for that.
//
// Each access point has a remembered array of its own, since access points may receive different
// moments. Used by one thread at a time.
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
    // Share of the power that differs when the device has moved by a quarter of the wavelength.
    double moved_change = 0.0;
  };
  TargetChannel(const OfdmGrid& grid, const Limits& limits) : aligner_(grid), limits_(limits) {}

  // Shares of the power, means over the access points with a remembered array.
  struct Change {
    double power = 0.0;         // that differs, above 0
    double unmoved = 0.0;       // that noise and the radio explain
    bool is_of_all = false;     // each array of the moment has a remembered one
    bool shows_motion = false;  // noise and the radio are too small to hide a movement
    // It would show a movement, and noise and the radio explain the changes of all arrays.
    bool is_rest = false;
  };
  // Empty if no access point has a remembered array.
  std::optional<Change> of(const RoomObservation& observation) const;
  // 0: the change is explained by noise and the radio, 1: the device must have moved.
  double motion_of(const Change& change) const;

  // The next moments are compared with these arrays; those of other access points stay.
  void remember(const RoomObservation& observation);
  void forget() { remembered_.clear(); }

 private:
  struct Earlier {
    std::size_t ap = 0;                   // ArrayObservation::ap
    std::vector<std::complex<double>> h;  // ArrayObservation::h
    double captured = 0.0;                // ObservedArray::captured
  };
  // That of the same access point and size; null without one.
  const Earlier* earlier_of(const ArrayObservation& array) const;

  Aligner aligner_;
  Limits limits_;
  std::vector<Earlier> remembered_;  // one for each access point and size of its arrays
};

}  // namespace rayloc
