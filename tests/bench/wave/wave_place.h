// WavePlace: all traced waves of a device at a surveyed point and one access point: rays, rays over
// one edge, and the scattering of rough surfaces. wave_bench compares likelihoods by it.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/diffuse/diffuse_tracer.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::bench {

// A count of densities: scattered once, and the same with one reflection before or after.
inline constexpr std::size_t kDensities = 2;
inline constexpr double kBin = 1e-9;       // [s], of a density, chosen: a sixth of 160 MHz's
inline constexpr std::size_t kBins = 110;  // a count, chosen: beyond the window of DelayBasis

// A ray over one edge, which no mirror image has: each antenna receives its own. Also a ray of more
// reflections than a likelihood models.
struct EdgeRay {
  Ray ray;  // to the array's centre; the edge counts as a reflection
  // Of each antenna: the amplitude over that of the centre, and how much longer the way is [m].
  std::vector<std::complex<double>> factor;
  std::vector<double> longer;
};

// Power by delay after the first ray, with its covariance over the antennas:
// [bin][antenna][antenna].
struct DensityBins {
  std::vector<std::complex<double>> covariance;
  double power = 0.0;  // of all echoes, share of the power of the rays
};

struct WavePlace {
  std::vector<Ray> rays;        // strongest first, as a likelihood has them
  std::vector<EdgeRay> edges;   // strongest first
  std::vector<EdgeRay> deeper;  // of one interaction more than rays, strongest first
  std::array<DensityBins, kDensities> density;
};

struct WaveOptions {
  bool edges = true;
  std::size_t densities = 1;  // of kDensities; 0: none
};

// Traces the WavePlace of a device at one access point.
class WaveTracer {
 public:
  WaveTracer(const RoomModel& room,
             const RoomAccessPoint& access_point,
             const WaveOptions& options);

  WavePlace trace(const Vec3d& device) const;
  // The channel of the edges alone at that place, [antenna][tone], each edge with its share
  // `known`; phases count from a ray of length `first_length` [m].
  std::vector<std::complex<double>> edge_csi(const WavePlace& place,
                                             std::span<const double> known,
                                             double first_length) const;
  // The channel that the access point would receive in this room, edges included: [antenna][tone].
  // REQUIRES: edges.
  std::vector<std::complex<double>> edge_recording(const Vec3d& device) const;

 private:
  Transmitter transmitter_at(const Vec3d& device) const;
  std::vector<EdgeRay> edges_to(const Transmitter& device) const;
  std::vector<EdgeRay> deeper_to(const Transmitter& device, const WavePlace& place) const;
  DensityBins bins_of(const DiffuseDensity& density, const WavePlace& place) const;

  const RoomModel& room_;
  const RoomAccessPoint& access_point_;
  std::vector<Vec3d> offsets_;
  ReceiverTracer tracer_;
  ReceiverTracer deeper_;
  std::unique_ptr<const ReceiverTracer> edge_centre_;
  std::unique_ptr<const ArrayTracer> edge_array_;
  std::vector<DiffuseTracer> diffuse_;
};

}  // namespace rayloc::bench
