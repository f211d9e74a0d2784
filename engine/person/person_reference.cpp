#include "engine/person/person_reference.h"

#include "engine/room/preprocess_burst.h"

namespace rayloc {

Expected<void> check_link(const RoomModel& room, const PersonLink& link) {
  if (link.access_point >= room.access_points.size()) {
    return make_error(ErrorKind::kInternal, "the reference is of another site");
  }
  const RoomAccessPoint& ap = room.access_points[link.access_point];
  if (const std::string problem = calibration_problem(room, ap); !problem.empty()) {
    return make_error(ErrorKind::kConfiguration, "access point " + ap.id + " " + problem);
  }
  if (link.empty.size() != ap.rx_chains.size() * room.grid.size()) {
    return make_error(ErrorKind::kConfiguration,
                      "access point " + ap.id +
                          ": the reference has other cores or tones than the site; record the "
                          "empty room again (rayloc reference)");
  }
  return {};
}

}  // namespace rayloc
