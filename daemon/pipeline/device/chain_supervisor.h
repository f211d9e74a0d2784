// ChainSupervisor: decides from which access points a device's frames are used: it compares the
// bursts of fixed transmitters with the calibration (CalibrationMonitor), learns changed receive
// chains from all bursts (ChainCapability), and keeps the results (ChainKeeper).
//
// Thread safety: for one thread, except states(), notices() and reason(), which any thread may
// call.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/device/chain_keeper.h"
#include "daemon/pipeline/device/device_rooms.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/chains/reference_chains.h"
#include "engine/monitor/calibration_monitor.h"

namespace rayloc {

struct Carried;

class ChainSupervisor {
 public:
  // `rooms` outlives this.
  ChainSupervisor(ChainKeeper::Options options, DeviceRooms& rooms)
      : rooms_(rooms), keeper_(std::move(options)) {}

  // Reads the site's references and the chains learned before. To be called once, before any other
  // member; an Error if a file cannot be used. REQUIRES: the rooms are prepared from `room`.
  Expected<void> prepare(const Site& site, const RoomModel& room);

  // The burst of a fixed transmitter at a known place. Where the empty room was recorded with
  // learned chains, its frames are compared with these, and the operator is notified once. Chains
  // of an earlier run whose empty room fits without them are kept until a device's burst
  // contradicts them: the empty room may contain their factors. REQUIRES: fixed.position.
  void check(const SiteTransmitter& fixed, const Burst& burst);
  // The burst of a device, whose method may learn from it. The result are the frames of the access
  // points with known chains, corrected to the calibration: those of the burst, or the remaining
  // ones in `kept`. REQUIRES: a room of `rooms`.
  std::span<const CsiFrame> accept(const Burst& burst,
                                   const DeviceRoom& room,
                                   std::vector<CsiFrame>& kept);
  // The assessment of the frames that accept() returned last.
  ChainTrust trust(const DeviceRoom& room, std::span<const CsiFrame> accepted) const;
  // Coarse snapshot of a burst without usable access points, where the room and the frames allow
  // one; otherwise its reason. REQUIRES: accept() returned no frame of the burst.
  LocationEstimate locate_coarsely(const Burst& burst, const DeviceRoom& room) const;

  // Warnings that hold now: of fixed transmitters, and of chains that are being learned.
  std::vector<CalibrationWarning> monitor_warnings() const { return monitor_->warnings(); }
  std::vector<CalibrationWarning> chain_warnings() const {
    return keeper_.warnings(rooms_.first());
  }

  // Continues from the state of a predecessor; carry() is the state for a successor.
  void go_on(const Carried& before);
  void carry(Carried& carried) const;
  // A recording continues at another position: the rooms' chains restart as well.
  void restart();

  std::vector<ChainState> states() const { return keeper_.states(); }
  // States for the estimators that follow, with `is_confirmed`; null where no method learns chains.
  std::shared_ptr<const std::vector<ChainState>> shared_states() const;
  // Changes for the log since the last call.
  std::vector<std::string> notices() { return keeper_.notices(); }
  // Progress of the chains that are being learned; empty if there are none.
  std::string reason(const RoomModel& room) const { return keeper_.reason(room); }

 private:
  std::vector<CsiFrame> compared_frames(const Burst& burst, const ChainCapability* learner) const;
  void report_references(const Burst& burst, const ChainCapability& learner);
  void report_jump(const Burst& burst, std::size_t access_point, ChainCapability& learner);
  bool keep_restored(const Burst& burst, std::size_t access_point, const ChainCapability& learner);
  void note_learned(const ChainCapability& learner);
  void judge(const Burst& burst, ChainCapability& learner);
  std::vector<ChainState> with_confirmation(std::vector<ChainState> states) const;

  DeviceRooms& rooms_;
  std::unique_ptr<CalibrationMonitor> monitor_;
  std::unique_ptr<ReferenceChains> references_;
  // Sets of access points:
  std::set<std::size_t> reported_;   // reference reported
  std::set<std::size_t> unlearned_;  // chains not learned at some time since the start
  std::set<std::size_t> confirmed_;  // learned chains confirmed since the start
  std::set<std::size_t> kept_;       // restored chains kept against a fixed transmitter
  ChainKeeper keeper_;
  std::map<MacAddress, Timestamp> watched_;         // last frame of each fixed transmitter
  std::map<MacAddress, Timestamp> watched_before_;  // the same of the predecessor
};

}  // namespace rayloc
