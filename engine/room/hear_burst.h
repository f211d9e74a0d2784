// What the access points of a room hear of one burst: the part of a fix that every method of
// localization begins with.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/observe/burst.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

// An Error when nothing can be located there, whatever is heard: no scene, empty bounds, no access
// point, no tones.
Expected<void> check_room(const RoomModel* room);

// Why nothing can be made of what this access point hears, to follow its name; empty: nothing is
// wrong.
std::string calibration_problem(const RoomModel& room, const RoomAccessPoint& access_point);

// Why there is nothing to locate by in a burst that gave these warnings and no array.
std::string nothing_heard(const RoomModel& room, const std::vector<std::string>& warnings);

// The burst of one access point of RoomModel::access_points, chain gains removed; nothing when it
// heard none that can be used, and what was wrong with it is a warning.
// REQUIRES: calibration_problem() is empty.
std::optional<BurstObservation> hear(const RoomModel& room,
                                     std::size_t access_point,
                                     std::span<const CsiFrame> frames,
                                     const BurstOptions& options,
                                     std::vector<std::string>& warnings);

// The antenna whose chain is dead, as a row of the burst: 20 dB weaker than the others in the mean.
// A fade that deep over a whole channel is rare, and a chain that is left out for one only widens
// the region. Its chain gains must have been removed. Or the one that no frame of the burst has
// (BurstObservation::absent).
struct DeadChain {
  std::size_t row = 0;
  double level_db = 0.0;  // how far below it is
  std::optional<AbsentCore> absent;
};
std::optional<DeadChain> dead_chain(const BurstObservation& burst);
// "access point ap1: the chain of core 2 is dead (...)", without what follows from it.
std::string dead_chain_text(const RoomAccessPoint& access_point,
                            const BurstObservation& burst,
                            const DeadChain& dead);
// The burst without that row.
BurstObservation without_row(BurstObservation burst, std::size_t row);

// Adds up what an estimate says of the bursts that were used for it.
class ObservationTally {
 public:
  void add(const RoomAccessPoint& access_point, const BurstObservation& burst);

  // Numbers, snr_db, times, and a warning of motion. Without a burst: times are those of the
  // frames. REQUIRES: frames not empty.
  void fill(std::span<const CsiFrame> frames, LocationEstimate& estimate) const;

 private:
  std::size_t frames_ = 0;
  std::size_t antennas_ = 0;
  Timestamp first_;
  Timestamp last_;
  std::vector<double> snr_db_;  // of each access point
  std::vector<std::string> warnings_;
};

}  // namespace rayloc
