// Training data of a method: recordings of a device, or of people, split by survey points.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/baselines/training.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct TrainSurvey {
  std::vector<TrainingPoint> points;      // with observations
  std::vector<CsiFrame> empty;            // for people: recorded without people
  std::optional<MacAddress> transmitter;  // for people: the transmitter
  std::vector<std::string> notes;         // from the recordings
  std::string content;                    // hash of the recordings and the points
};

struct SurveyArguments {
  std::vector<std::string> captures;    // [AP=]FILE
  std::vector<std::string> empty;       // [AP=]FILE
  std::string points;                   // t_start,t_end,x,y,z
  std::optional<Duration> time_offset;  // offset added to the times of the points
};

// Reads the device that was carried from point to point, as `rayloc calibrate` does.
Expected<TrainSurvey> read_device_survey(const Site& site,
                                         const RoomModel& room,
                                         const SurveyArguments& arguments);

// Reads the fixed transmitter received at most points, while a person was at each of them.
Expected<TrainSurvey> read_people_survey(const Site& site, const SurveyArguments& arguments);

}  // namespace rayloc
