// What `rayloc reference` says on standard error of what it learned.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/calibrate/report/refused_input.h"
#include "daemon/site/site.h"
#include "engine/person/calibrate/two_days.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct ReferenceReport {
  const Site& site;
  const RoomModel& room;
  const std::vector<DayChange>& changes;  // since people were recorded on another day
  const std::vector<PersonReference>& references;
  std::size_t spots = 0;                  // that the person was fitted to
  const std::vector<std::string>& notes;  // of the recordings
  const std::vector<RefusedInput>& refused;
};

void print_reference(const ReferenceReport& report);

}  // namespace rayloc::cli
