// reference_links: the empty room as each access point receives it from a fixed transmitter, with
// the phase and delay of the traced room (PersonReference), and the transmitter's place.
//
// A transmitter is surveyed to a few millimetres, which change its paths' relative phases by a
// radian. Its place is therefore fitted, with a prior, to the empty room at all access points.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Array that an access point receives from the transmitter while the room is empty.
struct EmptyRoom {
  std::size_t access_point = 0;         // of RoomModel::access_points
  std::vector<std::complex<double>> h;  // [rx_chain][tone], chain gains removed
};

struct EmptyRoomOptions {
  double place_sigma = 0.005;  // [m], along each axis of the surveyed place
};

// Fills `transmitter` and `links` of a reference. An Error names an access point that no path of
// the room reaches. REQUIRES: `received` is not empty; all its access points are calibrated.
Expected<PersonReference> fit_empty_room(const RoomModel& room,
                                         const Transmitter& surveyed,
                                         std::span<const EmptyRoom> received,
                                         const EmptyRoomOptions& options = {});

}  // namespace rayloc
