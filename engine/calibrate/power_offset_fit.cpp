#include "engine/calibrate/power_offset_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/likelihood/received_power.h"
#include "engine/room/ray.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

// Powers are reported in whole decibels: no spread is known better than this.
constexpr double kMinSigma = 0.5;  // [dB]

}  // namespace

std::optional<PowerOffsetFit> fit_power_offset(const RoomModel& room,
                                               std::size_t access_point,
                                               std::span<const PowerSample> samples) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  const ReceiverTracer tracer =
      PathTracer(room.scene, room.trace).at(array_origin<Receiver>(ap.array));
  std::vector<double> off;
  for (const PowerSample& sample : samples) {
    const Transmitter device{{sample.position, {}, room.device.pattern, room.device.polarization}};
    const auto rays = rays_of(tracer.trace(device), room, sample.position, kMaxRays);
    if (!rays.empty()) {
      off.push_back(sample.power_dbm - traced_power_db(rays, ap.error));
    }
  }
  if (off.size() < kMinPowerSamples) {
    return std::nullopt;
  }
  const auto count = static_cast<double>(off.size());
  double mean = 0.0;
  for (const double one : off) {
    mean += one / count;
  }
  double variance = 0.0;
  for (const double one : off) {
    variance += (one - mean) * (one - mean) / (count - 1.0);
  }
  return PowerOffsetFit{mean, std::max(std::sqrt(variance), kMinSigma), off.size()};
}

}  // namespace rayloc
