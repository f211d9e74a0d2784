// ZoneWatch: who is in which zone, by filtered estimates, with hysteresis (SiteZone).
//
//   ZoneWatch watch(site.zones);
//   watch.see(location);              // filtered, its `zones` filled
//   watch.advance(time, events);      // nothing earlier comes any more
//
// Event time only: estimates are taken in order of (time, target) whatever the order in which they
// came, so that the same estimates give the same events, in order of their times. An estimate
// without probabilities (NO_FIX), or of a tentative track, says nothing. A target whose track is
// lost leaves its zones, and so does one of which nothing was heard for kSilence.
//
// Memory is bounded by the targets that were heard within kSilence. Thread safety: for one thread.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/pipeline/zones/zone_stays.h"
#include "daemon/publish/location.h"
#include "daemon/publish/target_event.h"
#include "daemon/site/site.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Fills `location.zones`: the integral of its hypotheses over each zone. The residual probability
// counts as outside. Nothing without a position or hypotheses.
void fill_zones(const std::vector<SiteZone>& zones, Location& location);

class ZoneWatch {
 public:
  // Trackers give a silent target up after 5 s, and say so; this is for those that do not.
  static constexpr Duration kSilence = std::chrono::seconds(10);

  explicit ZoneWatch(std::vector<SiteZone> zones) : zones_(std::move(zones)) {
    inside_.resize(zones_.size());
  }
  // Goes on with what a predecessor has decided, by the estimates before `done`.
  ZoneWatch(std::vector<SiteZone> zones, const ZoneStays& stays, Timestamp done);

  // Keeps what a filtered estimate says until advance(); a snapshot says nothing.
  // REQUIRES: `location.zones` is empty or as fill_zones() has it.
  void see(const Location& location);

  // Appends what is decided by the estimates before `time`.
  void advance(Timestamp time, std::vector<ZoneEvent>& events);

  // What was decided until the last advance().
  ZoneStays stays() const;

  // Time may go back: decides by what it has, and then everybody leaves.
  void restart(const std::string& reason, std::vector<ZoneEvent>& events);

 private:
  struct Sighting {
    Target target;
    std::vector<double> probability;  // by zone; empty when unknown
    bool is_lost = false;
  };
  struct Watched {
    Target target;
    Timestamp heard;
    std::vector<ZoneStay> stays;  // by zone
  };
  using Targets = std::map<std::string, Watched>;

  void take_before(Timestamp time);
  void give_out(std::vector<ZoneEvent>& events);
  void take(Timestamp time, const std::string& key, const Sighting& sighting);
  void judge(std::size_t zone, Targets::value_type& target, Timestamp time);
  void leave(std::size_t zone,
             Targets::value_type& target,
             Timestamp time,
             const std::string& reason);
  void leave_all(Targets::iterator target, Timestamp time, const std::string& reason);
  void forget_silent(Timestamp before);
  ZoneEvent& say(ZoneEventKind kind,
                 std::size_t zone,
                 const Targets::value_type& target,
                 Timestamp time);

  const std::vector<SiteZone> zones_;
  Timestamp done_ = Timestamp::min();  // by the predecessor
  std::multimap<std::pair<Timestamp, std::string>, Sighting> held_;
  Targets targets_;                               // by target_component()
  std::vector<std::vector<std::string>> inside_;  // of each zone, in the order they came
  std::vector<ZoneEvent> said_;                   // since the last advance()
};

}  // namespace rayloc
