// SecondDay: changes of a room between the day of its calibration and another: radios were switched
// off and on, chairs were moved, access points bumped.
//
// second_day_keys() defines the file's keys completely: reading, defaults and the text of `rayloc
// simulate --help` come from it. Zero switches a change off.
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/model/number_range.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

struct SecondDay {
  double day = 2;  // number of the day: another day has other draws
  double chain_phase_deg = 0.0;
  double chain_gain_db = 0.0;
  double moved_things = 0;
  double moved_least_m = 0.0;
  double moved_most_m = 0.0;
  double access_point_moved_m = 0.0;
  double access_point_turned_deg = 0.0;
};

struct SecondDayKey {
  std::string_view key;
  double SecondDay::*member;
  NumberRange range;
  bool is_whole = false;
  double preset = 0.0;
  double none = 0.0;  // for a day without changes
  std::string_view meaning;
};

std::span<const SecondDayKey> second_day_keys();

SecondDay default_second_day();
SecondDay unchanged_day();

// TOML: the keys that differ from `base`, itself "default" (the default) or "none". Errors name
// file:line:column; unknown keys are errors.
Expected<SecondDay> load_second_day(const std::filesystem::path& file);
Expected<SecondDay> parse_second_day(std::string_view text, const std::filesystem::path& file);

// One line per key: its name, default and meaning.
std::string second_day_help();

// Touching objects that were moved as one.
struct MovedThing {
  std::vector<std::string> objects;  // their names
  Vec3d by;                          // [m]
};

struct BumpedAccessPoint {
  Vec3d moved;                                      // [m]
  Orientation rotated;                              // change of its pose's angles
  std::vector<std::complex<double>> chain_changes;  // factor by chain; empty: none
};

// The room on that day, and all random draws.
struct LivedInRoom {
  RoomModel room;
  std::vector<MovedThing> moved;
  std::vector<BumpedAccessPoint> access_points;  // by access point of the room
};

// Things are those of is_movable(), without flat objects on walls, each moved along the floor to a
// position without overlap; one without such a position stays. Fewer may move than requested.
Expected<LivedInRoom> live_in(const RoomModel& room, const SecondDay& day, std::uint64_t seed);

}  // namespace rayloc
