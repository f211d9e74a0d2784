// PersonEstimator: locates a person who carries no device, from the bursts of the site's fixed
// transmitters (device-free). Each burst gives a snapshot, NO_FIX when no person is detected, and
// filtered estimates of the instants within it.
//
// Targets are called person-N. With K fixed transmitters, the i-th of site.toml has the numbers i,
// i + K, i + 2K ...: one for each of its tracks, in order. A snapshot has the number of the track
// that its burst belongs to, or of the next track if there is none; of two people in one burst the
// one nearer to the track has that number, and the other the number after it. Results of two
// transmitters are therefore never assigned to one target, and no number depends on which of them
// detected a person first. A person whom two transmitters detect is two targets.
//
// Method paper always reports a person and has no tracks.
//
// A site without a reference of the empty room (`rayloc reference`) gives NO_FIX, with the reason.
//
// Learned factors of receive chains are removed from the frames, by the state that a burst comes
// with (Estimates::chains), or by that of a file. Access points whose chains are being learned are
// left out; if none remains, the result is NO_FIX with the progress.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/person_method.h"
#include "daemon/pipeline/person_chains.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

class PersonEstimator : public Estimator {
 public:
  struct Options {
    const Method* method = &default_method();  // the method that locates people
    MethodOptions settings;
    Duration valid_for = std::chrono::milliseconds(450);  // until a next burst is overdue
    std::shared_ptr<const Carried> before;                // state of the predecessor; null: none
    std::string chain_file;  // chains learned before, for bursts without a state; empty: none
  };

  // Reads the scene and prepares the room: up to a minute.
  static Expected<std::unique_ptr<PersonEstimator>> create(const Site& site,
                                                           const Options& options);
  // The same with the site's room and references.
  static Expected<std::unique_ptr<PersonEstimator>> create(const Site& site,
                                                           const Options& options,
                                                           std::shared_ptr<const RoomModel> room,
                                                           std::vector<PersonReference> references);

  void estimate(const Burst& burst, Estimates& out) override;
  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override;
  void restart(const std::string& reason, Estimates& out) override;

  void carry(Carried& carried) const override;

  const RoomModel& room() const { return *room_; }

  // Sum over all trackers. Thread safety: may be called from any thread.
  PersonTrackerCounters tracker_counters() const;
  // Lines for the log about the file of chains, at the first call. Thread safety: for one thread,
  // which may be another than that of the bursts.
  std::vector<std::string> chain_notices() { return chains_.notices(); }

 private:
  PersonEstimator(Site site, Options options, std::shared_ptr<const RoomModel> room)
      : site_(std::move(site)),
        options_(std::move(options)),
        room_(std::move(room)),
        chains_(options_.chain_file, room_) {}
  // State of one fixed transmitter.
  struct Link {
    std::unique_ptr<PersonMethod> method;
    std::uint64_t number_step = 1;  // between the numbers of two of its people
    // Lost tracks whose loss is not final yet: time of the loss and number.
    std::vector<std::pair<Timestamp, std::uint64_t>> lost;
  };

  LocationContext context() const;
  void append(const std::vector<PersonUpdate>& updates, Link& link, Estimates& out) const;
  void publish_counters();

  const Site site_;
  const Options options_;
  const std::shared_ptr<const RoomModel> room_;
  PersonChains chains_;
  std::map<MacAddress, Link> links_;
  mutable std::mutex mutex_;
  PersonTrackerCounters tracker_counters_;  // guarded by mutex_
};

}  // namespace rayloc
