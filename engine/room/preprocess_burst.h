// Preprocessing of one burst for the access points of a room: the first step of a fix, common to
// every method of localization.
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

// An Error when nothing can be located in this room with any burst: no scene, empty bounds, no
// access point, no tones.
Expected<void> check_room(const RoomModel* room);

// The reason why the frames of this access point cannot be used, a text to follow its name;
// empty: no problem.
std::string calibration_problem(const RoomModel& room, const RoomAccessPoint& access_point);

// The reason why a burst that gave these warnings and no array cannot be located.
std::string no_usable_csi(const RoomModel& room, const std::vector<std::string>& warnings);
// The same for the access points of a reference, which people are located with.
std::string no_usable_reference_csi(const std::vector<std::string>& warnings);

// The burst of one access point of RoomModel::access_points, chain gains removed; nothing when it
// received none that can be used. Problems are reported as warnings. REQUIRES:
// calibration_problem() is empty.
std::optional<BurstObservation> preprocess_burst(const RoomModel& room,
                                                 std::size_t access_point,
                                                 std::span<const CsiFrame> frames,
                                                 const BurstOptions& options,
                                                 std::vector<std::string>& warnings);

// The antenna whose chain is dead, as a row of the burst: 20 dB weaker than the mean of the others,
// or absent from every frame of the burst (BurstObservation::absent). A fade that deep over a whole
// channel is rare, and a chain that is left out because of one only widens the region. REQUIRES:
// its chain gains have been removed.
struct DeadChain {
  std::size_t row = 0;
  double power_db = 0.0;  // power relative to the others
  std::optional<AbsentRxChain> absent;
};
std::optional<DeadChain> dead_chain(const BurstObservation& burst);
// "access point ap1: the chain of core 2 is dead (...)", without the consequences.
std::string dead_chain_text(const RoomAccessPoint& access_point,
                            const BurstObservation& burst,
                            const DeadChain& dead);
// The burst without that row.
BurstObservation without_row(BurstObservation burst, std::size_t row);

// Collects the observation statistics of an estimate from the bursts that were used for it.
class ObservationTally {
 public:
  void add(const RoomAccessPoint& access_point, const BurstObservation& burst);

  // Sets counts, snr_db, times, and a warning of motion. Without a burst the times are those of the
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
