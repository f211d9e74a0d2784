#include "daemon/lab/calibrate/power_offset_stage.h"

#include <string>

#include "engine/calibrate/power_offset_fit.h"
#include "engine/observe/burst.h"

namespace rayloc {
namespace {

// Received powers of a transmitter's bursts, with the positions of the transmitter.
std::vector<PowerSample> power_samples(const MacAddress& transmitter,
                                       const BurstRequest& request,
                                       std::span<const HeldOutPoint> points) {
  std::vector<PowerSample> samples;
  for (const HeldOutPoint& point : points) {
    if (point.frames.front().transmitter != transmitter) {
      continue;
    }
    const auto burst = combine_burst(point.frames, request);
    if (burst && burst->power_dbm) {
      samples.push_back({point.position, *burst->power_dbm});
    }
  }
  return samples;
}

}  // namespace

std::vector<TransmitterPower> fit_power_offsets(const Site& site,
                                                const RoomModel& room,
                                                const AccessPointResult& result,
                                                std::span<const HeldOutPoint> points,
                                                std::vector<RefusedInput>& refused) {
  RoomModel fitted = room;  // with the diffuse power that the localizer will use
  RoomAccessPoint& ap = fitted.access_points[result.index];
  apply(result.fit, ap);
  const BurstRequest request{result.index, fitted.grid, ap.rx_chains, {}};
  std::vector<TransmitterPower> powers;
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (!transmitter.constant_power || transmitter.role != TransmitterRole::kDevice) {
      continue;
    }
    const auto samples = power_samples(transmitter.mac, request, points);
    if (const auto fit = fit_power_offset(fitted, result.index, samples)) {
      powers.push_back({transmitter.mac, fit->offset_db, fit->sigma_db});
    } else {
      refused.push_back({ap.id + " " + to_string(transmitter.mac),
                         "its constant power is not used: " + std::to_string(samples.size()) +
                             " points state a level, " + std::to_string(kMinPowerSamples) +
                             " are needed"});
    }
  }
  return powers;
}

}  // namespace rayloc
