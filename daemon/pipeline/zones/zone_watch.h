// ZoneWatch: occupants of the zones, from filtered estimates, with hysteresis (SiteZone).
//
//   ZoneWatch watch(site.zones);
//   watch.see(location, transmitter);         // filtered, its `zones` filled
//   watch.advance(time, events, is_waiting);  // no earlier estimate follows
//
// Event time only: estimates are processed in order of (time, target) whatever their order of
// arrival, so that the same estimates give the same events, in order of their times. An estimate
// without probabilities (NO_FIX), or of a tentative track, is ignored. A target whose track is lost
// leaves its zones, and so does one without frames for kSilence.
//
// Under load the bursts of a transmitter may wait longer than that: its target is not silent then.
// Its tracker reports the time before these bursts when they are processed. Such an estimate counts
// at the last advance() at which they waited, so that events stay in order of their times.
//
// Memory is bounded by the targets received within kSilence. Thread safety: for one thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"
#include "daemon/pipeline/burst_queue.h"
#include "daemon/pipeline/zones/zone_stays.h"
#include "daemon/site/model/site.h"
#include "engine/base/timestamp.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

// Fills `location.zones`: the integral of its hypotheses over each zone. The residual probability
// counts as outside. No entries without a position or hypotheses.
void fill_zones(const std::vector<SiteZone>& zones, Location& location);

class ZoneWatch {
 public:
  // Trackers end a silent track after 5 s, with an event; this is for those that do not.
  static constexpr Duration kSilence = std::chrono::seconds(10);

  explicit ZoneWatch(std::vector<SiteZone> zones) : zones_(std::move(zones)) {
    inside_.resize(zones_.size());
  }
  // Continues the decisions of a predecessor, made from the estimates before `done`.
  ZoneWatch(std::vector<SiteZone> zones, const ZoneStays& stays, Timestamp done);

  // Keeps a filtered estimate until advance(); ignores a snapshot. `transmitter`: of the burst that
  // it was made from; without a value: it was predicted. REQUIRES: `location.zones` is empty or as
  // filled by fill_zones().
  void see(const Location& location, const std::optional<MacAddress>& transmitter = std::nullopt);

  // Appends the events decided by the estimates before `time`. `is_waiting`: as in BurstQueue; its
  // transmitters are not silent.
  void advance(Timestamp time, std::vector<ZoneEvent>& events, const IsWaiting& is_waiting = {});

  // Decisions up to the last advance().
  ZoneStays stays() const;

  // Time may decrease: processes the waiting estimates, then every target leaves its zones.
  void restart(const std::string& reason, std::vector<ZoneEvent>& events);

 private:
  struct Sighting {
    Target target;
    std::vector<double> probability;  // by zone; empty when unknown
    bool is_lost = false;
    std::optional<MacAddress> transmitter;
  };
  struct Watched {
    Target target;
    Timestamp received;
    std::vector<ZoneStay> stays;                 // by zone
    std::optional<MacAddress> transmitter = {};  // of no other target
    Timestamp waited = Timestamp::min();         // the last advance() at which it waited
    bool waits(const IsWaiting& is_waiting) const {
      return is_waiting && transmitter && is_waiting(*transmitter);
    }
  };
  using Targets = std::map<std::string, Watched>;

  void take_before(Timestamp time, const IsWaiting& is_waiting);
  void give_out(std::vector<ZoneEvent>& events);
  void take(Timestamp time,
            const std::string& key,
            const Sighting& sighting,
            const IsWaiting& is_waiting);
  Targets::iterator watched_of(const std::string& key, const Sighting& sighting);
  void judge(std::size_t zone, Targets::value_type& target, Timestamp time);
  void leave(std::size_t zone,
             Targets::value_type& target,
             Timestamp time,
             const std::string& reason);
  void leave_all(Targets::iterator target, Timestamp time, const std::string& reason);
  void forget_silent(Timestamp before, const IsWaiting& is_waiting);
  void keep_waiting(Timestamp time, const IsWaiting& is_waiting);
  ZoneEvent& add_event(ZoneEventKind kind,
                       std::size_t zone,
                       const Targets::value_type& target,
                       Timestamp time);

  const std::vector<SiteZone> zones_;
  Timestamp done_ = Timestamp::min();  // of the predecessor
  std::multimap<std::pair<Timestamp, std::string>, Sighting> held_;
  Targets targets_;                               // by target_component()
  std::vector<std::vector<std::string>> inside_;  // for each zone, in the order of entry
  std::vector<ZoneEvent> pending_;                // since the last advance()
};

}  // namespace rayloc
