// FingerprintMap: the control that needs no model: the surveyed point where the access points heard
// what is most like what they hear now.
//
// A fingerprint is what is left of a burst at every access point (observe/burst.h), chain gains and
// all. Two of them are apart by 1 - their correlation at the best delay and factor, summed over the
// access points that were asked for; by 1 where only one of the two was heard. The chains must not
// have been switched off and on in between.
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
    int index = 0;                    // CsiFrame::access_point
    std::vector<std::uint8_t> cores;  // the chains to use
  };
  FingerprintMap(const OfdmGrid& grid, std::vector<AccessPoint> access_points);

  // `frames`: of one transmitter standing still there, in order of time at each access point.
  // False when nothing of them can be used: the point is left out.
  bool add(const Vec3d& position, std::span<const CsiFrame> frames);
  std::size_t size() const { return points_.size(); }

  // The most similar point; nothing when no frame can be used, or there is no point.
  std::optional<Vec3d> nearest(std::span<const CsiFrame> frames) const;

 private:
  // By number in access_points_; empty: not heard.
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
