// What a method learns from: recordings of a device, or of people, cut into the points of a survey.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/baselines/training.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct TrainSurvey {
  std::vector<TrainingPoint> points;      // that were heard
  std::vector<CsiFrame> empty;            // of people: while nobody was there
  std::optional<MacAddress> transmitter;  // of people: who sent
  std::vector<std::string> notes;         // of the recordings
  std::string content;                    // hash of the recordings and the points
};

struct SurveyArguments {
  std::vector<std::string> captures;    // [AP=]FILE
  std::vector<std::string> empty;       // the same
  std::string points;                   // t_start,t_end,x,y,z
  std::optional<Duration> time_offset;  // added to the times of the points
};

// Of the device that was carried from point to point, as `rayloc calibrate` reads it.
Expected<TrainSurvey> read_device_survey(const Site& site,
                                         const RoomModel& room,
                                         const SurveyArguments& arguments);

// Of the fixed transmitter that is heard at most points, while a person stood on each.
Expected<TrainSurvey> read_people_survey(const Site& site, const SurveyArguments& arguments);

}  // namespace rayloc::cli
