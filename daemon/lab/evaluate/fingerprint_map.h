// FingerprintMap: the control without a model: the surveyed point at which the access points'
// observations are most similar to the present ones.
//
// A fingerprint is the preprocessed burst at every access point (observe/burst.h),
// chain gains included. The distance of two is 1 - their correlation at the best
// delay and factor, summed over the selected access points; it is 1 if only one of
// the two was observed. The chains must not have been power-cycled in between.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/observe/alignment.h"

namespace rayloc {

class FingerprintMap {
 public:
  struct AccessPoint {
    std::size_t index = 0;                // CsiFrame::access_point
    std::vector<std::uint8_t> rx_chains;  // rx chains to use
  };
  FingerprintMap(const OfdmGrid& grid, std::vector<AccessPoint> access_points);

  // `frames`: of one transmitter stationary at that position, in order of time at each access
  // point. Returns false if none is usable: the point is left out.
  bool add(const Vec3d& position, std::span<const CsiFrame> frames);
  std::size_t size() const { return points_.size(); }

  // The most similar point; empty if no frame can be used, or there is no point.
  std::optional<Vec3d> nearest(std::span<const CsiFrame> frames) const;

 private:
  // By number in access_points_; empty: not observed.
  using Fingerprint = std::vector<std::vector<std::complex<double>>>;
  struct Point {
    Vec3d position;
    Fingerprint fingerprint;
  };

  std::optional<Fingerprint> take(std::span<const CsiFrame> frames) const;
  double distance(const Fingerprint& a, const Fingerprint& b) const;

  OfdmGrid grid_;
  std::vector<AccessPoint> access_points_;
  Aligner aligner_;
  std::vector<Point> points_;
};

}  // namespace rayloc
