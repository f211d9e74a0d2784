// Summary of `rayloc reference` on standard error.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/site/model/site.h"
#include "engine/person/calibrate/two_days.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct ReferenceReport {
  const Site& site;
  const RoomModel& room;
  const std::vector<DayChange>& changes;  // since the other day on which people were recorded
  const std::vector<PersonReference>& references;
  std::size_t spots = 0;                  // points of the person fit
  const std::vector<std::string>& notes;  // from the recordings
  const std::vector<RefusedInput>& refused;
};

void print_reference(const ReferenceReport& report);

}  // namespace rayloc::cli
