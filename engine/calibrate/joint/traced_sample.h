// TracedSample: the rays from a surveyed point to every antenna of an access point, and the
// dependence of their delays and amplitudes on the unknowns of the room, to first order about the
// traced state.
//
// Delays in a room of planes are nearly linear in the offsets of the planes: over a centimetre the
// second order is less than a tenth of a millimetre of path. Amplitudes depend on materials.
// Changes in the set of existing paths take effect when the room is traced anew.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/room_unknowns.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// One unknown that a ray depends on.
struct RayTerm {
  std::uint32_t unknown = 0;
  double delay = 0.0;                  // d tau [s] per unit
  std::complex<double> log_amplitude;  // d ln a per unit
};

struct LinearRay {
  std::complex<double> amplitude;  // Path::a, without propagation phase
  double delay = 0.0;              // [s]
  std::array<double, 3> survey{};  // d tau [s / m] by the device's position
  std::uint32_t first_term = 0;
  std::uint32_t end_term = 0;
};

struct TracedSample {
  std::size_t point = 0;  // index of the CalibrationPoint
  std::size_t access_point = 0;
  std::vector<std::vector<LinearRay>> rays;  // for each antenna
  std::vector<RayTerm> terms;
  std::uint32_t coupling = 0;  // index of the first antenna coupling unknown

  std::span<const RayTerm> terms_of(const LinearRay& ray) const {
    return std::span(terms).subspan(ray.first_term, ray.end_term - ray.first_term);
  }
};

struct SampleSite {
  std::size_t point = 0;
  std::size_t access_point = 0;
  Vec3d position;  // [m]
};

// Traces `room`, which is changed_room() of the original; unknowns are those of the original.
// Rays that carry less than `kNegligible` of an antenna's power are left out.
inline constexpr double kNegligible = 3e-6;
Expected<std::vector<TracedSample>> trace_samples(const RoomModel& room,
                                                  const RoomUnknowns& unknowns,
                                                  std::span<const SampleSite> sites,
                                                  const TraceOptions& options);

}  // namespace rayloc
