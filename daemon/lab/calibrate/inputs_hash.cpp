#include "daemon/lab/calibrate/inputs_hash.h"

#include "engine/base/content_hash.h"
#include "engine/em/antenna_hash.h"

namespace rayloc {
namespace {

void add_access_point(ContentHash& hash, const RoomAccessPoint& ap) {
  hash.add(ap.id);
  const Pose& pose = ap.array.pose;
  hash.add(pose.position);
  hash.add(pose.orientation.yaw);
  hash.add(pose.orientation.pitch);
  hash.add(pose.orientation.roll);
  for (const Vec3d& offset : ap.array.element_offset) {
    hash.add(offset);
  }
  add_antenna(hash, ap.array.pattern, ap.array.polarization);
  for (const std::uint8_t rx_chain : ap.rx_chains) {
    hash.add(static_cast<std::uint64_t>(rx_chain));
  }
}

}  // namespace

std::string inputs_hash(const Site& site,
                        const RoomModel& surveyed,
                        const CalibrationRequest& request,
                        const std::string& measurements) {
  ContentHash hash;
  hash.add(measurements);
  hash.add(surveyed.scene_hash);
  hash.add(request.method);
  hash.add(request.seed);
  hash.add(request.holdout);
  hash.add(request.survey_error);
  hash.add(surveyed.bounds_min);
  hash.add(surveyed.bounds_max);
  hash.add(surveyed.grid.centre_hz);
  hash.add(surveyed.grid.spacing_hz);
  for (const std::int16_t tone : surveyed.grid.tone_index) {
    hash.add(static_cast<std::uint64_t>(tone));
  }
  hash.add(surveyed.device.height);
  add_antenna(hash, surveyed.device.pattern, surveyed.device.polarization);
  for (const RoomAccessPoint& ap : surveyed.access_points) {
    add_access_point(hash, ap);
  }
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (transmitter.constant_power) {  // its received power offset is learned
      hash.add(to_string(transmitter.mac));
    }
  }
  return hash.text();
}

}  // namespace rayloc
