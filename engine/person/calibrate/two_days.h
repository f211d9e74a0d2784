// tell_days_apart: the empty rooms of two days, heard of fixed transmitters, and the chain gains of
// each: people were recorded on one day, and are looked for on the other.
//
// The calibration's gains are of one of the days, or of a day between power cycles of its own: of
// the day on which the traced room explains an access point better they are believed, and the other
// day's are what compare_days() says beside them.
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

// What the access points hear of one transmitter, with the calibration's gains removed.
struct HeardDays {
  Transmitter surveyed;
  std::vector<EmptyRoom> people;  // on the day when people were recorded
  std::vector<EmptyRoom> today;
};

struct DayChange {
  std::size_t access_point = 0;
  TurnedChains chains;
  bool is_turned = false;
  // Of turned chains, those of today; else the calibration's are today's.
  bool is_today_turned = true;
};

struct TwoDays {
  RoomModel people;  // with that day's gains
  RoomModel today;
  std::vector<HeardDays> heard;  // of the same access points on both days, own gains removed
  std::vector<DayChange> changes;
};

// An Error when an access point hears a transmitter as if it were another one, or when no access
// point heard a transmitter on both days. REQUIRES: all access points that heard are calibrated.
Expected<TwoDays> tell_days_apart(const RoomModel& room, std::span<const HeardDays> heard);

// A reference of the day of the people, moved to today: each link gets today's empty room with the
// phase, delay and level that it has, by what both days have in common, so that `scale` holds.
PersonReference moved_to_today(const OfdmGrid& grid,
                               PersonReference reference,
                               std::span<const EmptyRoom> today);

}  // namespace rayloc
