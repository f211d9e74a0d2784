// inputs_hash: identifies a calibration by all of its inputs.
//
// The hash is the calibration's id. A checkpoint resumes only with the same hash: with another pose
// of an access point the same numbers would describe another room.
#pragma once

#include <cstdint>
#include <string>

#include "daemon/site/model/site.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct CalibrationRequest {
  std::string method;
  double holdout = 0.0;
  std::uint64_t seed = 0;
  double survey_error = 0.0;  // [m]
};

// `surveyed`: the room as `site` states it; `measurements`: hash of the points and the recordings.
std::string inputs_hash(const Site& site,
                        const RoomModel& surveyed,
                        const CalibrationRequest& request,
                        const std::string& measurements);

}  // namespace rayloc
