// separate_days: the empty rooms of two days, received from fixed transmitters, and the chain
// gains of each: people were recorded on one day, and are located on the other.
//
// The calibration's gains are of one of the days, or of a day between power cycles of its own. They
// are used for the day on which the traced room explains an access point better; the other day's
// gains follow from these by compare_days().
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/person/calibrate/another_day.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Arrays received from one transmitter, with the calibration's gains removed.
struct ReceivedDays {
  Transmitter surveyed;
  std::vector<EmptyRoom> people;  // on the day when people were recorded
  std::vector<EmptyRoom> today;
};

struct DayChange {
  std::size_t access_point = 0;
  RotatedChains chains;
  bool is_rotated = false;
  // For rotated chains: today's are rotated; false: today's are as calibrated.
  bool is_today_rotated = true;
};

struct TwoDays {
  RoomModel people;  // with that day's gains
  RoomModel today;
  std::vector<ReceivedDays> received;  // of the same access points on both days, own gains removed
  std::vector<DayChange> changes;
};

// An Error when an access point receives a transmitter as if it were another one, or when no access
// point received one on both days. REQUIRES: all access points with arrays are calibrated.
Expected<TwoDays> separate_days(const RoomModel& room, std::span<const ReceivedDays> received);

// A reference of the day of the people, moved to today: each link gets today's empty room, with the
// phase, amplitude and delay of its present one (by what both have in common): `scale` holds.
PersonReference moved_to_today(const OfdmGrid& grid,
                               PersonReference reference,
                               std::span<const EmptyRoom> today);

}  // namespace rayloc
