// reference_links: the empty room as each access point hears it of a fixed transmitter, brought
// into the phase and delay of the traced room (PersonReference), and where the transmitter is.
//
// A transmitter is surveyed to a few millimetres, which turn its paths against each other by a
// radian; so its place is fitted, with a prior, to what all access points hear of the empty room.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// What an access point hears of the transmitter while nobody is in the room.
struct EmptyRoom {
  std::size_t access_point = 0;         // of RoomModel::access_points
  std::vector<std::complex<double>> h;  // [core][tone], chain gains removed
};

struct EmptyRoomOptions {
  double place_sigma = 0.005;  // [m], of each axis of the surveyed place
};

// Fills `transmitter` and `links` of a reference. An Error names an access point that no path of
// the room leads to. REQUIRES: `heard` is not empty; all its access points are calibrated.
Expected<PersonReference> fit_empty_room(const RoomModel& room,
                                         const Transmitter& surveyed,
                                         std::span<const EmptyRoom> heard,
                                         const EmptyRoomOptions& options = {});

}  // namespace rayloc
